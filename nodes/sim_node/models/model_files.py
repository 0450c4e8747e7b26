"""Models read from MJCF, OBJ, STL and GLB files."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from nodes.sim_node.bodies import Floats
from nodes.sim_node.models.library import DENSITY, Model, ModelError, assemble, check_size
from nodes.sim_node.models.parts import Colour, Mesh, Part, Role, Shape, Vec3, bounds, rotation_matrix
from nodes.sim_node.physics import build

MESHES = (".obj", ".stl", ".glb")
SUFFIXES = (".xml", *MESHES)

_GREY: Colour = (0.66, 0.66, 0.68)
_LARGEST_FILE_BYTES = 64 << 20
_SHAPES = {
    int(mujoco.mjtGeom.mjGEOM_BOX): Shape.BOX,
    int(mujoco.mjtGeom.mjGEOM_ELLIPSOID): Shape.ELLIPSOID,
    int(mujoco.mjtGeom.mjGEOM_SPHERE): Shape.ELLIPSOID,
    int(mujoco.mjtGeom.mjGEOM_CYLINDER): Shape.CYLINDER,
    int(mujoco.mjtGeom.mjGEOM_CAPSULE): Shape.CAPSULE,
    int(mujoco.mjtGeom.mjGEOM_MESH): Shape.MESH,
}


@lru_cache(maxsize=256)
def read_model(path: Path, size_m: Vec3 | None, version: int) -> Model:
    """The model in a file, in metres, stretched to `size_m`; `version` tells a changed file apart.

    MJCF is taken in its initial configuration, as one rigid body that weighs what its bodies weigh. A mesh
    need not be closed: it collides as its hull, and weighs what most things of its size do. Raises
    ModelError, OSError.
    """
    check_size(size_m)
    if path.stat().st_size > _LARGEST_FILE_BYTES:
        raise ModelError(f"the model file {path} is larger than {_LARGEST_FILE_BYTES >> 20} MB")
    try:
        parts, density = _mesh_parts(path) if path.suffix in MESHES else _mjcf_parts(path)
        if all(part.role is Role.SEEN for part in parts):
            raise ModelError("it contains no colliding geometry")
        if size_m is not None:
            parts = _stretched(parts, size_m)
        extents = _extents(parts)
        check_size(extents, "; is the file in metres?")
        parts = _keyed(parts, f"{path}:{version}:{size_m}")
        model = assemble(str(path), parts, density * float(np.prod(extents)))
        _try_out(model)
    except OSError:
        raise
    except ModelError as error:
        raise ModelError(f"cannot use the model file {path}: {error}") from None
    except Exception as error:  # the readers of the file formats raise whatever they come across
        said = " ".join(str(error).split())
        if not isinstance(error, ValueError):  # a reader that stumbled, not one that complains
            said = f"its content is invalid ({type(error).__name__}: {said})"
        raise ModelError(f"cannot use the model file {path}: {said}") from None
    return model


def _extents(parts: list[Part]) -> Vec3:
    """What parts measure together [m]."""
    low, high = bounds(parts)
    return _vec3(high - low)


def _mesh_parts(path: Path) -> tuple[list[Part], float]:
    """The parts of a mesh file, and the density of the box around them [kg/m^3]."""
    import trimesh  # takes a second, which a start without such files need not wait

    scene = trimesh.load_scene(path)
    up = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]) if path.suffix == ".glb" else np.eye(3)  # glTF: y up
    parts = []
    for mesh in scene.dump():
        if len(mesh.faces):
            parts.append(_mesh_part(np.asarray(mesh.vertices) @ up.T, np.asarray(mesh.faces), _colour(mesh)))
    return parts, DENSITY


def _colour(mesh: Any) -> Colour:
    try:
        red, green, blue = np.asarray(mesh.visual.to_color().main_color)[:3] / 255.0
    except Exception:  # a texture that is missing leaves the mesh grey
        return _GREY
    return (float(red), float(green), float(blue))


def _mesh_part(vertices: Floats, faces: Any, colour: Colour, role: Role = Role.BOTH) -> Part:
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    middle, half = (low + high) / 2.0, (high - low) / 2.0
    mesh = Mesh("", vertices - middle, np.asarray(faces, dtype=np.int32))
    return Part(Shape.MESH, _vec3(half), _vec3(middle), colour, role=role, mesh=mesh)


def _mjcf_parts(path: Path) -> tuple[list[Part], float]:
    """The parts of an MJCF file, and the density of the box around them [kg/m^3]."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    parts = []
    for geom in range(model.ngeom):
        shape = _SHAPES.get(int(model.geom_type[geom]))
        if shape is None or (model.geom_bodyid[geom] == 0 and model.nbody > 1):
            continue  # planes and height fields, and the ground beneath the bodies
        rgba = (
            model.mat_rgba[model.geom_matid[geom]] if model.geom_matid[geom] >= 0 else model.geom_rgba[geom]
        )
        colour = (float(rgba[0]), float(rgba[1]), float(rgba[2]))
        role = Role.BOTH if model.geom_contype[geom] | model.geom_conaffinity[geom] else Role.SEEN
        role = Role.FELT if rgba[3] == 0.0 and role is Role.BOTH else role
        position, rotation = data.geom_xpos[geom], data.geom_xmat[geom].reshape(3, 3)
        if shape is Shape.MESH:
            vertices, faces = _mesh_of(model, int(model.geom_dataid[geom]))
            parts.append(_mesh_part(vertices @ rotation.T + position, faces, colour, role))
            continue
        turn = np.empty(4)
        mujoco.mju_mat2Quat(turn, data.geom_xmat[geom])
        parts.append(
            Part(
                shape,
                _half(model, geom),
                _vec3(position),
                colour,
                (float(turn[0]), float(turn[1]), float(turn[2]), float(turn[3])),
                role,
            )
        )
    if model.nbody == 1 or not parts:  # geoms without a body have no mass
        return parts, DENSITY
    mass_kg = float(model.body_mass[1:].sum())
    if mass_kg <= 0.0:
        raise ModelError("its mass is zero; give its geoms a mass or a density")
    return parts, mass_kg / max(float(np.prod(_extents(parts))), 1e-9)


def _half(model: mujoco.MjModel, geom: int) -> Vec3:
    a, b, c = (float(value) for value in model.geom_size[geom])
    kind = int(model.geom_type[geom])  # a NumPy integer is never among enumerations
    if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
        return (a, a, a)
    if kind in (mujoco.mjtGeom.mjGEOM_CYLINDER, mujoco.mjtGeom.mjGEOM_CAPSULE):
        return (a, a, b)
    return (a, b, c)


def _mesh_of(model: mujoco.MjModel, mesh: int) -> tuple[Floats, Any]:
    vertex, face = model.mesh_vertadr[mesh], model.mesh_faceadr[mesh]
    vertices = model.mesh_vert[vertex : vertex + model.mesh_vertnum[mesh]].astype(float)
    return vertices, model.mesh_face[face : face + model.mesh_facenum[mesh]]


def _stretched(parts: list[Part], size_m: Vec3) -> list[Part]:
    """Meshes are stretched along the model's axes, primitives along their own, which are mostly the same."""
    low, high = bounds(parts)
    factors = np.asarray(size_m) / np.maximum(high - low, 1e-6)
    scaled = []
    for part in parts:
        if part.mesh is not None:
            vertices = (part.mesh.vertices + part.centre) * factors
            scaled.append(_mesh_part(vertices, part.mesh.faces, part.colour, part.role))
        else:
            x, y, z = np.linalg.norm(factors[:, None] * rotation_matrix(part.turn), axis=0)
            if part.shape in (Shape.CYLINDER, Shape.CAPSULE):
                x = y = np.sqrt(x * y)  # what is round stays so
            half = _vec3(np.asarray(part.half) * (x, y, z))
            scaled.append(replace(part, half=half, centre=_vec3(np.asarray(part.centre) * factors)))
    return scaled


def _keyed(parts: list[Part], key: str) -> list[Part]:
    """Meshes get names that are theirs alone."""
    return [
        part if part.mesh is None else replace(part, mesh=replace(part.mesh, key=f"{key}:{number}"))
        for number, part in enumerate(parts)
    ]


def _try_out(model: Model) -> None:
    """Compile it alone, so that a bad one cannot spoil the world. Raises ModelError."""
    spec = mujoco.MjSpec()
    body = spec.worldbody.add_body()
    for part in model.parts:
        if part.mesh is not None:
            build.add_mesh(spec, part.mesh)
        build.add_part(body, part)
    try:
        spec.compile()
    except ValueError as error:
        fault, *_ = str(error).splitlines()  # the other lines name elements that are ours, not the file's
        raise ModelError(fault.removeprefix("Error: ")) from None


def _vec3(values: Any) -> Vec3:
    return (float(values[0]), float(values[1]), float(values[2]))
