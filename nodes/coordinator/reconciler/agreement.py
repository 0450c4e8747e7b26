"""Finds and describes the differences of map and scene. Pure functions."""

from __future__ import annotations

import math
from collections.abc import Container, Iterable, Mapping
from typing import NamedTuple

from semmap.nodes.coordinator.config import Thresholds, Truth
from semmap.nodes.coordinator.reconciler.reconcile import Actions, is_displaced, joints_differ
from semmap.schemas.attachments import holder_of
from semmap.schemas.entities import Entity, Pose, angle_rad, distance_m
from semmap.schemas.scenes import Body


class Agreement(NamedTuple):
    """Whether map and scene agree, and their differences, one sentence each."""

    holds: bool | None
    """None if there is nothing to compare: no simulator runs, or only perception updates the map."""
    pending: tuple[str, ...] = ()
    """Actions that the reconciler has not completed yet."""
    displaced: tuple[str, ...] = ()
    """Bodies that differ from their committed pose or joint positions."""


def find_displaced(
    entities: Mapping[str, Entity],
    bodies: Mapping[str, Body],
    truth: Truth,
    thresholds: Thresholds,
    without_state: Container[str] = (),
) -> tuple[str, ...]:
    """Return the names of the bodies that differ from their committed state by more than the thresholds.

    It does not matter whether a body moves, or has a live pose. An attached body is placed by its holder, and
    a part of a robot is named only if the robot is not.

    If only perception updates the map, just the robots of the simulator are compared. The joints of
    `without_state` bodies are ignored, because the ontology has no property for them.
    """
    found = [
        name
        for name, body in bodies.items()
        if (entity := entities.get(name)) is not None
        and (truth != "perceived" or entity.tracked == "sim")
        and (
            _is_elsewhere(entity, body, thresholds)
            or (body.joints and name not in without_state and joints_differ(entity, body, thresholds))
        )
    ]
    all_found = {*found}
    return tuple(name for name in sorted(found) if not _goes_with_a_whole(bodies[name], bodies, all_found))


def describe_displaced(entity: Entity, body: Body, thresholds: Thresholds) -> str:
    """Return how far a body is from its committed state, and whether it moves."""
    moving = not body.resting
    if entity.pose is not None and _is_elsewhere(entity, body, thresholds):
        return describe_distance(entity.name, entity.pose, body.pose, thresholds, moving=moving)
    return f"{entity.name} {_does(moving)}: its joints are not at their committed positions"


def describe_distance(name: str, committed: Pose, pose: Pose, thresholds: Thresholds, *, moving: bool) -> str:
    """Return in one sentence how far something is from its committed pose."""
    if (away_m := distance_m(committed, pose)) > thresholds.distance_m:
        return f"{name} {_does(moving)}: {away_m:.2g} m from its committed pose"
    turned_deg = math.degrees(angle_rad(committed, pose))
    return f"{name} {_does(moving)}: turned by {turned_deg:.0f}° from its committed pose"


def _does(moving: bool) -> str:
    return "is moving" if moving else "stands still"


def describe_pending(wanted: Actions, known: Container[str]) -> tuple[str, ...]:
    """Return the remaining actions of the reconciler, one sentence each.

    `known` names bodies that cannot become entities, or whose joints the map cannot store.
    """
    spawned = [order.name for order in wanted.spawn]
    adopted = [body for body in wanted.adopt if body.name not in known]
    return (
        *_each(spawned, "has no body yet"),
        *_each((name for name in wanted.delete if name not in spawned), "has a body that is not removed yet"),
        *_each((order.name for order in wanted.place), "is not at its committed pose yet"),
        *_each(
            (order.name for order in wanted.joints),
            "has joints that are not at their committed positions yet",
        ),
        *_each((order.name for order in wanted.grips), "is not attached or detached as committed yet"),
        *_each((order.name for order in wanted.follow), "has a new pose that is not committed yet"),
        *_each(
            (name for name in wanted.opened if name not in known),
            "has new joint positions that are not committed yet",
        ),
        *_each(wanted.gripped, "was attached or detached, which is not committed yet"),
        *map(_describe_unadopted, adopted),
    )


def _describe_unadopted(body: Body) -> str:
    text = f"{body.name} is a scene body that is not an entity yet"
    if body.resting or body.part_of:
        return text
    return f"{text}: it does not rest; if it overlaps a wall, use semmap move {body.name} --at X Y Z"


def _each(names: Iterable[str], what: str) -> tuple[str, ...]:
    return tuple(f"{name} {what}" for name in names)


def _is_elsewhere(entity: Entity, body: Body, thresholds: Thresholds) -> bool:
    if body.held_by or holder_of(entity) or entity.pose is None:
        return False
    return is_displaced(entity, body, thresholds)


def _goes_with_a_whole(body: Body, bodies: Mapping[str, Body], displaced: Container[str]) -> bool:
    above = body.part_of
    while above in bodies:
        if above in displaced:
            return True
        above = bodies[above].part_of
    return False
