"""Checks for values that are probably mistakes: noted in the reply, or rejected if the class is wrong."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable

from semmap.ontology.model_choice import chosen
from semmap.ontology.model_shapes import own_size_m
from semmap.schemas import errors, wording
from semmap.schemas.commands import Attach, Move, Update
from semmap.schemas.entities import ClassInfo, Entity, Pose, Size
from semmap.schemas.polygons import extent_of

ALONE_M = 10.0
"""A new pose is doubtful if it is farther than this from all other objects [m]."""
FAR_OFF = 10.0
"""A size is doubtful if its longest side differs by this factor from the usual size of its class."""


def require_same_nature(entity: Entity, found: ClassInfo | None, *, force: bool) -> None:
    """Raise Refused for a class that would turn an object into a place, or a place into an object."""
    if force or found is None or found.place == entity.place:
        return
    is_, would_be = ("a place", "an object") if entity.place else ("an object", "a place")
    raise errors.Refused(
        f"{entity.name} is {is_} ({entity.class_}), and as a {found.name} it would be {would_be};"
        " if that is intended, add --force"
    )


def require_carry(command: Update | Move | Attach) -> None:
    """Raise BadRequest if entities are excluded from contents that are not carried."""
    if command.leave and not command.carry:
        raise errors.BadRequest("--leave requires --carry: it excludes contents from being carried along")


def find_doubts(
    name: str, found: ClassInfo | None, pose: Pose | None, size_m: Size | None, places: Collection[Entity]
) -> tuple[str, ...]:
    """Return what may be wrong with the pose and size of entity `name` of class `found`."""
    return (*_outside(name, found, pose, places), *_odd_size(name, found, size_m))


def find_doubtful_name(name: str) -> tuple[str, ...]:
    """Return a note on a new name that reads like a text."""
    if not wording.reads_like_text(name):
        return ()
    return (f"the name {name} reads like a text, which an agent could take for an instruction",)


def find_isolation(name: str, pose: Pose, others: Iterable[Pose]) -> tuple[str, ...]:
    """Return a note if a body is moved far away from all other bodies."""
    away_m = min((math.dist(pose.position_m, other.position_m) for other in others), default=0.0)
    if away_m <= ALONE_M:
        return ()
    x, y, _ = pose.position_m
    return (f"{name} at ({x:g}, {y:g}) is {away_m:.3g} m away from the nearest other object",)


def _outside(
    name: str, found: ClassInfo | None, pose: Pose | None, places: Collection[Entity]
) -> tuple[str, ...]:
    if pose is None or (found is not None and found.place):
        return ()
    sized = [place for place in places if place.pose is not None and place.size_m is not None]
    if not sized or any(_is_over(place, pose) for place in sized):
        return ()
    return ("{} at ({:g}, {:g}) is outside every place of the map".format(name, *pose.position_m[:2]),)


def _is_over(place: Entity, pose: Pose) -> bool:
    """Return whether the pose is above the ground of a place."""
    if place.pose is None:
        raise errors.InternalError(f"{place.name} has no pose")
    if place.size_m is None:
        raise errors.InternalError(f"{place.name} has no size")
    if (extent := extent_of(place)) is not None:
        return extent.contains(pose.position_m[:2])
    dx, dy = (a - b for a, b in zip(pose.position_m[:2], place.pose.position_m[:2], strict=True))
    c, s = math.cos(place.pose.yaw_rad), math.sin(place.pose.yaw_rad)
    width, depth, _ = place.size_m
    return abs(c * dx + s * dy) <= width / 2.0 and abs(c * dy - s * dx) <= depth / 2.0


def _odd_size(name: str, found: ClassInfo | None, size_m: Size | None) -> tuple[str, ...]:
    if found is None or size_m is None or found.place:
        return ()
    usual = own_size_m(chosen(found.model, name, size_m))
    if usual is None or 1.0 / FAR_OFF < max(size_m) / max(usual) < FAR_OFF:
        return ()
    return (f"{_metres(size_m)} is far from the usual size of a {found.name}, {_metres(usual)}",)


def _metres(size_m: Size) -> str:
    return " x ".join(f"{float(f'{extent:.3g}'):g}" for extent in size_m) + " m"
