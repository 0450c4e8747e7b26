"""Which entity can be attached to which, and where an attached entity is."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Final

from semmap.schemas import errors, wording
from semmap.schemas.attachments import carriers, grip_of, holder_of
from semmap.schemas.entities import Entity, Pose, bounds, compose, orientation_from_yaw, relative
from semmap.schemas.scenes import Body

REACH_M: Final = 0.3
"""An object farther from its holder is only attached if that is forced."""

PoseLookup = Callable[[str], Pose | None]
"""Returns the current pose of an entity, if it is known."""


def resolve_name(word: str, entities: Mapping[str, Entity]) -> str:
    """Return the name of an entity; `robot1/gripper` is resolved to `robot1_gripper`."""
    part = word.replace("/", "_")
    return part if word not in entities and part in entities else word


def require_attachable(
    held: Entity, holder: Entity, entities: Mapping[str, Entity], bodies: Mapping[str, Body]
) -> None:
    """Raise Refused, with the reason, if one entity cannot be attached to the other."""
    name, to = held.name, holder.name
    for entity in (held, holder):
        if entity.place:
            raise errors.Refused(f"{entity.name} is a place; only objects can be attached to each other")
    if name == to:
        raise errors.Refused(f"{name} cannot be attached to itself")
    if name in (above := carriers(to, entities)):
        how = (
            "is attached to"
            if holder_of(holder) == name
            else "is part of"
            if len(above) == 1
            else "moves with"
        )
        raise errors.Refused(f"{to} {how} {name}, so {name} cannot be attached to it")
    by = holder_of(held)
    if by and by != to:
        raise errors.Refused(f"{name} is already attached to {by}; first: semmap detach {name}")
    if why := _why_not_movable(held, bodies):
        raise errors.Refused(why)


def require_in_reach(held: Entity, holder: Entity, where: PoseLookup, bodies: Mapping[str, Body]) -> None:
    """Raise Refused if the free distance between two entities is larger than `REACH_M`.

    The distance is that of the boxes around them, map frame; an entity without a size is a point. Nothing is
    required of an entity without a pose, or that is attached already.
    """
    if holder_of(held) == holder.name:
        return
    boxes = []
    for entity in (held, holder):
        body = bodies.get(entity.name)
        pose = body.pose if body is not None else where(entity.name)
        if pose is None:
            return
        boxes.append(bounds(pose, body.size_m if body is not None else entity.size_m or (0.0, 0.0, 0.0)))
    (low, high), (its_low, its_high) = boxes
    gaps = (max(a - d, c - b, 0.0) for a, b, c, d in zip(low, high, its_low, its_high, strict=True))
    if (gap_m := math.hypot(*gaps)) > REACH_M:
        raise errors.Refused(
            f"{held.name} is {gap_m:.2g} m away from {holder.name}, farther than {REACH_M:g} m;"
            " move it there first, attach it --at a position, or add --force"
        )


def find_load(
    supported: Sequence[str],
    held: Entity,
    holder: Entity,
    entities: Mapping[str, Entity],
    bodies: Mapping[str, Body],
) -> tuple[str, ...]:
    """Return the contents that move with an entity: supported objects that are not fixed, parts or attached.

    Raises Refused if the holder itself is among the supported objects.
    """
    above = {holder.name, *carriers(holder.name, entities)}
    for name in supported:
        if name in above:
            who = holder.name if name == holder.name else f"{name}, which carries {holder.name},"
            raise errors.Refused(
                f"{who} is on or inside {held.name}, so {held.name} cannot be attached to {holder.name}"
            )
    there = (entities[name] for name in supported if name in entities)
    return tuple(
        entity.name for entity in there if not (_why_not_movable(entity, bodies) or holder_of(entity))
    )


def find_attached_with(entity: Entity, held: Mapping[str, Entity]) -> tuple[str, ...]:
    """Return what was attached to an entity by the same commit that attached the entity itself."""
    since = entity.grip_provenance
    return tuple(
        sorted(
            name
            for name, other in held.items()
            if holder_of(other) == entity.name
            and since is not None
            and other.grip_provenance is not None
            and other.grip_provenance.commit == since.commit
        )
    )


def _why_not_movable(held: Entity, bodies: Mapping[str, Body]) -> str:
    """Return why an entity cannot be attached: it is fixed or a part. Return "" if it can."""
    body = bodies.get(held.name)
    if body is not None and body.part_of:
        return f"{held.name} is part of {body.part_of} and cannot be separated from it"
    if held.fixed or (body is not None and body.fixed):
        return f"{held.name} is fixed, so it cannot be attached"
    return ""


def compute_grip(
    held: Pose | None, holder: Pose | None, at: tuple[float, float, float] | None, yaw: float | None
) -> Pose | None:
    """Return the pose of an attached entity in the frame of its holder; None if it is unknown.

    `held` and `holder` are their current poses (map frame). `at` [m] and `yaw` [rad] are the wanted values in
    the holder's frame.
    """
    now = None if held is None or holder is None else relative(held, holder)
    if at is None and now is None:
        return None
    turn = now.orientation_wxyz if now is not None else orientation_from_yaw(0.0)
    position = at if at is not None else now.position_m if now is not None else (0.0, 0.0, 0.0)
    return Pose(position_m=position, orientation_wxyz=turn if yaw is None else orientation_from_yaw(yaw))


def attached_pose(entity: Entity, where: PoseLookup) -> Pose | None:
    """Return the pose of an attached entity, from its holder's; None if it is not attached or unknown."""
    by, gripped = holder_of(entity), grip_of(entity)
    if not by or gripped is None:
        return None
    holder = where(by)
    return None if holder is None else compose(holder, gripped)


def require_detached(entity: Entity) -> None:
    """Raise Refused for an attached entity: its pose follows from its holder."""
    if by := holder_of(entity):
        raise errors.Refused(
            f"{entity.name} is attached to {by}; to move it, first: semmap detach {entity.name}"
        )


def require_no_attachments(leaving: Collection[str], held: Mapping[str, Entity]) -> None:
    """Raise Refused if an entity to remove has an entity attached that stays."""
    stay = [(holder_of(entity), name) for name, entity in held.items() if name not in leaving]
    for holder in sorted({by for by, _ in stay if by in leaving}):
        things = sorted(name for by, name in stay if by == holder)
        are = "is" if len(things) == 1 else "are"
        raise errors.Refused(
            f"{wording.few(things)} {are} attached to {holder}; first: semmap detach {things[0]}"
        )
