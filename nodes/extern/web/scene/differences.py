"""What is drawn of how the moment shown differs from the one that it is compared with."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from msgspec import Struct

from semmap.nodes.extern.phrasing import changed_in_short
from semmap.nodes.extern.web import differences as of_maps
from semmap.nodes.extern.web.differences import Mark
from semmap.schemas.entities import Entity, Pose, Size

_UNKNOWN_M: Final[Size] = (0.2, 0.2, 0.2)


class Difference(Struct, frozen=True):
    """An entity where it was and where it is; one of them is None where only the other is to be drawn."""

    mark: Mark
    name: str
    then: Pose | None
    now: Pose | None
    size_m: Size
    text: str


def drawn(found: Mapping[str, of_maps.Difference]) -> list[Difference]:
    """Those of what has a position and is no place."""
    return [
        Difference(
            mark=difference.mark,
            name=name,
            then=_pose(difference.was),
            now=None if _pose(difference.was) == _pose(difference.now) else _pose(difference.now),
            size_m=_size_m(difference),
            text=f"{name} {_in_short(difference)}",
        )
        for name, difference in found.items()
        if not _is_nowhere(difference)
    ]


def _in_short(difference: of_maps.Difference) -> str:
    if difference.was is None or difference.now is None:
        return difference.mark
    return changed_in_short(difference.was, difference.now)


def _is_nowhere(difference: of_maps.Difference) -> bool:
    there = [entity for entity in (difference.was, difference.now) if entity is not None]
    return any(entity.place for entity in there) or all(entity.pose is None for entity in there)


def _pose(entity: Entity | None) -> Pose | None:
    return None if entity is None else entity.pose


def _size_m(difference: of_maps.Difference) -> Size:
    sizes = (entity.size_m for entity in (difference.now, difference.was) if entity is not None)
    return next((size_m for size_m in sizes if size_m is not None), _UNKNOWN_M)
