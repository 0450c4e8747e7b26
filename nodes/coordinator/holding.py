"""What may be held by what, and where it is then."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence

from semmap.schemas import errors, wording
from semmap.schemas.attachments import carriers, grip_of, holder_of
from semmap.schemas.entities import Entity, Pose, compose, orientation_from_yaw, relative
from semmap.schemas.scenes import Body

Where = Callable[[str], Pose | None]
"""Where an entity is just now, if that is known."""


def named(word: str, entities: Mapping[str, Entity]) -> str:
    """The name of an entity, also of a part as `robot1/gripper`, which is called `robot1_gripper`."""
    part = word.replace("/", "_")
    return part if word not in entities and part in entities else word


def require_graspable(
    held: Entity, holder: Entity, entities: Mapping[str, Entity], bodies: Mapping[str, Body]
) -> None:
    """Raises Refused, with the reason, where one cannot be held by the other."""
    name, to = held.name, holder.name
    for entity in (held, holder):
        if entity.place:
            raise errors.Refused(f"{entity.name} is a place, which neither holds anything nor is held")
    if name == to:
        raise errors.Refused(f"{name} cannot hold itself")
    if name in (above := carriers(to, entities)):
        how = "is held by" if holder_of(holder) == name else "is part of" if len(above) == 1 else "goes with"
        raise errors.Refused(f"{to} {how} {name}, so it cannot hold {name}")
    by = holder_of(held)
    if by and by != to:
        raise errors.Refused(f"{name} is held by {by} already; first: semmap detach {name}")
    if why := _stays(held, bodies):
        raise errors.Refused(why)


def load(
    borne: Sequence[str],
    held: Entity,
    holder: Entity,
    entities: Mapping[str, Entity],
    bodies: Mapping[str, Body],
) -> tuple[str, ...]:
    """What goes with a thing that is taken, of all that it bears: not what is fixed, or part of something.

    Raises Refused where it bears what is to hold it.
    """
    above = {holder.name, *carriers(holder.name, entities)}
    for name in borne:
        if name in above:
            who = holder.name if name == holder.name else f"{name}, which {holder.name} goes with,"
            raise errors.Refused(
                f"{who} stands on {held.name} or is inside it, so {holder.name} cannot take {held.name} away"
            )
    there = (entities[name] for name in borne if name in entities)
    return tuple(entity.name for entity in there if not (_stays(entity, bodies) or holder_of(entity)))


def taken_with(entity: Entity, held: Mapping[str, Entity]) -> tuple[str, ...]:
    """What a held thing holds since it was taken itself, in the same commit: that came along with it."""
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


def _stays(held: Entity, bodies: Mapping[str, Body]) -> str:
    """Why nothing can take a thing: it is fixed, or part of another; "" for what can be taken."""
    body = bodies.get(held.name)
    if body is not None and body.part_of:
        return f"{held.name} is part of {body.part_of}, which cannot let go of it"
    if held.fixed or (body is not None and body.fixed):
        return f"{held.name} is fixed where it stands, so nothing can take it"
    return ""


def grip(
    held: Pose | None, holder: Pose | None, at: tuple[float, float, float] | None, yaw: float | None
) -> Pose | None:
    """Where a thing is held, in the frame of its holder; None where that is not known.

    `held` and `holder` are where both are just now (map frame); `at` [m] and `yaw` [rad] are where it is
    wanted, in the frame of the holder.
    """
    now = None if held is None or holder is None else relative(held, holder)
    if at is None and now is None:
        return None
    turn = now.orientation_wxyz if now is not None else orientation_from_yaw(0.0)
    position = at if at is not None else now.position_m if now is not None else (0.0, 0.0, 0.0)
    return Pose(position_m=position, orientation_wxyz=turn if yaw is None else orientation_from_yaw(yaw))


def carried_pose(entity: Entity, where: Where) -> Pose | None:
    """Where a held thing is, by where its holder is; None where nothing holds it, or that is unknown."""
    by, gripped = holder_of(entity), grip_of(entity)
    if not by or gripped is None:
        return None
    holder = where(by)
    return None if holder is None else compose(holder, gripped)


def require_free(entity: Entity) -> None:
    """Raises Refused for what something holds: it is where that is."""
    if by := holder_of(entity):
        raise errors.Refused(
            f"{entity.name} is held by {by}; to put it elsewhere, first: semmap detach {entity.name}"
        )


def require_empty_handed(leaving: Collection[str], held: Mapping[str, Entity]) -> None:
    """Raises Refused where one of those that leave holds something that stays."""
    stay = [(holder_of(entity), name) for name, entity in held.items() if name not in leaving]
    for holder in sorted({by for by, _ in stay if by in leaving}):
        things = sorted(name for by, name in stay if by == holder)
        raise errors.Refused(f"{holder} holds {wording.few(things)}; first: semmap detach {things[0]}")
