"""Compares map and scene, and returns the actions that bring them into agreement. A pure function.

It is level-triggered: it looks only at the current states, so it also corrects what was missed while a node
was away.

The last change wins. A body has the number of the commit whose pose it was last ordered to take, and an
entity that of the commit which last changed its pose. If the map's number is higher, and its pose did not
come from the scene, the body is placed. Otherwise a body that rests elsewhere was moved, and the map follows.
The same rule applies to joints and attachments with their own commit numbers. An attached body is placed by
its holder only.

If only perception updates the map (`perceived`), entities need no bodies, and differences are left to
perception. Only robots of the simulator become entities, and entities tracked from the simulator are
followed. An entity that is tracked from a stream never follows its body.

A robot of a new simulator is placed at its last committed pose. If the map is `replayed`, every pose is an
order, also those that came from the scene, and the map follows nothing.
"""

from __future__ import annotations

from collections.abc import Container, Mapping, Set
from typing import NamedTuple

from semmap.nodes.coordinator.config import Thresholds, Truth
from semmap.ontology.model_shapes import is_same_size
from semmap.schemas import errors
from semmap.schemas.attachments import grip_of, holder_of
from semmap.schemas.entities import Entity, Pose, angle_rad, distance_m
from semmap.schemas.joints import (
    IS_OPEN,
    IS_SWITCHED_ON,
    JOINT_POSITIONS,
    OPEN_FROM,
    OPENNESS,
    SWITCH_POSITIONS,
    Joint,
    is_on,
    openness,
    select_joint_properties,
    wanted,
)
from semmap.schemas.scenes import Body, BodyOrder, GripOrder, JointOrder, Placement

_EXACT = Thresholds(distance_m=0.001, angle_rad=0.002, share=0.001)


class Actions(NamedTuple):
    """The actions: for the scene (`delete` before `spawn`), and for the map."""

    delete: tuple[str, ...] = ()
    spawn: tuple[BodyOrder, ...] = ()
    place: tuple[Placement, ...] = ()
    follow: tuple[Placement, ...] = ()
    """Poses that the map commits from the scene."""
    joints: tuple[JointOrder, ...] = ()
    """Joints that the scene moves to their committed positions."""
    opened: tuple[str, ...] = ()
    """Bodies whose joint positions the map commits."""
    adopt: tuple[Body, ...] = ()
    """Bodies that become entities."""
    missing: tuple[str, ...] = ()
    """Entities without the body that the scene should have; no action is taken."""
    grips: tuple[GripOrder, ...] = ()
    """Bodies that are attached or detached as the map says."""
    gripped: tuple[str, ...] = ()
    """Bodies whose attachment the map commits."""
    resized: tuple[str, ...] = ()
    """Bodies whose size the map commits: the world file has changed."""


def reconcile(
    entities: Mapping[str, Entity],
    bodies: Mapping[str, Body],
    truth: Truth,
    thresholds: Thresholds,
    failed: Mapping[str, int] | None = None,
    there: Container[str] | None = None,
) -> Actions:
    """Return the actions that bring map and scene into agreement; none if they agree.

    `failed` maps entities whose body could not be created to the commit of the attempt. They are not tried
    again before the entity changes.
    """
    if truth == "perceived":
        tracked = (e for e in entities.values() if e.tracked == "sim" and e.name in bodies)
        moved = (
            bodies[e.name]
            for e in tracked
            if not _must_restore(e, bodies[e.name]) and _moved(e, bodies[e.name], thresholds)
        )
        begin = (
            _placement(e) for e in entities.values() if e.name in bodies and _must_restore(e, bodies[e.name])
        )
        return Actions(
            place=tuple(placement for placement in begin if not bodies[placement.name].part_of),
            follow=tuple(Placement(name=body.name, pose=body.pose) for body in moved),
            adopt=tuple(body for name, body in bodies.items() if body.robot and name not in entities),
        )
    failed, there = failed or {}, bodies if there is None else there
    delete, spawn, place, follow, joints, opened, adopt, missing = [], [], [], [], [], [], [], []
    grips: list[GripOrder] = []
    gripped: list[str] = []
    resized: list[str] = []
    coming = {
        latest_commit(e) for e in entities.values() if not (e.place or e.pose is None or e.name in bodies)
    }
    for name, entity in entities.items():
        body = bodies.get(name)
        if entity.place:
            if body is not None and body.entity:
                delete.append(name)
        elif truth == "scene":
            if body is None:
                missing.append(name)
                continue
            if _is_resized(entity, body):
                resized.append(name)
            if _is_attached_differently(entity, body, thresholds):
                gripped.append(name)
            elif _must_restore(entity, body):
                if not body.part_of:
                    place.append(_placement(entity))
            elif not body.held_by and _moved(entity, body, thresholds):
                follow.append(Placement(name=name, pose=body.pose))
            if body.joints and body.resting and joints_differ(entity, body, thresholds):
                opened.append(name)
        elif body is None or _reshaped(entity, body) or _comes_with(entity, body, coming):
            if entity.pose is not None and failed.get(name) != latest_commit(entity):
                spawn.append(body_order(entity, entity.pose))
                if body is not None:
                    delete.append(name)
        else:
            replayed = truth == "replayed"
            if _grip_ordered_since(entity, body, any_source=replayed):
                if holder_of(entity) in there or not holder_of(entity):
                    grips.append(grip_order(entity))
            elif not replayed and _is_attached_differently(entity, body, thresholds):
                gripped.append(name)
            if holder_of(entity) or (body.held_by and name in gripped):
                pass  # its pose follows from its holder
            elif _must_restore(entity, body) and body.part_of:
                pass  # it moves with the robot
            elif (
                _must_restore(entity, body)
                or _ordered_since(entity, body)
                or (replayed and _posed_since(entity, body))
            ):
                place.append(_placement(entity))
            elif not replayed and _moved(entity, body, thresholds):
                follow.append(Placement(name=name, pose=body.pose))
            if body.joints and _joints_ordered_since(entity, body, any_source=replayed):
                joints.append(joint_order(entity, body))
            elif body.joints and not replayed and body.resting and joints_differ(entity, body, thresholds):
                opened.append(name)
    for name, body in bodies.items():
        if name not in entities:
            if truth == "scene" or (body.robot and truth != "replayed"):
                adopt.append(body)
            elif body.entity:
                delete.append(name)
    return Actions(
        tuple(delete),
        tuple(spawn),
        tuple(place),
        tuple(follow),
        tuple(joints),
        tuple(opened),
        tuple(adopt),
        tuple(missing),
        tuple(grips),
        tuple(gripped),
        tuple(resized),
    )


def body_order(entity: Entity, pose: Pose) -> BodyOrder:
    """Return the order for the body of an entity."""
    return BodyOrder(
        name=entity.name,
        class_=entity.class_,
        model=entity.model,
        pose=pose,
        size_m=entity.size_m,
        fixed=entity.fixed,
        properties=select_joint_properties(entity.properties),
        commit=latest_commit(entity),
    )


def _placement(entity: Entity) -> Placement:
    """Return the placement of a body at the committed pose of its entity."""
    if entity.pose is None:
        raise errors.InternalError(f"{entity.name} has no pose")
    return Placement(name=entity.name, pose=entity.pose, commit=entity.pose_provenance.commit)


def _must_restore(entity: Entity, body: Body) -> bool:
    """Return whether a robot, or a part of one, has to be restored to its last pose after a restart."""
    return body.robot and body.commit < 0 and entity.pose is not None


def joint_order(entity: Entity, body: Body) -> JointOrder:
    """Return the order for the joints of a body; it is empty if they rest at their committed positions.

    A moving joint may be on its way to an earlier target, so it is always ordered. The target is exact: the
    thresholds apply only to manual changes.
    """
    stated = entity.joints_said
    suits = body.resting and not joints_differ(entity, body, _EXACT)
    return JointOrder(
        name=entity.name,
        positions={} if suits else wanted(body.joints, entity.properties),
        commit=stated.commit if stated is not None else entity.provenance.commit,
    )


def grip_order(entity: Entity) -> GripOrder:
    """Return the order to attach or detach the body of an entity."""
    stated = entity.grip_provenance or entity.provenance
    return GripOrder(name=entity.name, holder=holder_of(entity), grip=grip_of(entity), commit=stated.commit)


def _grip_ordered_since(entity: Entity, body: Body, *, any_source: bool = False) -> bool:
    """Return whether the map changed the attachment after the body, which may not have had any order yet."""
    stated = entity.grip_provenance
    if stated is None:
        return False
    if body.grip_commit < 0:
        return bool(holder_of(entity))
    return (any_source or stated.source != "scene") and stated.commit > body.grip_commit


def _is_attached_differently(entity: Entity, body: Body, thresholds: Thresholds) -> bool:
    """Return whether the attachment of a body differs from that in the map."""
    if body.held_by != holder_of(entity):
        return True
    if body.grip is None:
        return False
    stated = grip_of(entity)
    return (
        stated is None
        or distance_m(stated, body.grip) > thresholds.distance_m
        or angle_rad(stated, body.grip) > thresholds.angle_rad
    )


def latest_commit(entity: Entity) -> int:
    """Return the last commit that changed anything about the body."""
    joints = entity.joints_said
    latest = max(entity.pose_provenance.commit, entity.shape_provenance.commit)
    return latest if joints is None else max(latest, joints.commit)


def joints_differ(entity: Entity, body: Body, thresholds: Thresholds) -> bool:
    """Return whether the joints of a body are farther from their committed positions than the thresholds."""
    return _joints_differ_from(entity.properties, body, thresholds)


def joints_differ_from_model(body: Body, thresholds: Thresholds) -> bool:
    """Return whether the joints of a body are farther from where its model has them than the thresholds."""
    return bool(body.joints) and _joints_differ_from({}, body, thresholds)


def _joints_differ_from(stated: Mapping[str, object], body: Body, thresholds: Thresholds) -> bool:
    roughly_open = IS_OPEN in stated and stated.keys().isdisjoint((OPENNESS, JOINT_POSITIONS))
    roughly_on = IS_SWITCHED_ON in stated and SWITCH_POSITIONS not in stated
    share, on = openness(body.joints), is_on(body.joints)
    if roughly_open and share is not None and (share > OPEN_FROM) != stated[IS_OPEN]:
        return True
    if roughly_on and on is not None and on != stated[IS_SWITCHED_ON]:
        return True
    exact = [joint for joint in body.joints if not (roughly_on if joint.switches else roughly_open)]
    goals = wanted(exact, stated)
    return any(
        joint.name in goals and abs(joint.position - goals[joint.name]) > _tolerance(joint, thresholds)
        for joint in exact
    )


def _tolerance(joint: Joint, thresholds: Thresholds) -> float:
    """Return the tolerance of a joint [rad, m]."""
    if joint.has_ends:
        return thresholds.share * abs(joint.open_end - joint.position_at(0.0))
    return thresholds.distance_m if joint.kind == "slide" else thresholds.angle_rad


def _joints_ordered_since(entity: Entity, body: Body, *, any_source: bool = False) -> bool:
    """Return whether the map changed the joints after the body; `any_source` includes the scene."""
    stated = entity.joints_said
    return (
        stated is not None and (any_source or stated.source != "scene") and stated.commit > body.joint_commit
    )


def _is_resized(entity: Entity, body: Body) -> bool:
    """Return whether the map has the size of a body in an earlier world file."""
    if not body.surface or entity.size_m is None or entity.shape_provenance.source != "scene":
        return False
    return not is_same_size(entity.size_m, body.size_m)


def _reshaped(entity: Entity, body: Body) -> bool:
    return body.entity and entity.shape_provenance.commit > body.shape_commit


def _comes_with(entity: Entity, body: Body, coming: Set[int]) -> bool:
    """Return whether one commit moves an entity and adds others; all are then placed together."""
    return body.entity and _ordered_since(entity, body) and entity.pose_provenance.commit in coming


def _ordered_since(entity: Entity, body: Body) -> bool:
    return entity.pose_provenance.source != "scene" and _posed_since(entity, body)


def _posed_since(entity: Entity, body: Body) -> bool:
    return entity.pose is not None and entity.pose_provenance.commit > body.commit


def _moved(entity: Entity, body: Body, thresholds: Thresholds) -> bool:
    if not body.resting or entity.tracked == "stream":
        return False
    return is_displaced(entity, body, thresholds)


def is_displaced(entity: Entity, body: Body, thresholds: Thresholds) -> bool:
    """Return whether a body is farther from its committed pose than the thresholds, or has none."""
    if entity.pose is None:
        return True
    return (
        distance_m(entity.pose, body.pose) > thresholds.distance_m
        or angle_rad(entity.pose, body.pose) > thresholds.angle_rad
    )
