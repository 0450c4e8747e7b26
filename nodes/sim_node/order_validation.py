"""Validates orders before execution: each is accepted, or rejected with a reason."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np
from msgspec import structs

from semmap.nodes.sim_node.bodies import BodyRecord
from semmap.nodes.sim_node.models.library import Model, ModelError
from semmap.nodes.sim_node.models.parts import Vec3
from semmap.nodes.sim_node.physics import build
from semmap.nodes.sim_node.physics.attachments import holders_of
from semmap.schemas.entities import Pose
from semmap.schemas.joints import Joint, stated
from semmap.schemas.scenes import BodyOrder, GripOrder, JointOrder, Placement

REACH_M = 1000.0
"""Maximum distance of a body from the origin."""

ModelSource = Callable[[str, Vec3 | None], Model]
"""Returns a model by name, at a size [m] or its own. Raises ModelError."""

Newcomer = tuple[BodyRecord, Model]


def validate_spawn(
    orders: Iterable[BodyOrder], models: ModelSource, taken: Callable[[str], bool]
) -> tuple[dict[str, Newcomer], dict[str, str]]:
    """Return the bodies to create by name, and the reasons why others cannot be created.

    Reading model files may take some time.
    """
    accepted: dict[str, Newcomer] = {}
    failed: dict[str, str] = {}
    for order in orders:
        try:
            if order.name in accepted:
                raise ModelError(f"body {order.name} is requested twice")
            if taken(order.name):
                raise ModelError(f"the scene already has a body named {order.name}")
            _check_reach(order.pose)
            accepted[order.name] = _newcomer(order, models(order.model, order.size_m))
        except ModelError as error:
            failed[order.name] = str(error)
    return accepted, failed


def _newcomer(order: BodyOrder, model: Model) -> Newcomer:
    x, y, z = model.inertial.centre_m
    record = BodyRecord(
        name=order.name,
        class_=order.class_,
        model=model.name,
        size_m=model.size_m,
        origin_m=(-x, -y, -z),
        ordered=order.pose,
        fixed=order.fixed,
        entity=order.commit > 0,
        masks=[build.mask_of(part) for part in model.parts],
        commit=order.commit,
        shape_commit=order.commit,
        joints=_joints(order, model),
        joint_names=tuple(build.leaf_name(order.name, leaf.joint.name) for leaf in model.leaves),
        joint_commit=order.commit,
    )
    return record, model


def _joints(order: BodyOrder, model: Model) -> tuple[Joint, ...]:
    """Return the joints of a model at the positions stated in the map."""
    joints = [
        Joint(
            name=leaf.joint.name,
            kind=leaf.joint.kind,
            lower=leaf.joint.range and leaf.joint.range[0],
            upper=leaf.joint.range and leaf.joint.range[1],
            closed=leaf.joint.closed,
            switch=leaf.joint.switch,
        )
        for leaf in model.leaves
    ]
    return place_joints(joints, order.properties)


def place_joints(joints: Iterable[Joint], properties: Mapping[str, object]) -> tuple[Joint, ...]:
    """Return joints at the positions stated in the map, or else at their initial ones."""
    joints = tuple(joints)
    at = stated(joints, properties) or {}
    return tuple(
        structs.replace(joint, position=_within(joint, at.get(joint.name, joint.initial))) for joint in joints
    )


def _within(joint: Joint, position: float) -> float:
    """Clamp a position to the joint's limits."""
    if joint.lower is None or joint.upper is None:
        return position
    return min(joint.upper, max(joint.lower, position))


def joint_targets(
    orders: Iterable[JointOrder], records: Mapping[str, BodyRecord]
) -> tuple[dict[str, dict[str, float]], dict[str, str]]:
    """Return target positions of each body's joints [rad, m], by joint name, and reasons for rejections.

    If several orders concern one joint, the last takes effect.
    """
    targets: dict[str, dict[str, float]] = {}
    failed: dict[str, str] = {}
    for order in orders:
        try:
            if order.name not in records:
                raise ModelError(f"the scene has no body named {order.name}")
            targets.setdefault(order.name, {}).update(_targets(order, records[order.name].joints))
        except ModelError as error:
            failed[order.name] = str(error)
    return targets, failed


def _targets(order: JointOrder, joints: Sequence[Joint]) -> dict[str, float]:
    movable = [joint for joint in joints if joint.kind != "ball" and order.joint in ("", joint.name)]
    if order.joint and not movable:
        names = ", ".join(joint.name for joint in joints) or "none"
        raise ModelError(f"{order.name} has no joint named {order.joint} that can be moved; it has: {names}")
    if order.positions is not None:
        return {
            joint.name: _within(joint, order.positions[joint.name])
            for joint in movable
            if joint.name in order.positions
        }
    driven = [joint for joint in movable if joint.opens or (order.joint and joint.switches)]
    if not driven:
        raise ModelError(f"{order.name} has no joint that opens")
    share = 1.0 if order.openness is None else order.openness
    return {joint.name: joint.position_at(share) for joint in driven}


def validate_moves(
    placements: Iterable[Placement], there: Mapping[str, BodyRecord]
) -> tuple[list[Placement], dict[str, str]]:
    """Return the moves to execute, and the reasons for rejections by name."""
    accepted: list[Placement] = []
    failed: dict[str, str] = {}
    for placement in placements:
        try:
            if placement.name not in there:
                raise ModelError(f"the scene has no body named {placement.name}")
            if (record := there[placement.name]).anchored:
                raise ModelError(
                    f"{placement.name} is fixed by {_describe_fixture(record)}; only its joints can move it"
                )
            if record.held_by:
                raise ModelError(
                    f"{placement.name} is attached to {record.held_by}; to move it, first:"
                    f" semmap detach {placement.name}"
                )
            _check_reach(placement.pose)
            accepted.append(placement)
        except ModelError as error:
            failed[placement.name] = str(error)
    return accepted, failed


def validate_grips(
    orders: Iterable[GripOrder], there: Mapping[str, BodyRecord]
) -> tuple[list[GripOrder], dict[str, str]]:
    """Return the attachments to change, and the reasons for rejections by name."""
    accepted: list[GripOrder] = []
    failed: dict[str, str] = {}
    for order in orders:
        try:
            for name in (order.name, *filter(None, (order.holder,))):
                if name not in there:
                    raise ModelError(f"the scene has no body named {name}")
            if order.holder:
                _check_grip(order, there)
            accepted.append(order)
        except ModelError as error:
            failed[order.name] = str(error)
    return accepted, failed


def _check_grip(order: GripOrder, there: Mapping[str, BodyRecord]) -> None:
    record = there[order.name]
    if order.name == order.holder:
        raise ModelError(f"cannot attach {order.name} to itself")
    if order.name in holders_of(order.holder, there):
        raise ModelError(f"cannot attach {order.name} to {order.holder}, which is attached to or part of it")
    if record.anchored or record.fixed:
        where = f"fixed by {_describe_fixture(record)}" if record.anchored else "a fixed body"
        raise ModelError(f"cannot attach {order.name}: it is {where}")
    if order.commit is None and record.held_by not in ("", order.holder):
        raise ModelError(f"{order.name} is already attached to {record.held_by}")


def _describe_fixture(record: BodyRecord) -> str:
    """Return what holds an anchored body. A body in a mere group of bodies is part of no entity."""
    return record.part_of or ("its joint" if record.joints else "the body around it")


def _check_reach(pose: Pose) -> None:
    distance = float(np.linalg.norm(pose.position_m))
    if distance > REACH_M:
        raise ModelError(f"position is {distance:.0f} m from the origin; the limit is {REACH_M:.0f} m")
