"""Shapes of the bodies of a world file, for the knowledge base, which does not read world files."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import replace
from typing import Final, Literal

import mujoco
import numpy as np
from msgspec import structs

from semmap.nodes.sim_node.models.library import Leaf, Model
from semmap.nodes.sim_node.models.mjcf_files import part_of_geom, shape_of_geom
from semmap.nodes.sim_node.models.parts import Floats, Joint, Role, Vec3, inertial, rotation_matrix
from semmap.nodes.sim_node.models.spaces import shape_of
from semmap.nodes.sim_node.models.write_shapes import as_json
from semmap.nodes.sim_node.world import World
from semmap.ontology.model_shapes import ModelShape, decode_shapes
from semmap.schemas.scenes import Body

_KINDS: Final[dict[int, Literal["hinge", "slide"]]] = {
    int(mujoco.mjtJoint.mjJNT_HINGE): "hinge",
    int(mujoco.mjtJoint.mjJNT_SLIDE): "slide",
}


def world_shapes(world: World) -> dict[str, ModelShape]:
    """Return the shape of each body of a world file, computed from its geoms like that of a library model.

    Shapes are in the frame of the bottom centre, with all joints at 0, to a tenth of a millimetre. A body
    without colliding geoms has none, and neither have robots, which change their shape.
    """
    model, data, names = world.snapshot()
    for joint in range(model.njnt):
        if int(model.jnt_type[joint]) in _KINDS:
            data.qpos[model.jnt_qposadr[joint]] = 0.0
    mujoco.mj_kinematics(model, data)
    geoms: dict[str, list[int]] = {}
    for geom, name in enumerate(names):
        geoms.setdefault(name, []).append(geom)
    found: dict[str, ModelShape] = {}
    alike: dict[bytes, ModelShape] = {}
    for body in world.scene().bodies:
        made = None if body.robot else _model_of(model, data, body, geoms.get(body.name, []))
        if made is None:
            continue
        key = _digest(made)
        if key not in alike:  # a scene may have hundreds of equal cups
            alike[key] = structs.replace(shape_of(made), turns=False)
        found[body.name] = alike[key]
    return decode_shapes(as_json(found))


def _model_of(model: mujoco.MjModel, data: mujoco.MjData, body: Body, geoms: list[int]) -> Model | None:
    """Return the parts of a body as a model in its own frame, or None without colliding geoms."""
    frame = rotation_matrix(body.pose.orientation_wxyz)
    origin = np.asarray(body.pose.position_m)
    shapes = [(geom, shape) for geom in geoms if (shape := shape_of_geom(model, geom)) is not None]
    if not shapes:
        return None
    for geom, _ in shapes:
        data.geom_xpos[geom] = (data.geom_xpos[geom] - origin) @ frame
        data.geom_xmat[geom] = (frame.T @ data.geom_xmat[geom].reshape(3, 3)).ravel()
    joints = _joints_of(model, data, body, origin, frame)
    parts = [
        replace(part_of_geom(model, data, geom, shape), joint=_joint_above(model, geom, joints))
        for geom, shape in shapes
    ]
    if all(part.role is Role.VISUAL for part in parts):
        return None
    fixed = tuple(part for part in parts if part.joint is None)
    mass = inertial(parts, 1.0)
    leaves = tuple(
        Leaf(joint, tuple(part for part in parts if part.joint is joint), mass)
        for joint in joints.values()
        if any(part.joint is joint for part in parts)
    )
    return Model(
        name=body.name,
        parts=(*fixed, *(part for leaf in leaves for part in leaf.parts)),
        inertial=mass,
        size_m=body.size_m,
        leaves=leaves,
    )


def _digest(model: Model) -> bytes:
    """Return a digest that is equal for bodies of equal parts, to a tenth of a millimetre."""
    found = hashlib.blake2b(digest_size=16)
    for part in model.parts:
        found.update(repr((part.shape, part.role, part.joint)).encode())
        numbers = (*model.size_m, *part.half, *part.centre, *part.turn)
        found.update((np.round(numbers, 4) + 0.0).tobytes())
        if part.mesh is not None:
            found.update((np.round(part.mesh.vertices, 4) + 0.0).tobytes())
    return found.digest()


def _joints_of(
    model: mujoco.MjModel, data: mujoco.MjData, body: Body, origin: Floats, frame: Floats
) -> dict[int, Joint]:
    """Return the hinges and slides of a body's parts by the number of the MuJoCo body that each moves."""
    found: dict[int, Joint] = {}
    root = model.body(body.body or body.name).id
    for joint in body.joints:
        number = model.joint(joint.name).id
        kind = _KINDS.get(int(model.jnt_type[number]))
        if kind is None or model.jnt_bodyid[number] == root:  # which moves the body itself, with its pose
            continue
        limits = None if joint.lower is None or joint.upper is None else (joint.lower, joint.upper)
        found.setdefault(
            int(model.jnt_bodyid[number]),
            Joint(
                name=joint.name,
                kind=kind,
                anchor=_vector((data.xanchor[number] - origin) @ frame),
                axis=_vector(data.xaxis[number] @ frame),
                range=limits,
                closed=joint.closed,
                switch=joint.switch,
            ),
        )
    return found


def _joint_above(model: mujoco.MjModel, geom: int, joints: Mapping[int, Joint]) -> Joint | None:
    """Return the joint nearest to the root that moves a geom: a handle moves with its door."""
    number, found = int(model.geom_bodyid[geom]), None
    while number:
        found = joints.get(number, found)
        number = int(model.body_parentid[number])
    return found


def _vector(values: Floats) -> Vec3:
    x, y, z = (float(value) for value in values)
    return x, y, z
