"""Asserted locations that contradict the geometry."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final

from semmap.nodes.geometry.polygons import distance
from semmap.nodes.kb_node.entities.alignments import shipped
from semmap.nodes.kb_node.relations.facts.place_facts import Fact
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring import overhead, places, proximity, support_contact
from semmap.nodes.kb_node.relations.measuring.phrases import explain_location, format_length
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.relations.support import find_supporters
from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term, Triple
from semmap.schemas.relations import PHRASES, Relation, RelationName

PROPERTIES: Final[dict[Term, tuple[RelationName, bool]]] = {
    v.dm("isOn"): ("isOn", False),
    v.dm("supports"): ("isOn", True),
    v.dm("isInside"): ("isInside", False),
    v.dm("holds"): ("isInside", True),
    v.dm("isLocatedIn"): ("isLocatedIn", False),
    v.dm("contains"): ("isLocatedIn", True),
    v.dm("isNear"): ("isNear", False),
    v.dm("isUnder"): ("isUnder", False),
    v.dm("isAbove"): ("isAbove", False),
    **{p: (name, False) for known in shipped() for name, p in known.relations.items()},
}
"""Properties that state a location, as relations, and whether subject and object are swapped.

They are those of the household TBox and of the vocabularies with an alignment.
"""


def fact_of(triple: Triple) -> Fact | None:
    """Return the location that a triple states, or None if it states something else."""
    s, p, o = triple
    if p not in PROPERTIES or o.startswith('"'):
        return None
    relation, is_inverse = PROPERTIES[p]
    subject, other = v.entity_name(s), v.entity_name(o)
    return (other, relation, subject) if is_inverse else (subject, relation, other)


def find_contradictions(space: Space, asserted: Iterable[Fact]) -> Iterator[Relation]:
    """Yield the distinct facts that geometry denies, with the reason."""
    for fact in dict.fromkeys(asserted):
        relation = find_contradiction(space, fact)
        if relation is not None:
            yield relation


def find_contradiction(space: Space, fact: Fact) -> Relation | None:
    """Return why geometry denies a fact, or None if it agrees or cannot decide.

    It cannot decide without a position or size, or on a flat map, except on nearness. It does not deny
    attachment to a wall, differences of a few centimetres, or supports in a crowd.
    """
    name, relation, other_name = fact
    solid, other = space.solids.get(name), space.solids.get(other_name)
    if name == other_name:
        reason: str | None = "an object cannot be on, in or inside itself"
    elif solid is None or other is None or not other.is_measured:
        return None
    else:
        reason = _find_reason(space, relation, solid, other)
    if reason is None:
        return None
    phrase = PHRASES[relation].replace("is ", "to be ", 1)
    return Relation(
        relation=relation,
        subject=name,
        object=other_name,
        holds=False,
        gap_m=0.0 if solid is None or other is None else round(proximity.gap(solid, other), 4),
        share=0.0,
        text=f"{name} was asserted {phrase} {other_name}; {reason}",
    )


def _find_reason(space: Space, relation: RelationName, solid: Solid, other: Solid) -> str | None:
    limits = space.limits
    if relation == "isLocatedIn":
        made = places.within(solid, other, limits)
        if made is None or made.holds:
            return None
        apart = proximity.gap(solid, other)
        return (
            explain_location(relation, solid, other, made)
            if apart < limits.touch_m
            else _describe_distance(solid, apart)
        )
    if other.is_place or solid.is_place or not solid.is_measured:
        return None
    if relation == "isNear":
        return _deny_nearness(solid, other, limits)
    if space.is_flat:
        return None
    if relation == "isUnder":
        return _deny_above(other, solid, limits)
    if relation == "isAbove":
        return _deny_above(solid, other, limits)
    if space.is_crowded(solid) and distance(solid.outline, other.outline) <= limits.gap_m:
        return None  # its support may not be among the compared objects
    if other in find_supporters(space, solid):
        return None
    apart = proximity.gap(solid, other)
    if apart > limits.gap_m:
        return _describe_distance(solid, apart)
    if relation == "isInside":
        share = _compute_share_within_box(solid, other, limits.gap_m)
        return f"{share:.0%} of its volume is within it" if share < limits.inside_share else None
    has_support = bool(space.spatial_relations(solid).supporters)
    if not other.supports or not (has_support or solid.bottom <= other.bottom + limits.gap_m):
        return None  # it may be attached or lean there
    made = support_contact.over(solid, other, limits)
    return (
        f"it is not above any surface of {other.name}"
        if made is None
        else explain_location(relation, solid, other, made)
    )


def _deny_nearness(solid: Solid, other: Solid, limits: Thresholds) -> str | None:
    made = proximity.near(solid, other, limits)
    if made is None or made.gap_m <= (made.limit) + limits.gap_m:
        return None
    limit = format_length(made.limit)
    return f"they are {format_length(made.gap_m)} apart (isNear allows up to {limit} for their sizes)"


def _deny_above(upper: Solid, lower: Solid, limits: Thresholds) -> str | None:
    """Return why no part of a solid, such as an open drawer, can be above the other one, or None."""
    if overhead.beneath(lower, upper, limits) is not None:
        return None
    if (apart := proximity.gap_from_above(upper, lower)) > limits.gap_m:
        return f"seen from above they are {format_length(apart)} apart"
    if upper.top <= lower.bottom + limits.touch_m:
        return f"{upper.name} is below {lower.name}"
    return None


def _compute_share_within_box(inner: Solid, outer: Solid, margin_m: float) -> float:
    """Return the share of a volume within the box of another solid, because its hollow may be unknown."""
    x, y, z = (extent / 2 + margin_m for extent in outer.size)
    points = [outer.to_own(point) for point in inner.samples]
    within = sum(abs(px) <= x and abs(py) <= y and abs(pz - z + margin_m) <= z for px, py, pz in points)
    return within / len(points)


def _describe_distance(solid: Solid, apart_m: float) -> str:
    return f"it {'stands' if solid.is_upright else 'lies'} {format_length(apart_m)} from it"
