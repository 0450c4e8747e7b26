"""What the scene shows of the map besides bodies: relations as lines, and differences of moments as boxes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import Final

import numpy as np
from msgspec import Struct

from semmap.nodes.extern.phrasing import changed_in_short
from semmap.nodes.extern.web.differences import Difference, Mark
from semmap.nodes.extern.web.scene.annotations import Segments
from semmap.schemas.entities import Entity, Pose, Size, Vector
from semmap.schemas.relations import PHRASES, SIDES, Relation, RelationName
from semmap.schemas.scenes import Point

_WORDS: Final = {name: phrase.removeprefix("is ") for name, phrase in PHRASES.items()}
_WITH_DISTANCE: Final = frozenset((*SIDES, "isUnder", "isAbove", "isNear", "isNextTo"))
"""The relations whose distance is shown."""
_IMPLIED: Final[dict[RelationName, frozenset[RelationName]]] = {
    "isOn": frozenset(("isNear", "isNextTo", "touches", "isAbove", "isUnder")),
    "isInside": frozenset(("isNear", "isNextTo", "touches", "isUnder", "isAbove")),
    "isAttachedTo": frozenset(("isNear", "isNextTo", "touches")),
    "isLeaningAgainst": frozenset(("isNear", "isNextTo", "touches")),
    "isNextTo": frozenset(("isNear",)),
}
"""Relations that are implied by another one, and thus not shown with it."""
_PATH_M, _CROSS_M = 0.03, 0.12
"""The height of the lines of a drive above the floor, and the length of the arms of a cross."""
_UNKNOWN_M: Final[Size] = (0.2, 0.2, 0.2)


class RelationLine(Struct, frozen=True):
    """A line between the centres of two entities, with its label."""

    a: Vector
    b: Vector
    text: str


def relation_lines(
    name: str, relations: Iterable[Relation], centres: Mapping[str, Vector]
) -> list[RelationLine]:
    """Return one line for each entity that is related to `name`, the nearest first.

    `centres` [m] has the entities that are drawn. Places are not among them, and get no lines.
    """
    by_other: dict[str, list[Relation]] = {}
    for relation in relations:
        if relation.holds:
            for other in {relation.subject, relation.object, relation.and_object or ""} - {name, ""}:
                by_other.setdefault(other, []).append(relation)
    return [
        RelationLine(centres[name], centres[other], _text(name, found))
        for other, found in sorted(by_other.items(), key=lambda each: min(r.gap_m for r in each[1]))
        if other in centres and name in centres
    ]


def path_lines(path: Sequence[Point], start: Vector) -> Segments:
    """Return the lines of a drive on the floor from a robot at `start`, with a cross at the goal [m]."""
    x, y, z = start
    height_m = z + _PATH_M
    corners = [(x, y, height_m), *((px, py, height_m) for px, py in path)]
    goal_x, goal_y, _ = corners[-1]
    arms = [
        ((goal_x - dx, goal_y - dy, height_m), (goal_x + dx, goal_y + dy, height_m))
        for dx, dy in ((_CROSS_M, _CROSS_M), (_CROSS_M, -_CROSS_M))
    ]
    return np.array([*pairwise(corners), *arms], dtype=np.float32)


def _text(name: str, relations: list[Relation]) -> str:
    kinds = {relation.relation for relation in relations}
    implied = frozenset().union(*(_IMPLIED.get(kind, frozenset()) for kind in kinds))
    texts = [_words(name, relation) for relation in relations if relation.relation not in implied]
    return ", ".join(dict.fromkeys(texts))


def _words(name: str, relation: Relation) -> str:
    subject = "" if relation.subject == name else f"{relation.subject} "
    distance = f" {_distance(relation.gap_m)}" if relation.relation in _WITH_DISTANCE else ""
    return f"{subject}{_WORDS[relation.relation]}{distance}"


def _distance(metres: float) -> str:
    return f"{metres:.2f} m" if metres >= 1.0 else f"{100.0 * metres:.0f} cm"


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
