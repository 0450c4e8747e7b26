"""Models from MJCF files: the geoms of their bodies, and the joints that move some of them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any, NamedTuple

import mujoco
import numpy as np

from semmap.nodes.sim_node.models.library import DENSITY, ModelError
from semmap.nodes.sim_node.models.parts import Colour, Floats, Joint, Part, Role, Shape, Vec3, bounds, mesh
from semmap.nodes.sim_node.physics.joint_texts import JointTexts
from semmap.schemas import wording

_SHAPES = {
    int(mujoco.mjtGeom.mjGEOM_BOX): Shape.BOX,
    int(mujoco.mjtGeom.mjGEOM_ELLIPSOID): Shape.ELLIPSOID,
    int(mujoco.mjtGeom.mjGEOM_SPHERE): Shape.ELLIPSOID,
    int(mujoco.mjtGeom.mjGEOM_CYLINDER): Shape.CYLINDER,
    int(mujoco.mjtGeom.mjGEOM_CAPSULE): Shape.CAPSULE,
    int(mujoco.mjtGeom.mjGEOM_MESH): Shape.MESH,
}
_FREE, _BALL = int(mujoco.mjtJoint.mjJNT_FREE), int(mujoco.mjtJoint.mjJNT_BALL)
_SLIDE = int(mujoco.mjtJoint.mjJNT_SLIDE)


class MjcfModel(NamedTuple):
    """The content of an MJCF file, in metres, in its initial state."""

    parts: list[Part]
    density: float
    """Density of the bounding box of all parts [kg/m^3]."""
    notes: tuple[str, ...] = ()
    """What of the file is omitted, or does not move: one clause each."""


def read_mjcf(path: Path) -> MjcfModel:
    """Read all bodies of an MJCF scene.

    Hinges and slides move the same parts as in the file. A joint that moves all parts attaches the model to
    the world and is ignored. Raises ModelError, ValueError.
    """
    spec = mujoco.MjSpec.from_file(str(path))
    ends = JointTexts.of(spec)
    left_out = tuple(_left_out(spec))
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    geoms = [
        (geom, shape) for geom in range(model.ngeom) if (shape := shape_of_geom(model, geom)) is not None
    ]
    of_body, stiff = _joints(model, data, {int(model.geom_bodyid[geom]) for geom, _ in geoms}, ends)
    parts = [
        replace(part_of_geom(model, data, geom, shape), joint=of_body[int(model.geom_bodyid[geom])])
        for geom, shape in geoms
    ]
    if model.nbody == 1 or not parts:  # geoms without a body have no mass
        return MjcfModel(parts, DENSITY, left_out)
    mass_kg = float(model.body_mass[1:].sum())
    if mass_kg <= 0.0:
        raise ModelError("its mass is zero; give its geoms a mass or a density")
    low, high = bounds(parts)
    return MjcfModel(parts, mass_kg / max(float(np.prod(high - low)), 1e-9), (*stiff, *left_out))


def _left_out(spec: mujoco.MjSpec) -> Iterator[str]:
    """Yield what a model cannot add to another world."""
    for what, found in (
        ("tendon", spec.tendons),
        ("actuator", spec.actuators),
        ("equality constraint", spec.equalities),
    ):
        if found:
            named = [element.name for element in found if element.name]
            names = f" ({wording.few(named)})" if named else ""
            yield f"{len(found)} {what}{'s' if len(found) > 1 else ''}{names} omitted"


# joints


def _joints(
    model: mujoco.MjModel, data: mujoco.MjData, bodies: set[int], ends: JointTexts
) -> tuple[dict[int, Joint | None], list[str]]:
    """Return the joint that moves each of these bodies, if any, and which joints do not move."""
    chains = {body: list(_chain(model, body)) for body in bodies}
    while chains and all(chains.values()):  # a joint that moves everything is ignored
        chains = {body: chain[1:] for body, chain in chains.items()}
    numbers = {body: chain[0] for body, chain in chains.items() if chain}
    names = _names(model, sorted(set(numbers.values())))
    joints = {number: _joint(model, data, number, names[number], ends) for number in names}
    stiff = []
    for number in range(model.njnt):
        kind, body = int(model.jnt_type[number]), int(model.jnt_bodyid[number])
        if kind == _FREE or number in joints or body not in chains:
            continue
        name = model.joint(number).name or f"a joint of {model.body(body).name or 'an unnamed body'}"
        if kind == _BALL:
            stiff.append(f"{name} does not move, because it is a ball joint")
        elif body in numbers:
            stiff.append(f"{name} does not move, because {names[numbers[body]]} already moves that body")
    return {body: joints[numbers[body]] if body in numbers else None for body in bodies}, stiff


def _chain(model: mujoco.MjModel, body: int) -> list[int]:
    """Return the hinges and slides between the ground and a body, one per body."""
    found: list[int] = []
    while body:
        first, number = int(model.body_jntadr[body]), int(model.body_jntnum[body])
        found += [k for k in range(first, first + number) if model.jnt_type[k] not in (_FREE, _BALL)][:1]
        body = int(model.body_parentid[body])
    return found[::-1]


def _names(model: mujoco.MjModel, numbers: list[int]) -> dict[int, str]:
    """Return names of joints: their own, that of their body, or a number; without blanks."""
    found: dict[int, str] = {}
    for number in numbers:
        own = model.joint(number).name or model.body(int(model.jnt_bodyid[number])).name or "joint"
        stem = re.sub(r"[\s=/]+", "_", own)
        taken = set(found.values())
        found[number] = next(
            name for k in count(1) if (name := stem if k == 1 else f"{stem}_{k}") not in taken
        )
    return found


def _joint(model: mujoco.MjModel, data: mujoco.MjData, number: int, name: str, ends: JointTexts) -> Joint:
    """Return a hinge or slide, whose positions count from its initial one in the file."""
    limits: tuple[float, float] | None = None
    closed: float | None = None
    if model.jnt_limited[number]:
        drawn = float(model.qpos0[model.jnt_qposadr[number]])
        lower, upper = (float(limit) - drawn for limit in model.jnt_range[number])
        limits = (min(lower, 0.0), max(upper, 0.0))
        end = ends.closed_end(model.joint(number).name) or ("lower" if -lower <= upper else "upper")
        closed = limits[0] if end == "lower" else limits[1]
    return Joint(
        name=name,
        kind="slide" if model.jnt_type[number] == _SLIDE else "hinge",
        anchor=_vec3(data.xanchor[number]),
        axis=_vec3(data.xaxis[number]),
        range=limits,
        closed=closed,
        switch=limits is not None and ends.is_switch(model, number),
        friction=max(float(model.dof_frictionloss[model.jnt_dofadr[number]]), 0.1),
    )


# geoms


def shape_of_geom(model: mujoco.MjModel, geom: int) -> Shape | None:
    """Return the shape of a geom; None for planes and height fields, and for static geoms."""
    if model.geom_bodyid[geom] == 0 and model.nbody > 1:
        return None
    return _SHAPES.get(int(model.geom_type[geom]))


def part_of_geom(model: mujoco.MjModel, data: mujoco.MjData, geom: int, shape: Shape) -> Part:
    """Return a geom as a part, in the frame of the poses in `data`."""
    rgba = model.mat_rgba[model.geom_matid[geom]] if model.geom_matid[geom] >= 0 else model.geom_rgba[geom]
    colour: Colour = _vec3(rgba[:3])
    role = Role.BOTH if model.geom_contype[geom] | model.geom_conaffinity[geom] else Role.VISUAL
    role = Role.COLLISION if rgba[3] == 0.0 and role is Role.BOTH else role
    position, rotation = data.geom_xpos[geom], data.geom_xmat[geom].reshape(3, 3)
    if shape is Shape.MESH:
        vertices, faces = _mesh_of(model, int(model.geom_dataid[geom]))
        return mesh(vertices @ rotation.T + position, faces, colour, role)
    turn = np.empty(4)
    mujoco.mju_mat2Quat(turn, data.geom_xmat[geom])
    w, x, y, z = (float(value) for value in turn)
    return Part(shape, _half(model, geom), _vec3(position), colour, (w, x, y, z), role)


def _half(model: mujoco.MjModel, geom: int) -> Vec3:
    a, b, c = (float(value) for value in model.geom_size[geom])
    kind = int(model.geom_type[geom])  # a NumPy integer does not equal an enumeration
    if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
        return (a, a, a)
    if kind in (mujoco.mjtGeom.mjGEOM_CYLINDER, mujoco.mjtGeom.mjGEOM_CAPSULE):
        return (a, a, b)
    return (a, b, c)


def _mesh_of(model: mujoco.MjModel, number: int) -> tuple[Floats, Any]:
    vertex, face = model.mesh_vertadr[number], model.mesh_faceadr[number]
    vertices = model.mesh_vert[vertex : vertex + model.mesh_vertnum[number]].astype(float)
    return vertices, model.mesh_face[face : face + model.mesh_facenum[number]]


def _vec3(values: Any) -> Vec3:
    return (float(values[0]), float(values[1]), float(values[2]))
