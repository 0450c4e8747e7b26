"""Explanations of why a relation between two objects does not hold, with the measured values and limits."""

from __future__ import annotations

from semmap.nodes.kb_node.relations.facts.pair_facts import is_separate
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring import containment, places, proximity, support_contact
from semmap.nodes.kb_node.relations.measuring.arrangement import find_attachments, measure_attachment
from semmap.nodes.kb_node.relations.measuring.phrases import (
    UNSUPPORTED,
    describe_support,
    explain_location,
    format_height,
    format_length,
    phrase_relation,
)
from semmap.nodes.kb_node.relations.measuring.relation_table import PAIR_RELATIONS
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.viewing import list_intrinsic_sides
from semmap.schemas.relations import FACTS, SIDES, RelationName


def explain_absence(space: Space, relation: RelationName, solid: Solid, other: Solid) -> str:
    """Return why a relation that does not hold does not, as a clause."""
    if solid is other:
        return "an object has no relation to itself"
    if relation == "isLocatedIn":
        return _explain_not_in(space, solid, other)
    if relation == "isBetween":
        return "isBetween needs two other objects; semmap relations NAME lists what an object is between"
    if relation in SIDES:
        if support := _describe_direct_support(space, solid, other) or _explain_indirect_support(
            space, solid, other
        ):
            return f"{support}; side relations are not defined between an object and its support"
        found = [
            phrase_relation(side.relation).removeprefix("is ") for side in list_intrinsic_sides(solid, other)
        ]
        where = f"it is {' and '.join(found)} it" if found else "their centres are too close to each other"
        return f"relative to the front of {other.name}, {where}"
    for one in (solid, other):
        if one.is_place:
            return f"{one.name} is a place, and this relation holds between objects only"
    for one in (solid, other):
        if relation in FACTS and not one.is_measured:
            return f"the size of {one.name} is unknown"
    match relation:
        case "isOn":
            return _explain_not_on(space, solid, other)
        case "isInside":
            return _explain_not_inside(space, solid, other)
        case "isAttachedTo":
            return _explain_not_attached(space, solid, other)
    rests = None if relation == "touches" else _describe_direct_support(space, solid, other)
    if rests is not None and (relation not in ("isAbove", "isUnder") or not is_separate(space, solid, other)):
        return rests
    pair = PAIR_RELATIONS[relation]
    return pair.explain(space, solid, other, pair.measure(space, solid, other))


def _describe_direct_support(space: Space, solid: Solid, other: Solid) -> str | None:
    """Return the clause that one of two objects is on or inside the other, or None."""
    for upper, lower, subject, object_ in (
        (solid, other, "it", other.name),
        (other, solid, other.name, "it"),
    ):
        if lower in space.spatial_relations(upper).supporters:
            return f"{subject} is {_choose_preposition(space, upper, lower)} {object_}"
    return None


def _explain_not_on(space: Space, solid: Solid, other: Solid) -> str:
    if (by := _explain_indirect_support(space, solid, other)) is not None:
        return by
    limits = space.limits
    if not other.supports:
        return f"{other.name} has no supporting surface; it {_describe_hold(space, solid)}"
    made = support_contact.over(solid, other, limits)
    if made is None:
        apart = proximity.gap(solid, other)
        where = f"{format_length(apart)} apart" if apart > 0.0 else "touching or overlapping"
        support = _describe_hold(space, solid)
        return f"it is not above any surface of {other.name} (they are {where}); it {support}"
    where = f"its bottom is {format_height(made.gap_m)} the nearest surface of {other.name}"
    if abs(made.gap_m) > limits.gap_m:
        return f"{where}, at {format_length(made.height_m)} (isOn allows up to {format_length(limits.gap_m)})"
    if made.share < limits.base_share:
        return f"{where}, but only {made.share:.0%} of its base is over it; it {_describe_hold(space, solid)}"
    return f"{where}, but {_explain_crowd(space, solid, other) or f'it {_describe_hold(space, solid)}'}"


def _describe_hold(space: Space, solid: Solid) -> str:
    """Return what an object is inside, on or attached to, as a predicate."""
    if attached := [other.name for other in find_attachments(space, solid)]:
        return f"is attached to {' and '.join(attached)}"
    return describe_support(space, solid)


def _explain_crowd(space: Space, solid: Solid, other: Solid) -> str | None:
    """Return the clause that `other` was not considered as a support because of a crowd, or None."""
    if not space.is_crowded(solid) or other in space.supporters_around(solid):
        return None
    return f"too many objects are here to compare all of them, and {other.name} is not among the largest"


def _explain_indirect_support(space: Space, solid: Solid, other: Solid) -> str | None:
    """Return the clause that `other` supports or contains the solid, directly or not, or None."""
    container, first = space.spatial_relations(solid).container, space.spatial_relations(solid).supporters
    if container is not None and container[0] is other:
        return f"it is inside {other.name}, and an object inside another is not also on it"
    seen = {solid, *first}
    for support in first:
        chain, waiting = [support], [support]
        while waiting:
            upper = waiting.pop()
            below = space.spatial_relations(upper).supporters
            if other in below:
                chain = [support] if upper is support else [support, upper]
                return f"it {_format_chain(space, solid, chain, other)}"
            waiting += [lower for lower in below if lower not in seen]
            seen.update(below)
    return None


def _format_chain(space: Space, solid: Solid, chain: list[Solid], other: Solid) -> str:
    first, last = chain[0], chain[-1]
    text = f"is {_choose_preposition(space, solid, first)} {first.name}, which"
    if last is not first:
        text += f" is supported by {last.name}, which"
    return f"{text} is {_choose_preposition(space, last, other)} {other.name}"


def _choose_preposition(space: Space, solid: Solid, support: Solid) -> str:
    container = space.spatial_relations(solid).container
    return "inside" if container is not None and container[0] is support else "on"


def _explain_not_inside(space: Space, solid: Solid, other: Solid) -> str:
    if not other.hollows:
        return f"{other.name} has no known hollow"
    if solid.volume >= other.volume:
        return f"it is not smaller than {other.name}"
    made = containment.inside(solid, other, space.limits)
    if made is None or made.share == 0.0:
        apart = proximity.gap(solid, other)
        if apart == 0.0 and all(hollow.is_sealed for hollow in other.hollows):
            return f"not all of it is within the hollow of {other.name}, which is closed"
        return f"none of its volume is within a hollow of {other.name}; they are {format_length(apart)} apart"
    if made.share < made.limit:
        least = f"isInside requires at least {space.limits.inside_share:.0%}"
        return f"{explain_location('isInside', solid, other, made)} ({least})"
    if not made.holds:
        return f"it is too large for the hollow of {other.name}"
    return (
        _explain_crowd(space, solid, other)
        or f"it {describe_support(space, solid)}, which is the smaller hollow"
    )


def _explain_not_in(space: Space, solid: Solid, other: Solid) -> str:
    if not other.is_place:
        return f"{other.name} is not a place"
    if solid.is_place:
        return "it is a place itself, and relations between places are only asserted, never computed"
    if not other.is_measured:
        return f"the extent of {other.name} is unknown"
    made = places.within(solid, other, space.limits)
    apart = proximity.gap(solid, other)
    if made is None or apart > space.limits.touch_m:
        return f"it is {format_length(apart)} from it"
    if made.share == 0.0:
        return f"none of its footprint is within {other.name}"
    if not made.holds:
        least = f"isLocatedIn requires at least {made.limit:.0%}"
        return f"{explain_location('isLocatedIn', solid, other, made)} ({least})"
    return explain_location("isLocatedIn", solid, other, made)


def _explain_not_attached(space: Space, solid: Solid, other: Solid) -> str:
    support = describe_support(space, solid)
    if support != UNSUPPORTED:
        return f"it {support}, so it is not attached to a side"
    made = measure_attachment(space, solid, other)
    if made is None:
        apart = format_length(proximity.gap(solid, other))
        return f"it is not against a side of {other.name}; they are {apart} apart"
    limit = f"isAttachedTo allows up to {format_length(space.limits.attached_m)}"
    if made.gap_m > made.limit:
        return f"it is {format_length(made.gap_m)} from the side of {other.name} ({limit})"
    return f"only {made.share:.0%} of its height is against {other.name}"
