"""Relations in words: the sentence with the measurement behind it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from itertools import combinations

from msgspec import structs

from nodes.kb_node.relations import measures
from nodes.kb_node.relations.arrangement import attached, between
from nodes.kb_node.relations.beside import beside, is_apart
from nodes.kb_node.relations.measures import Measure
from nodes.kb_node.relations.solids import Solid
from nodes.kb_node.relations.space import Space
from nodes.kb_node.relations.viewing import View, own_sides, seen, sides
from schemas import errors
from schemas.commands import Relations
from schemas.relations import Relation, RelationName

_ABOUT_BETWEEN = 8
"""So many neighbours are looked at for what a thing is between."""


def relations(space: Space, query: Relations) -> Iterator[Relation]:
    """What is asked for. Raises UnknownName, Refused for what has no position."""
    for name in filter(None, (query.other, query.viewer)):
        if name not in space.solids:
            raise errors.UnknownName(
                f"nothing named '{name}' has a position{errors.did_you_mean(name, space.solids)}"
            )
    if query.other is not None:
        yield from relations_between(space, query.name, query.other)
    else:
        yield from relations_of(space, query.name)
    if query.viewer == query.name:
        raise errors.BadRequest(f"{query.name} cannot be seen from itself; --from takes another entity")
    viewer = None if query.viewer is None else space.solids[query.viewer]
    if viewer is not None or query.viewpoint is not None:
        view = View.of(viewer) if viewer is not None else View.at(*query.viewpoint or (0.0, 0.0, 0.0, 0.0))
        for relation in as_seen(space, query.name, view, viewer):
            if query.other in (None, relation.object) or relation.relation == "isVisibleFrom":
                yield relation


def relations_of(space: Space, name: str) -> Iterator[Relation]:
    """What a thing is in and on, hangs on, touches, is under, above, next to, near to and between."""
    solid = _solid(space, name)
    yield from (found := list(whereabouts(space, name)))
    if solid.is_place:
        return
    told = {relation.object for relation in found}
    beside = [other for other in space.around(solid, space.limits.near_most_m) if not other.is_place]
    beside = sorted(beside, key=lambda other: (measures.gap(solid, other), other.name))
    for other in beside:
        if other.name not in told:
            yield from _special(relation for relation in _beside(space, solid, other) if relation.holds)
    near = [other for other in beside if other.name not in told and not other.is_place][:_ABOUT_BETWEEN]
    for one, other in combinations(near, 2):
        if solid in between(space, one, other):
            yield _between(solid, one, other)


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
    """What a thing is inside, on and in; nothing for one without a position."""
    if (solid := space.solids.get(name)) is None:
        return
    container, supports, place = space.whereabouts(solid)
    if container is not None:
        yield _told("isInside", solid, *container)
    for support in supports:
        yield _told("isOn", solid, *support)
    if place is not None:
        yield _told("isLocatedIn", solid, *place)


def relations_between(space: Space, name: str, other_name: str) -> Iterator[Relation]:
    """All that can be measured of a pair, also what does not hold."""
    solid, other = _solid(space, name), _solid(space, other_name)
    wanted: tuple[RelationName, ...] = ("isLocatedIn",) if other.is_place else ("isOn", "isInside")
    for relation in wanted:
        measure = measured(space, relation, solid, other)
        if measure is not None:
            told = _told(relation, solid, other, measure)
            if relation == "isOn" and not measure.holds:
                told = structs.replace(told, text=told.text + _rather(space, solid, other))
            yield told
        elif relation == "isOn":
            text = f"{name} is not on {other_name}: it is over no surface of that"
            yield Relation(
                relation="isOn", subject=name, object=other_name, holds=False, share=0.0, text=text
            )
    yield from _beside(space, solid, other)
    if not (solid.is_place or other.is_place):
        yield from (_between(third, solid, other) for third in between(space, solid, other))


def _rather(space: Space, solid: Solid, other: Solid) -> str:
    """What a thing is inside or on, as a clause that says why it is not on another."""
    container, supports, _ = space.whereabouts(solid)
    if container is not None:
        return f"; it is inside {container[0].name}"
    names = [bearer.name for bearer, _ in supports if bearer is not other]
    return f"; it is on {' and '.join(names)}" if names else ""


def explained(space: Space, name: str, relation: str, other: str) -> Relation | None:
    """Whether a relation holds of two, and why or why not; None for what geometry does not tell."""
    if name not in space.solids or other not in space.solids:
        return None
    return next((r for r in relations_between(space, name, other) if r.relation == relation), None)


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
    """Whether a thing can be seen by a viewer, and on which side of its neighbours and the viewer it is."""
    solid = _solid(space, name)
    if solid.is_place:
        return
    found = list(sides(space, solid, view))
    if viewer is not None:
        found = [*own_sides(solid, viewer), *(side for side in found if side.other is not viewer)]
    for relation, other, by_m in found:
        yield Relation(
            relation=relation,
            subject=name,
            object=other.name,
            gap_m=round(by_m, 4),
            text=f"{name} {SPOKEN[relation]} {other.name}, by {metres(by_m)} from centre to centre",
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


SPOKEN: dict[RelationName, str] = {
    "isOn": "is on",
    "isInside": "is inside",
    "isLocatedIn": "is in",
    "isAttachedTo": "is attached to",
    "touches": "touches",
    "isUnder": "is under",
    "isAbove": "is above",
    "isNear": "is near",
    "isNextTo": "is next to",
    "isLeftOf": "is left of",
    "isRightOf": "is right of",
    "isInFrontOf": "is in front of",
    "isBehind": "is behind",
    "isBetween": "is between",
    "isVisibleFrom": "is visible from",
}


def _beside(space: Space, solid: Solid, other: Solid) -> Iterator[Relation]:
    if is_apart(space, solid, other) and (made := attached(space, solid, other)) is not None:
        yield _told("isAttachedTo", solid, other, made)
    for relation, measure in beside(space, solid, other):
        yield _told(relation, solid, other, measure)


def _told(relation: RelationName, solid: Solid, other: Solid, measure: Measure) -> Relation:
    says = SPOKEN[relation] if measure.holds else SPOKEN[relation].replace("is ", "is not ", 1)
    return Relation(
        relation=relation,
        subject=solid.name,
        object=other.name,
        holds=measure.holds,
        gap_m=round(measure.gap_m, 4),
        share=round(measure.share, 4),
        text=f"{solid.name} {says} {other.name}: {why(relation, solid, other, measure)}",
    )


def why(relation: RelationName, solid: Solid, other: Solid, made: Measure) -> str:
    """The measurement behind a relation, whether it holds or not, as a clause."""
    match relation:
        case "isOn":
            where = "above" if made.gap_m >= 0.0 else "below"
            return (
                f"its bottom is {metres(abs(made.gap_m))} {where} a surface of {other.name},"
                f" at {metres(made.height_m)},"
                f" and {made.share:.0%} of its base is over it"
            )
        case "isInside":
            return f"{made.share:.0%} of its volume is within a hollow of {other.name}"
        case "isLocatedIn":
            part = f"{made.share:.0%} of its footprint" if solid.is_measured else "its position"
            inside = "is" if made.share > 0.0 else "is not"
            return f"{part} {inside} within {other.name}"
        case "isUnder":
            return f"its top is {metres(made.gap_m)} below {other.name}, which is over {made.share:.0%} of it"
        case "isAbove":
            return f"it is {metres(made.gap_m)} above {other.name}, and over {made.share:.0%} of that"
        case "isAttachedTo":
            return f"nothing bears it, and it is {metres(made.gap_m)} from the side of {other.name}"
        case "touches":
            return f"they are {metres(max(0.0, made.gap_m))} apart"
        case "isNextTo" if made.share == 0.0:
            return f"they are {metres(made.gap_m)} apart, but stand on different things"
        case "isNextTo":
            nothing = "nothing is" if made.holds else "something is"
            return f"they are {metres(made.gap_m)} apart, stand on the same, and {nothing} between them"
    return (
        f"they are {metres(made.gap_m)} apart (near is up to {metres(made.limit)} for things of their sizes)"
    )


def metres(value: float) -> str:
    """A length as a person reads it."""
    if abs(value) < 0.01:
        return f"{1000.0 * value:.1f} mm"
    return f"{100.0 * value:.1f} cm" if abs(value) < 1.0 else f"{value:.2f} m"


def _solid(space: Space, name: str) -> Solid:
    try:
        return space.solids[name]
    except KeyError:
        raise errors.Refused(f"{name} has no position, so it is in no relation to anything") from None
