"""The reconciler: the actions that bring map and scene into agreement. A pure function, level-triggered.

It looks only at how things are, never at how they came to be, so it also mends what was missed while any
node was away. Who changed last wins: a body carries the number of the commit whose pose it was last ordered
to take, an entity that of the commit which last changed its pose. If the map's is later, and did not itself
come from the scene, the body is ordered there; otherwise a body that rests elsewhere was moved, and the map
follows. The same goes for joints, and for what holds a body, by the commits that concern these; what is held
is where its holder takes it, and neither is put anywhere nor followed.

If only perception updates the map (`perceived`), nothing is to be done: an entity without a body is a belief,
a body without an entity has not been seen yet, and a pose that differs will be seen. Only a robot of the
simulator becomes an entity, and what is tracked from there is followed, all the same. What is tracked from a
stream never follows its body. Whatever the truth is, a robot of a simulator that has just begun is put where
the map says that it last stood. If the map is `replayed`, every pose of it is an order, also those that came
from the scene, and the map follows nothing.
"""

from __future__ import annotations

from collections.abc import Container, Mapping, Set
from typing import NamedTuple

from semmap.nodes.coordinator.config import Thresholds, Truth
from semmap.schemas import errors
from semmap.schemas.attachments import grip_of, holder_of
from semmap.schemas.entities import Entity, Pose, angle_rad, distance_m
from semmap.schemas.joints import (
    IS_OPEN,
    IS_SWITCHED_ON,
    JOINT_POSITIONS,
    OPEN_FROM,
    OPENNESS,
    STANDING,
    SWITCH_POSITIONS,
    Joint,
    is_on,
    openness,
    wanted,
)
from semmap.schemas.scenes import Body, BodyOrder, GripOrder, JointOrder, Placement

_TO_THE_LETTER = Thresholds(distance_m=0.001, angle_rad=0.002, share=0.001)


class Actions(NamedTuple):
    """What must be done: to the scene (`delete` before `spawn`), and to the map."""

    delete: tuple[str, ...] = ()
    spawn: tuple[BodyOrder, ...] = ()
    place: tuple[Placement, ...] = ()
    follow: tuple[Placement, ...] = ()
    """Poses that the map takes over from the scene."""
    joints: tuple[JointOrder, ...] = ()
    """Joints that the scene moves to where the map says."""
    opened: tuple[str, ...] = ()
    """Bodies of which the map takes over how their joints stand."""
    adopt: tuple[Body, ...] = ()
    """Bodies that become entities."""
    missing: tuple[str, ...] = ()
    """Entities that the scene should have and does not; nothing is done about them."""
    grips: tuple[GripOrder, ...] = ()
    """Bodies that are to be held, or let go, as the map says."""
    gripped: tuple[str, ...] = ()
    """Bodies of which the map takes over who holds them."""


def reconcile(
    entities: Mapping[str, Entity],
    bodies: Mapping[str, Body],
    truth: Truth,
    thresholds: Thresholds,
    failed: Mapping[str, int] | None = None,
    there: Container[str] | None = None,
) -> Actions:
    """The actions that bring map and scene together; none when they agree.

    `failed` names the entities whose body could not be made, with the commit of which it was tried: it is
    not tried again before the entity changes.
    """
    if truth == "perceived":
        tracked = (e for e in entities.values() if e.tracked == "sim" and e.name in bodies)
        moved = (
            bodies[e.name]
            for e in tracked
            if not _begins(e, bodies[e.name]) and _moved(e, bodies[e.name], thresholds)
        )
        begin = (_placement(e) for e in entities.values() if e.name in bodies and _begins(e, bodies[e.name]))
        return Actions(
            place=tuple(placement for placement in begin if not bodies[placement.name].part_of),
            follow=tuple(Placement(name=body.name, pose=body.pose) for body in moved),
            adopt=tuple(body for name, body in bodies.items() if body.robot and name not in entities),
        )
    failed, there = failed or {}, bodies if there is None else there
    delete, spawn, place, follow, joints, opened, adopt, missing = [], [], [], [], [], [], [], []
    grips: list[GripOrder] = []
    gripped: list[str] = []
    coming = {latest(e) for e in entities.values() if not (e.place or e.pose is None or e.name in bodies)}
    for name, entity in entities.items():
        body = bodies.get(name)
        if entity.place:
            if body is not None and body.entity:
                delete.append(name)
        elif truth == "scene":
            if body is None:
                missing.append(name)
                continue
            if _is_held_otherwise(entity, body, thresholds):
                gripped.append(name)
            elif _begins(entity, body):
                if not body.part_of:
                    place.append(_placement(entity))
            elif not body.held_by and _moved(entity, body, thresholds):
                follow.append(Placement(name=name, pose=body.pose))
            if body.joints and body.resting and joints_differ(entity, body, thresholds):
                opened.append(name)
        elif body is None or _reshaped(entity, body) or _comes_with(entity, body, coming):
            if entity.pose is not None and failed.get(name) != latest(entity):
                spawn.append(order(entity, entity.pose))
                if body is not None:
                    delete.append(name)
        else:
            replayed = truth == "replayed"
            if _grip_ordered_since(entity, body, whoever=replayed):
                if holder_of(entity) in there or not holder_of(entity):
                    grips.append(grip_order(entity))
            elif not replayed and _is_held_otherwise(entity, body, thresholds):
                gripped.append(name)
            if holder_of(entity) or (body.held_by and name in gripped):
                pass  # where it is follows from what holds it
            elif _begins(entity, body) and body.part_of:
                pass  # it goes where the robot goes
            elif (
                _begins(entity, body)
                or _ordered_since(entity, body)
                or (replayed and _posed_since(entity, body))
            ):
                place.append(_placement(entity))
            elif not replayed and _moved(entity, body, thresholds):
                follow.append(Placement(name=name, pose=body.pose))
            if body.joints and _joints_ordered_since(entity, body, whoever=replayed):
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
    )


def order(entity: Entity, pose: Pose) -> BodyOrder:
    """The body that an entity wants."""
    return BodyOrder(
        name=entity.name,
        class_=entity.class_,
        model=entity.model,
        pose=pose,
        size_m=entity.size_m,
        fixed=entity.fixed,
        properties={
            name: said
            for name in STANDING
            if isinstance(said := entity.properties.get(name), (bool, int, float, str))
        },
        commit=latest(entity),
    )


def _placement(entity: Entity) -> Placement:
    """A body is put where the map says that the entity stands."""
    if entity.pose is None:
        raise errors.InternalError(f"{entity.name} has no pose")
    return Placement(name=entity.name, pose=entity.pose, commit=entity.pose_provenance.commit)


def _begins(entity: Entity, body: Body) -> bool:
    """Is it a robot, or a part of one, that has yet to be put where it stood when the simulator ended?"""
    return body.robot and body.commit < 0 and entity.pose is not None


def joint_order(entity: Entity, body: Body) -> JointOrder:
    """The positions that an entity wants of the joints of its body; none where they rest and suit it.

    What suits it and moves may be on its way to somewhere else, by an earlier order. A word is done to the
    letter: the thresholds are for what a hand leaves.
    """
    said = entity.joints_said
    suits = body.resting and not joints_differ(entity, body, _TO_THE_LETTER)
    return JointOrder(
        name=entity.name,
        positions={} if suits else wanted(body.joints, entity.properties),
        commit=said.commit if said is not None else entity.provenance.commit,
    )


def grip_order(entity: Entity) -> GripOrder:
    """What an entity wants its body to be held by: another body, or none."""
    said = entity.grip_provenance or entity.provenance
    return GripOrder(name=entity.name, holder=holder_of(entity), grip=grip_of(entity), commit=said.commit)


def _grip_ordered_since(entity: Entity, body: Body, *, whoever: bool = False) -> bool:
    """Has the map said since what holds it? So it has where nobody has told the body yet."""
    said = entity.grip_provenance
    if said is None:
        return False
    if body.grip_commit < 0:
        return bool(holder_of(entity))
    return (whoever or said.source != "scene") and said.commit > body.grip_commit


def _is_held_otherwise(entity: Entity, body: Body, thresholds: Thresholds) -> bool:
    """Is a body held by something else than the map says, or otherwise?"""
    if body.held_by != holder_of(entity):
        return True
    if body.grip is None:
        return False
    said = grip_of(entity)
    return (
        said is None
        or distance_m(said, body.grip) > thresholds.distance_m
        or angle_rad(said, body.grip) > thresholds.angle_rad
    )


def latest(entity: Entity) -> int:
    """The commit that last changed anything which concerns the body."""
    joints = entity.joints_said
    latest = max(entity.pose_provenance.commit, entity.shape_provenance.commit)
    return latest if joints is None else max(latest, joints.commit)


def joints_differ(entity: Entity, body: Body, thresholds: Thresholds) -> bool:
    """Return whether the joints of a body are farther from their committed positions than the thresholds."""
    return _joints_differ_from(entity.properties, body, thresholds)


def joints_differ_from_model(body: Body, thresholds: Thresholds) -> bool:
    """Return whether the joints of a body are farther from where its model has them than the thresholds."""
    return bool(body.joints) and _joints_differ_from({}, body, thresholds)


def _joints_differ_from(said: Mapping[str, object], body: Body, thresholds: Thresholds) -> bool:
    roughly_open = IS_OPEN in said and said.keys().isdisjoint((OPENNESS, JOINT_POSITIONS))
    roughly_on = IS_SWITCHED_ON in said and SWITCH_POSITIONS not in said
    share, on = openness(body.joints), is_on(body.joints)
    if roughly_open and share is not None and (share > OPEN_FROM) != said[IS_OPEN]:
        return True
    if roughly_on and on is not None and on != said[IS_SWITCHED_ON]:
        return True
    exact = [joint for joint in body.joints if not (roughly_on if joint.switches else roughly_open)]
    goals = wanted(exact, said)
    return any(
        joint.name in goals and abs(joint.position - goals[joint.name]) > _tolerance(joint, thresholds)
        for joint in exact
    )


def _tolerance(joint: Joint, thresholds: Thresholds) -> float:
    """How far a joint may be from where the map says [rad, m]."""
    if joint.has_ends:
        return thresholds.share * abs(joint.open_end - joint.position_at(0.0))
    return thresholds.distance_m if joint.kind == "slide" else thresholds.angle_rad


def _joints_ordered_since(entity: Entity, body: Body, *, whoever: bool = False) -> bool:
    """Has the map said since how they are to stand: by anybody but the scene, or by `whoever`?"""
    said = entity.joints_said
    return said is not None and (whoever or said.source != "scene") and said.commit > body.joint_commit


def _reshaped(entity: Entity, body: Body) -> bool:
    return body.entity and entity.shape_provenance.commit > body.shape_commit


def _comes_with(entity: Entity, body: Body, coming: Set[int]) -> bool:
    """Does one commit put it elsewhere and bring others? All are set down together, what carries first."""
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
