"""Relations in words: the sentence with the measurement behind it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from itertools import combinations, islice

from msgspec import structs

from semmap.nodes.kb_node.relations.facts.beside import beside, is_apart
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring import measures
from semmap.nodes.kb_node.relations.measuring.arrangement import attached, attachments, between
from semmap.nodes.kb_node.relations.measuring.measures import Measure
from semmap.nodes.kb_node.relations.measuring.phrases import SIDES, metres, spoken, why
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.viewing import View, own_sides, seen, sides
from semmap.nodes.kb_node.relations.reasons import why_not
from semmap.nodes.kb_node.relations.support import bearers, borne, on_nothing
from semmap.schemas import errors
from semmap.schemas.commands import Relations
from semmap.schemas.relations import Relation, RelationName

_ABOUT_BETWEEN = 8
"""So many neighbours are looked at for what a thing is between."""
_MOST_BETWEEN = 2
"""So many pairs, the closest, are told of all that a thing is between."""
_MOST_SIDES = 4
"""Of so many neighbours, the nearest, it is told on which side of them a thing is."""


def relations(space: Space, query: Relations, *, is_fixed: bool = False) -> Iterator[Relation]:
    """What is asked for. Nothing need bear what is fixed, so of that it is not told that nothing does.

    Raises UnknownName, Refused for what has no position, BadRequest for what is to be seen from itself.
    """
    for name in filter(None, (query.other, query.viewer)):
        if name not in space.solids:
            raise errors.UnknownName(
                f"nothing named '{name}' has a position{errors.did_you_mean(name, space.solids)}"
            )
    if query.other is not None:
        yield from relations_between(space, query.name, query.other)
    else:
        yield from relations_of(space, query.name, is_fixed=is_fixed)
    if query.viewer == query.name:
        raise errors.BadRequest(
            f"{query.name} cannot be seen from itself; the viewer (--from) must be another entity"
        )
    viewer = None if query.viewer is None else space.solids[query.viewer]
    if viewer is not None or query.viewpoint is not None:
        view = View.of(viewer) if viewer is not None else View.at(*query.viewpoint or (0.0, 0.0, 0.0, 0.0))
        found = list(as_seen(space, query.name, view, viewer))
        told = {query.other} if query.other is not None else _nearest(space, query.name, found, query.viewer)
        for relation in found:
            if relation.object in told or relation.relation == "isVisibleFrom":
                yield relation


def relations_of(space: Space, name: str, *, is_fixed: bool = False) -> Iterator[Relation]:
    """What a thing is in and on, hangs on, bears, touches, is under, above, next to, near to and between.

    What it bears is told as that of the other one: `isOn` or `isInside`, of which it is the object.
    """
    solid = _solid(space, name)
    yield from (found := list(whereabouts(space, name)))
    if solid.is_place:
        return
    if not is_fixed and (hovering := on_nothing(space, solid)) is not None:
        yield hovering
    above = set[str]()
    for relation, upper, (_, measure) in borne(space, solid):
        above.add(upper.name)
        yield _told(space, relation, upper, solid, measure)
    told = {relation.object for relation in found}
    beside = [o for o in space.counted_around(solid, space.limits.near_most_m) if not o.is_place]
    beside = sorted(beside, key=lambda other: (measures.gap(solid, other), other.name))
    for other in beside:
        if other.name not in told:
            holding = (relation for relation in _beside(space, solid, other) if relation.holds)
            is_borne = other.name in above
            yield from _special(r for r in holding if not (is_borne and r.relation == "touches"))
    near = [other for other in beside if other.name not in told and not other.is_place][:_ABOUT_BETWEEN]
    pairs = sorted(combinations(near, 2), key=lambda pair: measures.gap(*pair))
    amid = (pair for pair in pairs if solid in between(space, *pair))
    yield from (_between(solid, *pair) for pair in islice(amid, _MOST_BETWEEN))


def _nearest(space: Space, name: str, sides: Iterable[Relation], viewer: str | None) -> set[str]:
    """The viewer, and those next of which it is told on which side of them a thing is."""
    others = {side.object for side in sides if side.object in space.solids and side.object != viewer}
    solid = space.solids[name]
    near = sorted(others, key=lambda other: (measures.gap(solid, space.solids[other]), other))
    return {*near[:_MOST_SIDES], *filter(None, (viewer,))}


def _special(relations: Iterable[Relation]) -> Iterator[Relation]:
    """Without near where they are next to one another."""
    found = tuple(relations)
    is_next = any(relation.relation == "isNextTo" for relation in found)
    return (relation for relation in found if not (is_next and relation.relation == "isNear"))


def _between(solid: Solid, one: Solid, other: Solid) -> Relation:
    first, second = sorted((one.name, other.name))
    apart = measures.gap(one, other)
    return Relation(
        relation="isBetween",
        subject=solid.name,
        object=first,
        and_object=second,
        gap_m=round(apart, 4),
        text=f"{solid.name} is between {first} and {second}: it is on the strip that joins them, which are"
        f" {metres(apart)} apart",
    )


def whereabouts(space: Space, name: str) -> Iterator[Relation]:
    """What a thing is inside, on, attached to and in; nothing for one without a position."""
    if (solid := space.solids.get(name)) is None:
        return
    container, supports, place = space.whereabouts(solid)
    if container is not None:
        yield _told(space, "isInside", solid, *container)
    for support in supports:
        yield _told(space, "isOn", solid, *support)
    for other in () if solid.is_place else attachments(space, solid):
        if (made := attached(space, solid, other)) is not None:
            yield _told(space, "isAttachedTo", solid, other, made)
    if place is not None:
        yield _told(space, "isLocatedIn", solid, *place)


def relations_between(space: Space, name: str, other_name: str) -> Iterator[Relation]:
    """All that can be measured of a pair, also what does not hold."""
    solid, other = _solid(space, name), _solid(space, other_name)
    if solid is other:
        raise errors.BadRequest(f"{name} is in no relation to itself; name two different things")
    wanted: tuple[RelationName, ...] = ("isLocatedIn",) if other.is_place else ("isOn", "isInside")
    found = [
        _told(space, relation, solid, other, measure)
        for relation in wanted
        if (measure := measured(space, relation, solid, other)) is not None
    ]
    if not other.is_place and not any(relation.relation == "isOn" for relation in found):
        found.insert(0, _denied(space, "isOn", solid, other))
    found += _beside(space, solid, other)
    if not other.is_place and not any(relation.relation == "touches" for relation in found):
        found += filter(None, (_touches_by_the_way(space, solid, other),))
    yield from found
    if not (solid.is_place or other.is_place):
        yield from (_between(third, solid, other) for third in between(space, solid, other))


def _touches_by_the_way(space: Space, solid: Solid, other: Solid) -> Relation | None:
    """What is on a thing or attached to it touches it, within what a pose is worth; else None."""
    for one, two in ((solid, other), (other, solid)):
        borne: tuple[tuple[RelationName, Measure | None], ...] = (
            ("isOn", measured(space, "isOn", one, two)),
            ("isAttachedTo", attached(space, one, two)),
        )
        for relation, made in borne:
            if made is not None and made.holds:
                told = _told(space, relation, one, two, made)
                text = f"{solid.name} touches {other.name}, because {told.text}"
                return structs.replace(
                    told, relation="touches", subject=solid.name, object=other.name, share=1.0, text=text
                )
    return None


def _denied(space: Space, relation: RelationName, solid: Solid, other: Solid) -> Relation:
    return Relation(
        relation=relation,
        subject=solid.name,
        object=other.name,
        holds=False,
        gap_m=round(measures.gap(solid, other), 4),
        share=0.0,
        text=f"{solid.name} {spoken(relation, False)} {other.name}: {why_not(space, relation, solid, other)}",
    )


def explained(space: Space, name: str, relation: RelationName, other_name: str) -> Relation | None:
    """Whether a relation holds of two, and why or why not, as measured; None where one has no position.

    What depends on who looks is seen from the other one, by its own front.
    """
    solid, other = space.solids.get(name), space.solids.get(other_name)
    if solid is None or other is None:
        return None
    found: Iterable[Relation] = ()
    if solid is not other:
        depends_on_who_looks = relation in (*SIDES, "isVisibleFrom")
        found = (
            as_seen(space, name, View.of(other), other)
            if depends_on_who_looks
            else relations_between(space, name, other_name)
        )
    for told in found:
        if told.relation == relation and told.object == other_name:
            return told
    return _denied(space, relation, solid, other)


def measured(space: Space, relation: RelationName, solid: Solid, other: Solid) -> Measure | None:
    """The measurement behind one relation; None where nothing can be measured.

    Of what a thing could be on or inside only the nearest counts: the others are told as not holding.
    """
    limits = space.limits
    if relation == "isLocatedIn":
        return measures.within(solid, other, limits)
    if relation not in ("isOn", "isInside"):
        return None
    container, supports, _ = space.whereabouts(solid)
    found = supports if relation == "isOn" else (container,)
    for best in filter(None, found):
        if best[0] is other:
            return best[1]
    made = (
        measures.over(solid, other, limits) if relation == "isOn" else measures.inside(solid, other, limits)
    )
    return None if made is None else made._replace(holds=False)


def as_seen(space: Space, name: str, view: View, viewer: Solid | None) -> Iterator[Relation]:
    """Whether a thing can be seen by a viewer, and on which side of its neighbours and the viewer it is.

    Of what bears it, or is borne by it, nobody says that: a cup on a desk is not right of the desk.
    """
    solid = _solid(space, name)
    if solid.is_place:
        return
    below = bearers(space, solid)
    found = list(sides(space, solid, view))
    if viewer is not None:
        found = [*own_sides(solid, viewer), *(side for side in found if side.other is not viewer)]
    for relation, other, by_m in found:
        if other in below or solid in bearers(space, other):
            continue
        yield Relation(
            relation=relation,
            subject=name,
            object=other.name,
            gap_m=round(by_m, 4),
            text=f"{name} {spoken(relation)} {other.name}, by {metres(by_m)} from centre to centre",
        )
    share, blocker = seen(space, solid, view, viewer)
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


def _beside(space: Space, solid: Solid, other: Solid) -> Iterator[Relation]:
    if is_apart(space, solid, other) and (made := attached(space, solid, other)) is not None:
        yield _told(space, "isAttachedTo", solid, other, made)
    for relation, measure in beside(space, solid, other):
        yield _told(space, relation, solid, other, measure)


def _told(space: Space, relation: RelationName, solid: Solid, other: Solid, measure: Measure) -> Relation:
    reason = why(relation, solid, other, measure) if measure.holds else why_not(space, relation, solid, other)
    return Relation(
        relation=relation,
        subject=solid.name,
        object=other.name,
        holds=measure.holds,
        gap_m=round(measure.gap_m, 4) + 0.0,
        share=round(measure.share, 4),
        text=f"{solid.name} {spoken(relation, measure.holds)} {other.name}: {reason}",
    )


def _solid(space: Space, name: str) -> Solid:
    try:
        return space.solids[name]
    except KeyError:
        raise errors.Refused(f"{name} has no position, so it has no spatial relations") from None
