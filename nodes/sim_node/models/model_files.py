"""Models from files: OBJ, STL and GLB here, MJCF by `mjcf_files`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from semmap.nodes.sim_node.bodies import Floats
from semmap.nodes.sim_node.models.library import DENSITY, Model, ModelError, assemble, check_size
from semmap.nodes.sim_node.models.mjcf_files import MjcfModel, read_mjcf
from semmap.nodes.sim_node.models.parts import (
    Colour,
    Joint,
    Part,
    Role,
    Shape,
    Vec3,
    bounds,
    mesh,
    rotation_matrix,
)
from semmap.nodes.sim_node.models.readable import LARGEST_FILE_BYTES
from semmap.nodes.sim_node.physics import build

MESHES = (".obj", ".stl", ".glb")
SUFFIXES = (".xml", *MESHES)

_GREY: Colour = (0.66, 0.66, 0.68)
_MOST_PARTS = 2000


@lru_cache(maxsize=256)
def read_model(path: Path, size_m: Vec3 | None, version: int) -> Model:
    """Read the model in a file, in metres, stretched to `size_m`; `version` identifies the file's content.

    An MJCF file is used in its initial state, with its joints and masses. A mesh need not be closed: it
    collides as its hull, and has the default density. Raises ModelError, OSError.
    """
    check_size(size_m)
    if path.stat().st_size > LARGEST_FILE_BYTES:
        raise ModelError(f"model file {path} is larger than {LARGEST_FILE_BYTES >> 20} MB")
    try:
        parts, density, notes = _read_meshes(path) if path.suffix in MESHES else read_mjcf(path)
        if len(parts) > _MOST_PARTS:
            raise ModelError(f"it has {len(parts):,} geoms, and a model has {_MOST_PARTS:,} at most")
        if all(part.role is Role.VISUAL for part in parts):
            raise ModelError("it contains no colliding geometry")
        if size_m is not None:
            parts = stretched(parts, size_m)
        extents = _extents(parts)
        check_size(extents, "; is the file in metres?")
        parts = keyed(parts, f"{path}:{version}:{size_m}")
        model = assemble(str(path), parts, density * float(np.prod(extents)), notes)
        _try_out(model)
    except OSError:
        raise
    except ModelError as error:
        raise ModelError(f"cannot use model file {path}: {error}") from None
    except Exception as error:  # file readers raise arbitrary exceptions
        reason = " ".join(str(error).split())
        if not isinstance(error, ValueError):  # an unexpected failure of a reader
            reason = f"its content is invalid ({type(error).__name__}: {reason})"
        raise ModelError(f"cannot use model file {path}: {reason}") from None
    return model


def _extents(parts: list[Part]) -> Vec3:
    """Return the joint extents of parts [m]."""
    low, high = bounds(parts)
    return _vec3(high - low)


def _read_meshes(path: Path) -> MjcfModel:
    """Read a mesh file."""
    import trimesh  # slow to import, so only if needed

    from semmap.nodes.runtime import pictures  # noqa: F401  limits the size of textures

    scene = trimesh.load_scene(path)
    up = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]) if path.suffix == ".glb" else np.eye(3)  # glTF: y up
    parts = []
    for one in scene.dump():
        if len(one.faces):
            parts.append(mesh(np.asarray(one.vertices) @ up.T, np.asarray(one.faces), _colour(one)))
    return MjcfModel(parts, DENSITY)


def _colour(read: Any) -> Colour:
    try:
        red, green, blue = np.asarray(read.visual.to_color().main_color)[:3] / 255.0
    except Exception:  # without its texture, a mesh is grey
        return _GREY
    return (float(red), float(green), float(blue))


def stretched(parts: Sequence[Part], size_m: Vec3) -> list[Part]:
    """Return parts stretched to a total size of `size_m`.

    Meshes are stretched along the model's axes, primitives along their own, which are usually the same.
    Ranges of hinges stay, ranges of slides are scaled.
    """
    low, high = bounds(parts)
    factors = np.asarray(size_m) / np.maximum(high - low, 1e-6)
    scaled = []
    for part in parts:
        if part.mesh is not None:
            vertices = (part.mesh.vertices + part.centre) * factors
            scaled.append(replace(mesh(vertices, part.mesh.faces, part.colour, part.role), joint=part.joint))
        else:
            x, y, z = np.linalg.norm(factors[:, None] * rotation_matrix(part.turn), axis=0)
            if part.shape in (Shape.CYLINDER, Shape.CAPSULE):
                x = y = np.sqrt(x * y)  # round parts stay round
            half = _vec3(np.asarray(part.half) * (x, y, z))
            scaled.append(replace(part, half=half, centre=_vec3(np.asarray(part.centre) * factors)))
    joints = {part.joint: _stretched_joint(part.joint, factors) for part in parts if part.joint}
    return [replace(part, joint=joints[part.joint]) if part.joint else part for part in scaled]


def _stretched_joint(joint: Joint, factors: Floats) -> Joint:
    anchor = _vec3(np.asarray(joint.anchor) * factors)
    if joint.kind == "hinge":
        return replace(joint, anchor=anchor)
    axis = np.asarray(joint.axis) * factors
    travel = float(np.linalg.norm(axis))
    return replace(
        joint,
        anchor=anchor,
        axis=_vec3(axis / travel),
        range=joint.range and (travel * joint.range[0], travel * joint.range[1]),
        closed=None if joint.closed is None else travel * joint.closed,
    )


def keyed(parts: Sequence[Part], key: str) -> list[Part]:
    """Return parts whose meshes have unique names."""
    return [
        part if part.mesh is None else replace(part, mesh=replace(part.mesh, key=f"{key}:{number}"))
        for number, part in enumerate(parts)
    ]


def _try_out(model: Model) -> None:
    """Compile a model alone, so that an invalid one cannot break the world. Raises ModelError."""
    spec = mujoco.MjSpec()
    body = spec.worldbody.add_body()
    for part in model.parts:
        if part.mesh is not None:
            build.add_mesh(spec, part.mesh)
        build.add_part(body, part)
    try:
        spec.compile()
    except ValueError as error:
        fault, *_ = str(error).splitlines()  # the other lines refer to elements that are not in the file
        raise ModelError(fault.removeprefix("Error: ")) from None


def _vec3(values: Any) -> Vec3:
    return (float(values[0]), float(values[1]), float(values[2]))
