"""Adds bodies to a MuJoCo specification."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from itertools import combinations
from typing import TypeVar

import mujoco

from semmap.nodes.sim_node.bodies import BodyRecord, frame_of
from semmap.nodes.sim_node.models.library import Leaf, Model
from semmap.nodes.sim_node.models.parts import Mesh, Part, Role, Shape, Vec3
from semmap.schemas.entities import Pose

Made = TypeVar("Made")

_GEOM = {
    Shape.BOX: mujoco.mjtGeom.mjGEOM_BOX,
    Shape.ELLIPSOID: mujoco.mjtGeom.mjGEOM_ELLIPSOID,
    Shape.CYLINDER: mujoco.mjtGeom.mjGEOM_CYLINDER,
    Shape.CAPSULE: mujoco.mjtGeom.mjGEOM_CAPSULE,
    Shape.MESH: mujoco.mjtGeom.mjGEOM_MESH,
}
_GROUP = {Role.BOTH: 0, Role.VISUAL: 2, Role.COLLISION: 3}
COLLISION_GROUP = _GROUP[Role.COLLISION]
"""The geom group that is invisible to cameras."""

_JOINT = {"hinge": mujoco.mjtJoint.mjJNT_HINGE, "slide": mujoco.mjtJoint.mjJNT_SLIDE}
_WIDTH = {
    int(mujoco.mjtJoint.mjJNT_FREE): (7, 6),
    int(mujoco.mjtJoint.mjJNT_BALL): (4, 3),
    int(mujoco.mjtJoint.mjJNT_SLIDE): (1, 1),
    int(mujoco.mjtJoint.mjJNT_HINGE): (1, 1),
}
_BATCH = 50
_PATIENCE_S = 0.01
_FRICTION = (0.8, 0.01, 0.004)
IMPEDANCE = (0.99, 0.99, 0.001, 0.5, 2.0)
"""Hardness of contacts (`solimp`), chosen so that leaning bodies and bodies on slopes do not creep.

MuJoCo's alternative, friction stiffer than the normal force, slows the solver by ten percent.
"""

_SPIN_S = 1.0
"""Time constant of a body's spin, which stops rolling cans without costly contacts."""

_HULL_VERTICES = 64
_MEMORY_BYTES = 32 << 20
_MEMORY_BYTES_A_BODY = 100 << 10


def add_bodies(spec: mujoco.MjSpec, newcomers: Sequence[tuple[BodyRecord, Model, Pose]]) -> None:
    """Add bodies, each at its pose.

    The time to add one grows with the size of the specification, so bodies are collected in small batches
    that are attached.
    """
    plain = [newcomer for newcomer in newcomers if not any(part.mesh for part in newcomer[1].parts)]
    for start in range(0, len(plain), _BATCH):
        batch = mujoco.MjSpec()
        for record, model, pose in plain[start : start + _BATCH]:
            add_body(batch, record, model, pose)
        _attach(spec, batch)
    for record, model, pose in newcomers:
        if any(part.mesh for part in model.parts):  # meshes are shared by the whole specification
            add_body(spec, record, model, pose)
        if model.leaves:
            _exclude_self_collisions(spec, record.name, model)


def _attach(spec: mujoco.MjSpec, batch: mujoco.MjSpec) -> None:
    """Attach all bodies of a small specification, with their names."""
    names = [(element, element.name) for element in (*batch.bodies[1:], *batch.joints)]
    spec.attach(batch, prefix=f"batch{len(spec.frames)}/", frame=spec.worldbody.add_frame())
    for element, name in names:
        element.name = name


def add_body(spec: mujoco.MjSpec, record: BodyRecord, model: Model, pose: Pose) -> None:
    """Add one body whose frame is its centre of mass; see `parts.inertial`."""
    position, quaternion = frame_of(pose, record.origin_m)
    body = spec.worldbody.add_body(name=record.name, pos=position, quat=quaternion)
    if not record.static:
        joint = body.add_freejoint(name=record.name)
        joint.damping = [max(model.inertial.moments) / _SPIN_S, 0.0, 0.0]
    body.explicitinertial, body.ipos, body.iquat = True, [0.0] * 3, [1.0, 0.0, 0.0, 0.0]
    body.mass, body.inertia = model.inertial.mass_kg, list(model.inertial.moments)
    for part in model.frame:
        if part.mesh is not None:
            add_mesh(spec, part.mesh)
        add_part(body, part, origin_m=record.origin_m, ghost=record.ghost)
    for leaf in model.leaves:
        _add_leaf(spec, body, record, leaf)


def leaf_name(body: str, joint: str) -> str:
    """Return the name of a joint and its moving part in MuJoCo; entity names contain no slash."""
    return f"{body}/{joint}"


def _add_leaf(spec: mujoco.MjSpec, body: mujoco.MjsBody, record: BodyRecord, leaf: Leaf) -> None:
    """Add the part that a joint moves as a child body, whose frame is its centre of mass."""
    x, y, z = (-centre for centre in leaf.inertial.centre_m)
    position = [shift - own for shift, own in zip(record.origin_m, (x, y, z), strict=True)]
    name = leaf_name(record.name, leaf.joint.name)
    child = body.add_body(name=name, pos=position)
    child.explicitinertial, child.ipos, child.iquat = True, [0.0] * 3, [1.0, 0.0, 0.0, 0.0]
    child.gravcomp = 1.0  # like a spring: with friction alone, a lid would creep down
    child.mass, child.inertia = leaf.inertial.mass_kg, list(leaf.inertial.moments)
    joint = child.add_joint(
        name=name,
        type=_JOINT[leaf.joint.kind],
        pos=[at + shift for at, shift in zip(leaf.joint.anchor, (x, y, z), strict=True)],
        axis=list(leaf.joint.axis),
        frictionloss=leaf.joint.friction,
    )
    if leaf.joint.range is not None:
        joint.limited = mujoco.mjtLimited.mjLIMITED_TRUE
        joint.range = [_as_compiled(spec, leaf.joint.kind, limit) for limit in leaf.joint.range]
        joint.solimp_limit = IMPEDANCE  # a load does not press the lid in
    else:
        joint.limited = mujoco.mjtLimited.mjLIMITED_FALSE
    joint.damping = [0.1 * leaf.joint.friction, 0.0, 0.0]
    for part in leaf.parts:
        if part.mesh is not None:
            add_mesh(spec, part.mesh)
        add_part(child, part, origin_m=(x, y, z), ghost=record.ghost)


def _as_compiled(spec: mujoco.MjSpec, kind: str, limit: float) -> float:
    """Return a limit in the angle unit of the specification."""
    return math.degrees(limit) if kind == "hinge" and spec.compiler.degree else limit


def _exclude_self_collisions(spec: mujoco.MjSpec, name: str, model: Model) -> None:
    """Exclude collisions among the parts of a body, such as a door and its frame."""
    bodies = [name, *(leaf_name(name, leaf.joint.name) for leaf in model.leaves)]
    for one, other in combinations(bodies, 2):
        spec.add_exclude(bodyname1=one, bodyname2=other)


def add_spare_bodies(spec: mujoco.MjSpec, parts: Sequence[tuple[bool, int]]) -> list[str]:
    """Add spare bodies, each static or free with this many parts; return their names."""
    names, batch = [], mujoco.MjSpec()
    for number, (static, count) in enumerate(parts):
        body = batch.worldbody.add_body(name=f"slot/{number}")
        names.append(body.name)
        if not static:
            body.add_freejoint(name=body.name)
        body.explicitinertial, body.ipos, body.iquat = True, [0.0] * 3, [1.0, 0.0, 0.0, 0.0]
        body.mass, body.inertia = 1.0, [1.0] * 3
        for _ in range(count):
            body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[1e-3] * 3, rgba=[0.5, 0.5, 0.5, 1.0])
    _attach(spec, batch)
    return names


def add_mesh(spec: mujoco.MjSpec, mesh: Mesh) -> None:
    """Add a mesh once; it collides as its convex hull."""
    if spec.mesh(mesh.key) is None:
        spec.add_mesh(
            name=mesh.key,
            uservert=mesh.vertices.ravel(),
            userface=mesh.faces.ravel(),
            inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX,
            maxhullvert=_HULL_VERTICES,
        )


def add_part(
    body: mujoco.MjsBody, part: Part, *, origin_m: Vec3 = (0.0, 0.0, 0.0), ghost: bool = False
) -> None:
    """Add one geom; `origin_m` is the model's bottom centre in the body's frame."""
    contype, conaffinity = (0, 0) if ghost else mask_of(part)
    body.add_geom(
        type=_GEOM[part.shape],
        meshname=part.mesh.key if part.mesh is not None else None,
        size=_geom_size(part),
        pos=[centre + shift for centre, shift in zip(part.centre, origin_m, strict=True)],
        quat=list(part.turn),
        rgba=[*part.colour, 1.0],
        group=_GROUP[part.role],
        contype=contype,
        conaffinity=conaffinity,
        condim=6 if part.shape is Shape.ELLIPSOID else 3,  # a ball needs friction against rolling
        friction=_FRICTION,
        solimp=IMPEDANCE,
    )


def _geom_size(part: Part) -> list[float]:
    a, b, c = part.half
    return [a, c, 0.0] if part.shape in (Shape.CYLINDER, Shape.CAPSULE) else [a, b, c]


def mask_of(part: Part) -> tuple[int, int]:
    """Return contype and conaffinity of a part."""
    return (0, 0) if part.role is Role.VISUAL else (1, 1)


def set_standing(spec: mujoco.MjSpec, record: BodyRecord, pose: Pose) -> None:
    """Set the pose of a body in `spec`, and its collision and joints as in the record."""
    body = spec.body(record.body)
    position, quaternion = frame_of(pose, record.origin_m)
    body.pos, body.quat = position, quaternion
    body.alt.type = mujoco.mjtOrientation.mjORIENTATION_QUAT
    for geom, (contype, conaffinity) in zip(body.geoms, record.masks, strict=True):
        geom.contype, geom.conaffinity = (0, 0) if record.ghost else (contype, conaffinity)
    if record.robot:  # only movable bodies may sleep
        policies = mujoco.mjtSleepPolicy
        body.sleep = policies.mjSLEEP_AUTO if record.static else policies.mjSLEEP_ALLOWED
    joints = body.joints
    if record.static:
        for joint in joints:
            if joint.type == mujoco.mjtJoint.mjJNT_FREE:
                spec.delete(joint)
    elif not joints:
        body.add_freejoint(name=record.name)


def run_in_background(make: Callable[[], Made], while_waiting: Callable[[], None]) -> Made:
    """Run `make` on another thread, and call `while_waiting` repeatedly until it is done.

    Compiling a thousand bodies takes a second, and five thousand half a minute.
    """
    with ThreadPoolExecutor(max_workers=1, thread_name_prefix="compile") as thread:
        making = thread.submit(make)
        while not wait([making], timeout=_PATIENCE_S).done:
            while_waiting()
        return making.result()


def set_memory(spec: mujoco.MjSpec, bodies: int) -> None:
    """Reserve memory for the contacts of this many bodies; unused pages are not allocated."""
    spec.memory = _MEMORY_BYTES + bodies * _MEMORY_BYTES_A_BODY


def carry_joints(
    old: mujoco.MjModel,
    old_data: mujoco.MjData,
    new: mujoco.MjModel,
    new_data: mujoco.MjData,
    names: Iterable[str],
) -> None:
    """Copy the state of these joints, and other state of a world file, to a new model."""
    for name in names:
        was, now = (mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name) for model in (old, new))
        if min(was, now) < 0 or old.jnt_type[was] != new.jnt_type[now]:
            continue
        positions, speeds = _WIDTH[int(new.jnt_type[now])]
        qpos, was_qpos = new.jnt_qposadr[now], old.jnt_qposadr[was]
        dof, was_dof = new.jnt_dofadr[now], old.jnt_dofadr[was]
        new_data.qpos[qpos : qpos + positions] = old_data.qpos[was_qpos : was_qpos + positions]
        new_data.qvel[dof : dof + speeds] = old_data.qvel[was_dof : was_dof + speeds]
    for field in ("act", "ctrl", "mocap_pos", "mocap_quat"):
        if getattr(new_data, field).shape == getattr(old_data, field).shape:
            getattr(new_data, field)[:] = getattr(old_data, field)
