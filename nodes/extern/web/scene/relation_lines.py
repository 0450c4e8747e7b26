"""The relations of an entity as labelled lines."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final

from msgspec import Struct

from semmap.schemas.entities import Vector
from semmap.schemas.relations import PHRASES, SIDES, Relation, RelationName

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
