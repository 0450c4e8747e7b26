"""The table of spatial relations, from which the other lists of this node are derived."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, Literal, NamedTuple

from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring import measures
from semmap.nodes.kb_node.relations.measuring.arrangement import measure_next_to
from semmap.nodes.kb_node.relations.measuring.measures import Measure
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.schemas.relations import RelationName

PairMeasure = Callable[[Space, Solid, Solid], Measure | None]


class RelationRow(NamedTuple):
    """How a relation is named, and where its facts come from."""

    name: RelationName
    phrase: str
    """As in "cup1 is on table1"."""
    kind: Literal["stored", "on demand", "side", "on request"]
    """Stored facts have a rule in `facts/rules.py`, and facts on demand a measure. A side needs a viewer."""
    inverse: RelationName | None = None
    """The relation with exchanged arguments, if it is in this table. A symmetric one is its own inverse."""
    measure: PairMeasure | None = None
    """Measures a pair, for facts on demand."""
    needs_sizes: bool = False
    """Whether the sizes of both objects must be known."""


def _measure_touch(space: Space, one: Solid, other: Solid) -> Measure | None:
    return None if other.is_place else measures.touches(one, other, space.limits)


def _measure_under(space: Space, one: Solid, other: Solid) -> Measure | None:
    return measures.beneath(one, other, space.limits)


def _measure_above(space: Space, one: Solid, other: Solid) -> Measure | None:
    return measures.beneath(other, one, space.limits)


def _measure_near(space: Space, one: Solid, other: Solid) -> Measure | None:
    return measures.near(one, other, space.limits)


TABLE: Final[tuple[RelationRow, ...]] = (
    RelationRow("isOn", "is on", "stored", needs_sizes=True),
    RelationRow("isInside", "is inside", "stored", needs_sizes=True),
    RelationRow("isLocatedIn", "is in", "stored"),
    RelationRow("isAttachedTo", "is attached to", "stored", needs_sizes=True),
    RelationRow("touches", "touches", "on demand", "touches", _measure_touch, True),
    RelationRow("isUnder", "is under", "on demand", "isAbove", _measure_under, True),
    RelationRow("isAbove", "is above", "on demand", "isUnder", _measure_above, True),
    RelationRow("isNextTo", "is next to", "on demand", "isNextTo", measure_next_to, True),
    RelationRow("isNear", "is near", "on demand", "isNear", _measure_near, True),
    RelationRow("isLeftOf", "is left of", "side"),
    RelationRow("isRightOf", "is right of", "side"),
    RelationRow("isInFrontOf", "is in front of", "side"),
    RelationRow("isBehind", "is behind", "side"),
    RelationRow("isBetween", "is between", "on request"),
    RelationRow("isVisibleFrom", "is visible from", "on request"),
)
"""The relations of a pair are reported in this order."""

PHRASES: Final[dict[RelationName, str]] = {row.name: row.phrase for row in TABLE}
SIDES: Final[tuple[RelationName, ...]] = tuple(row.name for row in TABLE if row.kind == "side")
"""The relations that name a side of another object."""
NEEDS_SIZES: Final[frozenset[RelationName]] = frozenset(row.name for row in TABLE if row.needs_sizes)
"""The relations that require known sizes."""
PAIR_MEASURES: Final[dict[RelationName, PairMeasure]] = {
    row.name: row.measure for row in TABLE if row.measure is not None
}
"""The relations measured on demand."""
MIRRORED: Final[dict[RelationName, RelationName]] = {
    row.name: row.inverse for row in TABLE if row.measure is not None and row.inverse is not None
}
"""The relations measured on demand, each with its inverse."""
