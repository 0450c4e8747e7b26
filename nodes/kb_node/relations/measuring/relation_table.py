"""The relations that are measured on demand: how each is measured and explained.

`semmap.schemas.relations.RELATIONS` has the names, inverses and words of all relations.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, NamedTuple

from semmap.nodes.geometry.polygons import distance
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring import overhead, proximity
from semmap.nodes.kb_node.relations.measuring.arrangement import find_between, measure_next_to
from semmap.nodes.kb_node.relations.measuring.leaning import explain_leaning, measure_leaning
from semmap.nodes.kb_node.relations.measuring.measures import Measure
from semmap.nodes.kb_node.relations.measuring.phrases import LEVEL_M, describe_support, format_length
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.schemas.relations import RELATIONS, RelationName


class PairRelation(NamedTuple):
    """The functions of a relation of two objects."""

    measure: Callable[[Space, Solid, Solid], Measure | None]
    """Return whether the first object has the relation to the second, or None if it has not."""
    explain: Callable[[Space, Solid, Solid, Measure | None], str]
    """Return why the relation holds or does not hold, as a clause with the measured values."""


def _measure_touch(space: Space, one: Solid, other: Solid) -> Measure | None:
    return None if other.is_place else proximity.touches(one, other, space.limits)


def _explain_touch(space: Space, one: Solid, other: Solid, made: Measure | None) -> str:
    if made is not None and made.holds:
        return f"they are {format_length(made.gap_m)} apart" if made.gap_m > LEVEL_M else "they meet"
    apart, limit = proximity.gap(one, other), format_length(space.limits.contact_m)
    if apart > space.limits.contact_m:
        return f"they are {format_length(apart)} apart (touches allows up to {limit})"
    return f"no part of one is within {limit} of a part of the other, although their boxes are"


def _measure_under(space: Space, one: Solid, other: Solid) -> Measure | None:
    return overhead.beneath(one, other, space.limits)


def _explain_under(space: Space, one: Solid, other: Solid, made: Measure | None) -> str:
    if made is None or not made.holds:
        return _explain_not_beneath(space, one, other, made)
    # the share is that of the smaller footprint
    is_smaller = one.footprint < other.footprint
    over = f"which is over {made.share:.0%} of it" if is_smaller else f"{made.share:.0%} of which is over it"
    part = f"{other.name}, {over}"
    if abs(made.gap_m) <= LEVEL_M:
        return f"its top is level with the underside of {part}"
    if made.gap_m < 0.0:
        return f"its top is {format_length(-made.gap_m)} above the underside of {part}; they overlap"
    return f"its top is {format_length(made.gap_m)} below {part}"


def _measure_above(space: Space, one: Solid, other: Solid) -> Measure | None:
    return overhead.beneath(other, one, space.limits)


def _explain_above(space: Space, one: Solid, other: Solid, made: Measure | None) -> str:
    if made is None or not made.holds:
        return _explain_not_beneath(space, other, one, made)
    is_smaller = other.footprint < one.footprint
    under = (
        f"{made.share:.0%} of which is under it" if is_smaller else f"which is under {made.share:.0%} of it"
    )
    part = f"{other.name}, {under}"
    if abs(made.gap_m) <= LEVEL_M:
        return f"its underside is level with the top of {part}"
    if made.gap_m < 0.0:
        return f"its underside is {format_length(-made.gap_m)} below the top of {part}; they overlap"
    return f"its underside is {format_length(made.gap_m)} above {part}"


def _explain_not_beneath(space: Space, lower: Solid, upper: Solid, made: Measure | None) -> str:
    if made is not None:
        return (
            f"{upper.name} is over only {made.share:.0%} of the smaller footprint of the two"
            f" (isUnder requires at least {space.limits.beneath_share:.0%})"
        )
    apart = distance(lower.outline, upper.outline)
    if apart > 0.0:
        return f"seen from above, they are {format_length(apart)} apart"
    if upper.top > lower.top:  # such as a chair, whose backrest is beside the table
        return (
            f"where their footprints overlap, each part of {upper.name} starts below the top of {lower.name}"
        )
    return f"no part of {upper.name} is above the top of {lower.name}, at {format_length(lower.top)}"


def _measure_near(space: Space, one: Solid, other: Solid) -> Measure | None:
    return proximity.near(one, other, space.limits)


def _explain_near(_: Space, one: Solid, other: Solid, made: Measure | None) -> str:
    if made is None:
        return "they are apart"
    limit = format_length(made.limit)
    return f"they are {format_length(made.gap_m)} apart (isNear allows up to {limit} for their sizes)"


def _explain_next_to(space: Space, one: Solid, other: Solid, made: Measure | None) -> str:
    if made is None:
        return _explain_near(space, one, other, _measure_near(space, one, other))
    apart = f"they are {format_length(made.gap_m)} apart"
    if made.holds:
        return f"{apart} on the same support, with nothing between them"
    if made.share == 0.0:
        ours, theirs = describe_support(space, one), describe_support(space, other)
        if ours == theirs:
            return f"{apart}, but neither has a known support"
        return f"{apart}, but {one.name} {ours} and {other.name} {theirs}"
    names = [third.name for third in find_between(space, one, other)]
    return f"{apart}, but between them {'is' if len(names) == 1 else 'are'} {' and '.join(names)}"


PAIR_RELATIONS: Final[dict[RelationName, PairRelation]] = {
    "touches": PairRelation(_measure_touch, _explain_touch),
    "isLeaningAgainst": PairRelation(measure_leaning, explain_leaning),
    "isUnder": PairRelation(_measure_under, _explain_under),
    "isAbove": PairRelation(_measure_above, _explain_above),
    "isNextTo": PairRelation(measure_next_to, _explain_next_to),
    "isNear": PairRelation(_measure_near, _explain_near),
}
"""The relations measured on demand, in the order in which those of a pair are reported."""
MIRRORED: Final[dict[RelationName, RelationName]] = {
    row.name: row.inverse for row in RELATIONS if row.name in PAIR_RELATIONS and row.inverse is not None
}
"""The relations of them that have an inverse, or are their own."""
ONE_WAY: Final[frozenset[RelationName]] = frozenset(PAIR_RELATIONS) - MIRRORED.keys()
"""The relations of them without an inverse: both directions of a pair are measured."""
