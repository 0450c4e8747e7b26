"""Values that are probably mistakes: noted in the reply, or refused where a class is surely wrong."""

from __future__ import annotations

import math
from collections.abc import Collection

from semmap.ontology.model_choice import chosen
from semmap.ontology.model_shapes import own_size_m
from semmap.schemas import errors
from semmap.schemas.commands import Attach, Move, Update
from semmap.schemas.entities import ClassInfo, Entity, Pose, Size
from semmap.schemas.polygons import extent_of

FAR_OFF = 10.0
"""A size is doubtful whose longest side is so many times its class's usual one, or its fraction."""


def require_same_nature(entity: Entity, found: ClassInfo | None, *, force: bool) -> None:
    """Raises Refused for a class that would make an object a place, or a place an object."""
    if force or found is None or found.place == entity.place:
        return
    is_, would_be = ("a place", "an object") if entity.place else ("an object", "a place")
    raise errors.Refused(
        f"{entity.name} is {is_} ({entity.class_}), and as a {found.name} it would be {would_be};"
        " if that is intended, add --force"
    )


def require_carry(command: Update | Move | Attach) -> None:
    """Raises BadRequest where something is to be left of what is not carried."""
    if command.leave and not command.carry:
        raise errors.BadRequest("--leave says what is not to be carried along: add --carry")


def find_doubts(
    name: str, found: ClassInfo | None, pose: Pose | None, size_m: Size | None, places: Collection[Entity]
) -> tuple[str, ...]:
    """What may be wrong with the pose and size of entity `name`, of class `found`; None for the unsaid."""
    return (*_outside(name, found, pose, places), *_odd_size(name, found, size_m))


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
    """Is the pose above the place's ground?"""
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
