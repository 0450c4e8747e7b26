"""The relations of a thing as lines, with their measures beside them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final

from msgspec import Struct

from semmap.schemas.entities import Vector
from semmap.schemas.relations import Relation, RelationName

_WORDS: Final[dict[RelationName, tuple[str, bool]]] = {
    "isOn": ("on", False),
    "isInside": ("inside", False),
    "isLocatedIn": ("in", False),
    "isAttachedTo": ("attached to", False),
    "touches": ("touches", False),
    "isUnder": ("under", True),
    "isAbove": ("above", True),
    "isNear": ("near", True),
    "isNextTo": ("next to", True),
    "isLeftOf": ("left of", True),
    "isRightOf": ("right of", True),
    "isInFrontOf": ("in front of", True),
    "isBehind": ("behind", True),
    "isBetween": ("between", False),
    "isVisibleFrom": ("visible from", False),
}
"""What each is called, and whether its distance says something."""
_IMPLIED: Final[dict[RelationName, frozenset[RelationName]]] = {
    "isOn": frozenset(("isNear", "isNextTo", "touches", "isAbove", "isUnder")),
    "isInside": frozenset(("isNear", "isNextTo", "touches", "isUnder", "isAbove")),
    "isAttachedTo": frozenset(("isNear", "isNextTo", "touches")),
    "isNextTo": frozenset(("isNear",)),
}
"""What needs no saying beside the other."""


class RelationLine(Struct, frozen=True):
    """A line between the middles of two things, with what is written on it."""

    a: Vector
    b: Vector
    text: str


def relation_lines(
    of: str, relations: Iterable[Relation], middles: Mapping[str, Vector]
) -> list[RelationLine]:
    """One line for each other thing that `of` is related to, the nearest first.

    `middles` has what can be drawn [m].
    Places, which are not among them, are left out.
    """
    by_other: dict[str, list[Relation]] = {}
    for relation in relations:
        if relation.holds:
            for other in {relation.subject, relation.object, relation.and_object or ""} - {of, ""}:
                by_other.setdefault(other, []).append(relation)
    return [
        RelationLine(middles[of], middles[other], _text(of, found))
        for other, found in sorted(by_other.items(), key=lambda each: min(r.gap_m for r in each[1]))
        if other in middles and of in middles
    ]


def _text(of: str, relations: list[Relation]) -> str:
    kinds = {relation.relation for relation in relations}
    implied = frozenset().union(*(_IMPLIED.get(kind, frozenset()) for kind in kinds))
    said = [_words(of, relation) for relation in relations if relation.relation not in implied]
    return ", ".join(dict.fromkeys(said))


def _words(of: str, relation: Relation) -> str:
    words, is_measured = _WORDS[relation.relation]
    who = "" if relation.subject == of else f"{relation.subject} "
    measure = f" {_distance(relation.gap_m)}" if is_measured else ""
    return f"{who}{words}{measure}"


def _distance(metres: float) -> str:
    return f"{metres:.2f} m" if metres >= 1.0 else f"{100.0 * metres:.0f} cm"
