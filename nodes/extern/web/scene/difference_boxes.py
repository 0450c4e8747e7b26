"""Boxes for the differences between the moment shown and the one compared with."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from msgspec import Struct

from semmap.nodes.extern.phrasing import changed_in_short
from semmap.nodes.extern.web.differences import Difference, Mark
from semmap.schemas.entities import Entity, Pose, Size

_UNKNOWN_M: Final[Size] = (0.2, 0.2, 0.2)


class DifferenceBox(Struct, frozen=True):
    """The old and the new pose of an entity; one of them is None if only the other is drawn."""

    mark: Mark
    name: str
    before: Pose | None
    now: Pose | None
    size_m: Size
    text: str


def difference_boxes(found: Mapping[str, Difference]) -> list[DifferenceBox]:
    """Return the boxes of the differences of entities that have a position and are not places."""
    return [
        DifferenceBox(
            mark=difference.mark,
            name=name,
            before=_pose(difference.was),
            now=None if _pose(difference.was) == _pose(difference.now) else _pose(difference.now),
            size_m=_size_m(difference),
            text=f"{name} {_in_short(difference)}",
        )
        for name, difference in found.items()
        if _is_drawn(difference)
    ]


def _in_short(difference: Difference) -> str:
    if difference.was is None or difference.now is None:
        return difference.mark
    return changed_in_short(difference.was, difference.now)


def _is_drawn(difference: Difference) -> bool:
    present = [entity for entity in (difference.was, difference.now) if entity is not None]
    return not any(entity.place for entity in present) and any(entity.pose is not None for entity in present)


def _pose(entity: Entity | None) -> Pose | None:
    return None if entity is None else entity.pose


def _size_m(difference: Difference) -> Size:
    sizes = (entity.size_m for entity in (difference.now, difference.was) if entity is not None)
    return next((size_m for size_m in sizes if size_m is not None), _UNKNOWN_M)
