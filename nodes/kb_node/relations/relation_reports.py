"""Relations of an object as sentences with the measured values."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from itertools import combinations, islice

from msgspec import structs

from semmap.nodes.kb_node.relations.facts.pair_facts import is_separate, measure_pair
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring import containment, places, proximity, support_contact
from semmap.nodes.kb_node.relations.measuring.arrangement import (
    find_attachments,
    find_between,
    measure_attachment,
)
from semmap.nodes.kb_node.relations.measuring.measures import Measure
from semmap.nodes.kb_node.relations.measuring.phrases import (
    explain_location,
    format_length,
    phrase_relation,
)
from semmap.nodes.kb_node.relations.measuring.relation_table import ONE_WAY, PAIR_RELATIONS
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.viewing import (
    View,
    list_intrinsic_sides,
    list_sides,
    measure_visibility,
)
from semmap.nodes.kb_node.relations.reasons import explain_absence
from semmap.nodes.kb_node.relations.support import describe_unsupported, find_contents, find_supporters
from semmap.schemas import errors
from semmap.schemas.commands import Relations
from semmap.schemas.relations import SIDES, Relation, RelationName

_NEIGHBOURS_BETWEEN = 8
"""The number of neighbours considered for `isBetween`."""
_MOST_BETWEEN = 2
"""The number of pairs reported for `isBetween`, closest first."""
_MOST_SIDES = 4
"""The number of neighbours, nearest first, for which sides are reported."""


def list_relations(space: Space, query: Relations, *, is_fixed: bool = False) -> Iterator[Relation]:
    """Yield the relations that a query asks for.

    A fixed object needs no support, so a missing one is not reported. Raises UnknownName. Raises Refused
    for an object without a position, and BadRequest if the viewer is the object itself.
    """
    for name in filter(None, (query.other, query.viewer)):
        if name not in space.solids:
            raise errors.UnknownName(
                f"nothing named '{name}' has a position{errors.did_you_mean(name, space.solids)}"
            )
    if query.other is not None:
        yield from list_relations_between(space, query.name, query.other)
    else:
        yield from list_relations_of(space, query.name, is_fixed=is_fixed)
    if query.viewer == query.name:
        raise errors.BadRequest(f"{query.name} cannot be its own viewer (--from); name another entity")
    viewer = None if query.viewer is None else space.solids[query.viewer]
    if viewer is not None or query.viewpoint is not None:
        view = View.of(viewer) if viewer is not None else View.at(*query.viewpoint or (0.0, 0.0, 0.0, 0.0))
        found = list(list_relations_from_view(space, query.name, view, viewer))
        reported = (
            {query.other}
            if query.other is not None
            else _select_nearest(space, query.name, found, query.viewer)
        )
        for relation in found:
            if relation.object in reported or relation.relation == "isVisibleFrom":
                yield relation


def list_relations_of(space: Space, name: str, *, is_fixed: bool = False) -> Iterator[Relation]:
    """Yield the relations of an object to its surroundings.

    What it supports or contains is reported from the other object: `isOn` or `isInside` with this one as
    the object.
    """
    solid = _require_solid(space, name)
    yield from (found := list(list_locations(space, name)))
    if solid.is_place:
        return
    if not is_fixed and (floating := describe_unsupported(space, solid)) is not None:
        yield floating
    above = set[str]()
    for relation, upper, (_, measure) in find_contents(space, solid):
        above.add(upper.name)
        yield _make_relation(space, relation, upper, solid, measure)
    known = {relation.object for relation in found}
    nearby = [o for o in space.counted_around(solid, space.limits.near_most_m) if not o.is_place]
    nearby = sorted(nearby, key=lambda other: (proximity.gap(solid, other), other.name))
    for other in nearby:
        if other.name not in known:
            holding = (relation for relation in _list_pair_relations(space, solid, other) if relation.holds)
            is_content = other.name in above
            yield from _drop_implied_near(r for r in holding if not (is_content and r.relation == "touches"))
    near = [other for other in nearby if other.name not in known and not other.is_place][:_NEIGHBOURS_BETWEEN]
    pairs = sorted(combinations(near, 2), key=lambda pair: proximity.gap(*pair))
    amid = (pair for pair in pairs if solid in find_between(space, *pair))
    yield from (_make_between(solid, *pair) for pair in islice(amid, _MOST_BETWEEN))


def _select_nearest(space: Space, name: str, sides: Iterable[Relation], viewer: str | None) -> set[str]:
    """Return the viewer and the nearest neighbours, for which sides are reported."""
    others = {side.object for side in sides if side.object in space.solids and side.object != viewer}
    solid = space.solids[name]
    near = sorted(others, key=lambda other: (proximity.gap(solid, space.solids[other]), other))
    return {*near[:_MOST_SIDES], *filter(None, (viewer,))}


def _drop_implied_near(relations: Iterable[Relation]) -> Iterator[Relation]:
    """Drop `isNear` between objects that are next to each other."""
    found = tuple(relations)
    is_next = any(relation.relation == "isNextTo" for relation in found)
    return (relation for relation in found if not (is_next and relation.relation == "isNear"))


def _make_between(solid: Solid, one: Solid, other: Solid) -> Relation:
    first, second = sorted((one.name, other.name))
    apart = proximity.gap(one, other)
    return Relation(
        relation="isBetween",
        subject=solid.name,
        object=first,
        and_object=second,
        gap_m=round(apart, 4),
        text=f"{solid.name} is between {first} and {second}: it is on the strip that joins them; they are"
        f" {format_length(apart)} apart",
    )


def list_locations(space: Space, name: str) -> Iterator[Relation]:
    """Yield what an object is inside, on, attached to and located in; nothing without a position."""
    if (solid := space.solids.get(name)) is None:
        return
    container, supports, place = space.spatial_relations(solid)
    if container is not None:
        yield _make_relation(space, "isInside", solid, *container)
    for support in supports:
        yield _make_relation(space, "isOn", solid, *support)
    for other in () if solid.is_place else find_attachments(space, solid):
        if (made := measure_attachment(space, solid, other)) is not None:
            yield _make_relation(space, "isAttachedTo", solid, other, made)
    if place is not None:
        yield _make_relation(space, "isLocatedIn", solid, *place)


def list_relations_between(space: Space, name: str, other_name: str) -> Iterator[Relation]:
    """Yield all relations that can be measured between two objects, also negative ones."""
    solid, other = _require_solid(space, name), _require_solid(space, other_name)
    if solid is other:
        raise errors.BadRequest(f"{name} has no relation to itself; name two different objects")
    wanted: tuple[RelationName, ...] = ("isLocatedIn",) if other.is_place else ("isOn", "isInside")
    found = [
        _make_relation(space, relation, solid, other, measure)
        for relation in wanted
        if (measure := measure_relation(space, relation, solid, other)) is not None
    ]
    if not other.is_place and not any(relation.relation == "isOn" for relation in found):
        found.insert(0, _make_negative(space, "isOn", solid, other))
    found += _list_pair_relations(space, solid, other)
    if not other.is_place and not any(relation.relation == "touches" for relation in found):
        found += filter(None, (_find_implied_touch(space, solid, other),))
    yield from found
    if not (solid.is_place or other.is_place):
        yield from (_make_between(third, solid, other) for third in find_between(space, solid, other))


def _find_implied_touch(space: Space, solid: Solid, other: Solid) -> Relation | None:
    """Return `touches` for an object that is on or attached to the other within the tolerance, or None."""
    for one, two in ((solid, other), (other, solid)):
        implying: tuple[tuple[RelationName, Measure | None], ...] = (
            ("isOn", measure_relation(space, "isOn", one, two)),
            ("isAttachedTo", measure_attachment(space, one, two)),
        )
        for relation, made in implying:
            if made is not None and made.holds:
                implied = _make_relation(space, relation, one, two, made)
                text = f"{solid.name} touches {other.name}, because {implied.text}"
                return structs.replace(
                    implied, relation="touches", subject=solid.name, object=other.name, share=1.0, text=text
                )
    return None


def _make_negative(space: Space, relation: RelationName, solid: Solid, other: Solid) -> Relation:
    return Relation(
        relation=relation,
        subject=solid.name,
        object=other.name,
        holds=False,
        gap_m=round(proximity.gap(solid, other), 4),
        share=0.0,
        text=f"{solid.name} {phrase_relation(relation, False)} {other.name}:"
        f" {explain_absence(space, relation, solid, other)}",
    )


def explain_relation(space: Space, name: str, relation: RelationName, other_name: str) -> Relation | None:
    """Return whether a relation holds and why, as measured, or None if a position is unknown.

    View-dependent relations are evaluated from `other`, facing along its own front.
    """
    solid, other = space.solids.get(name), space.solids.get(other_name)
    if solid is None or other is None:
        return None
    found: Iterable[Relation] = ()
    if solid is not other:
        is_view_dependent = relation in (*SIDES, "isVisibleFrom")
        found = (
            list_relations_from_view(space, name, View.of(other), other)
            if is_view_dependent
            else list_relations_between(space, name, other_name)
        )
    for relation_found in found:
        if relation_found.relation == relation and relation_found.object == other_name:
            return relation_found
    return _make_negative(space, relation, solid, other)


def measure_relation(space: Space, relation: RelationName, solid: Solid, other: Solid) -> Measure | None:
    """Return the measurement behind a relation, or None if it cannot be measured.

    Only the nearest support and the smallest container count. For others the relation does not hold.
    """
    limits = space.limits
    if relation == "isLocatedIn":
        return places.within(solid, other, limits)
    if relation not in ("isOn", "isInside"):
        return None
    container, supports, _ = space.spatial_relations(solid)
    found = supports if relation == "isOn" else (container,)
    for best in filter(None, found):
        if best[0] is other:
            return best[1]
    made = (
        support_contact.over(solid, other, limits)
        if relation == "isOn"
        else containment.inside(solid, other, limits)
    )
    return None if made is None else made._replace(holds=False)


def list_relations_from_view(space: Space, name: str, view: View, viewer: Solid | None) -> Iterator[Relation]:
    """Yield whether an object is visible, and its sides relative to neighbours and the viewer.

    Side relations to its supports and contents are left out: a cup on a desk is not right of the desk.
    """
    solid = _require_solid(space, name)
    if solid.is_place:
        return
    below = find_supporters(space, solid)
    found = list(list_sides(space, solid, view))
    if viewer is not None:
        found = [*list_intrinsic_sides(solid, viewer), *(side for side in found if side.other is not viewer)]
    for relation, other, by_m in found:
        if other in below or solid in find_supporters(space, other):
            continue
        yield Relation(
            relation=relation,
            subject=name,
            object=other.name,
            gap_m=round(by_m, 4),
            text=f"{name} {phrase_relation(relation)} {other.name},"
            f" by {format_length(by_m)} from centre to centre",
        )
    share, blocker = measure_visibility(space, solid, view, viewer)
    reason = f"{share:.0%} of the lines of sight reach it" + (f"; {blocker} is in the way" if blocker else "")
    there = viewer.name if viewer is not None else "there"
    yield Relation(
        relation="isVisibleFrom",
        subject=name,
        object=viewer.name if viewer is not None else "",
        holds=share > 0.0,
        gap_m=round(math.dist(view.eyes, solid.centre), 4),
        share=round(share, 4),
        text=f"{name} {'is' if share > 0.0 else 'is not'} visible from {there}: {reason}",
    )


def _list_pair_relations(space: Space, solid: Solid, other: Solid) -> Iterator[Relation]:
    if is_separate(space, solid, other) and (made := measure_attachment(space, solid, other)) is not None:
        yield _make_relation(space, "isAttachedTo", solid, other, made)
    for relation, measure in measure_pair(space, solid, other):
        yield _make_relation(space, relation, solid, other, measure)
    for relation, measure in measure_pair(space, other, solid, ONE_WAY):
        if measure.holds:
            yield _make_relation(space, relation, other, solid, measure)


def _make_relation(
    space: Space, relation: RelationName, solid: Solid, other: Solid, measure: Measure
) -> Relation:
    if not measure.holds:
        reason = explain_absence(space, relation, solid, other)
    elif relation in PAIR_RELATIONS:
        reason = PAIR_RELATIONS[relation].explain(space, solid, other, measure)
    else:
        reason = explain_location(relation, solid, other, measure)
    return Relation(
        relation=relation,
        subject=solid.name,
        object=other.name,
        holds=measure.holds,
        gap_m=round(measure.gap_m, 4) + 0.0,
        share=round(measure.share, 4),
        text=f"{solid.name} {phrase_relation(relation, measure.holds)} {other.name}: {reason}",
    )


def _require_solid(space: Space, name: str) -> Solid:
    try:
        return space.solids[name]
    except KeyError:
        raise errors.Refused(
            f"{name} has no position, so its relations are unknown; set one: semmap update {name} --at X Y Z"
        ) from None
