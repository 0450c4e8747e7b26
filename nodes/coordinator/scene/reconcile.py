"""The reconciler: the actions that bring map and scene into agreement. A pure function, level-triggered.

It looks only at how things are, never at how they came to be, so it also mends what was missed while any
node was away. Who changed last wins: a body carries the number of the commit whose pose it was last ordered
to take, an entity that of the commit which last changed its pose. If the map's is later, and did not itself
come from the scene, the body is ordered there; otherwise a body that rests elsewhere was moved, and the map
follows.

If only perception updates the map (`perceived`), nothing is to be done: an entity without a body is a belief,
a body without an entity has not been seen yet, and a pose that differs will be seen. Only what is tracked
from the simulator is followed all the same. What is tracked from a stream never follows its body. If the map
is `replayed`, every pose of it is an order, also those that came from the scene, and the map follows nothing.
"""

from __future__ import annotations

from collections.abc import Mapping, Set
from typing import NamedTuple

from nodes.coordinator.config import Thresholds, Truth
from schemas.entities import Entity, Pose, angle_rad, distance_m
from schemas.scenes import Body, BodyOrder, Placement


class Actions(NamedTuple):
    """What must be done: to the scene (`delete` before `spawn`), and to the map."""

    delete: tuple[str, ...] = ()
    spawn: tuple[BodyOrder, ...] = ()
    place: tuple[Placement, ...] = ()
    follow: tuple[Placement, ...] = ()
    """Poses that the map takes over from the scene."""
    adopt: tuple[Body, ...] = ()
    """Bodies that become entities."""
    missing: tuple[str, ...] = ()
    """Entities that the scene should have and does not; nothing is done about them."""


def reconcile(
    entities: Mapping[str, Entity],
    bodies: Mapping[str, Body],
    truth: Truth,
    thresholds: Thresholds,
    failed: Mapping[str, int] | None = None,
) -> Actions:
    """The actions that bring map and scene together; none when they agree.

    `failed` names the entities whose body could not be made, with the commit of which it was tried: it is
    not tried again before the entity changes.
    """
    if truth == "perceived":
        tracked = (e for e in entities.values() if e.tracked == "sim" and e.name in bodies)
        moved = (bodies[e.name] for e in tracked if _moved(e, bodies[e.name], thresholds))
        return Actions(follow=tuple(Placement(name=body.name, pose=body.pose) for body in moved))
    failed = failed or {}
    delete, spawn, place, follow, adopt, missing = [], [], [], [], [], []
    coming = {latest(e) for e in entities.values() if not (e.place or e.pose is None or e.name in bodies)}
    for name, entity in entities.items():
        body = bodies.get(name)
        if entity.place:
            if body is not None and body.entity:
                delete.append(name)
        elif truth == "scene":
            if body is None:
                missing.append(name)
            elif _moved(entity, body, thresholds):
                follow.append(Placement(name=name, pose=body.pose))
        elif body is None or _reshaped(entity, body) or _comes_with(entity, body, coming):
            if entity.pose is not None and failed.get(name) != latest(entity):
                spawn.append(order(entity, entity.pose))
                if body is not None:
                    delete.append(name)
        elif _ordered_since(entity, body) or (truth == "replayed" and _posed_since(entity, body)):
            assert entity.pose is not None
            place.append(Placement(name=name, pose=entity.pose, commit=entity.pose_provenance.commit))
        elif truth != "replayed" and _moved(entity, body, thresholds):
            follow.append(Placement(name=name, pose=body.pose))
    for name, body in bodies.items():
        if name not in entities:
            if truth == "scene":
                adopt.append(body)
            elif body.entity:
                delete.append(name)
    return Actions(tuple(delete), tuple(spawn), tuple(place), tuple(follow), tuple(adopt), tuple(missing))


def order(entity: Entity, pose: Pose) -> BodyOrder:
    """The body that an entity wants."""
    return BodyOrder(
        name=entity.name,
        class_=entity.class_,
        model=entity.model,
        pose=pose,
        size_m=entity.size_m,
        fixed=entity.fixed,
        commit=latest(entity),
    )


def latest(entity: Entity) -> int:
    """The commit that last changed anything which concerns the body."""
    return max(entity.pose_provenance.commit, entity.shape_provenance.commit)


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
    if entity.pose is None:
        return True
    return (
        distance_m(entity.pose, body.pose) > thresholds.distance_m
        or angle_rad(entity.pose, body.pose) > thresholds.angle_rad
    )
