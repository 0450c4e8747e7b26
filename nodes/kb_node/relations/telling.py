"""Relations in words: the sentence with the measurement behind it."""

from __future__ import annotations

import math
from collections.abc import Iterator

from nodes.kb_node.relations import measures
from nodes.kb_node.relations.measures import Measure
from nodes.kb_node.relations.solids import Solid
from nodes.kb_node.relations.space import Space
from schemas import errors
from schemas.commands import Relations
from schemas.relations import Relation, RelationName, ViewPoint

_OPPOSITE_TOLERANCE = math.tan(math.radians(50.0))


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
    viewpoint = query.viewpoint
    if query.viewer == query.name:
        raise errors.BadRequest(f"{query.name} cannot be seen from itself; --from takes another entity")
    if query.viewer is not None:
        x, y, z = space.solids[query.viewer].position
        viewpoint = (x, y, z, 0.0)
    if viewpoint is not None:
        seen = as_seen(space, query.name, viewpoint)
        yield from (r for r in seen if query.other in (None, r.object) and r.object != query.viewer)


def relations_of(space: Space, name: str) -> Iterator[Relation]:
    """What a thing is in, inside, on, under, above and near to."""
    solid = _solid(space, name)
    yield from (found := list(whereabouts(space, name)))
    if solid.is_place:
        return
    told = {relation.object for relation in found}
    beside = [other for other in space.around(solid, space.limits.near_most_m) if not other.is_place]
    for other in sorted(beside, key=lambda other: measures.gap(solid, other)):
        if other.name not in told:
            yield from (relation for relation in _beside(space, solid, other) if relation.holds)


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
            yield _told(relation, solid, other, measure)
        elif relation == "isOn":
            text = f"{name} is not on {other_name}: it is over no surface of that"
            yield Relation(
                relation="isOn", subject=name, object=other_name, holds=False, share=0.0, text=text
            )
    yield from _beside(space, solid, other)


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


def as_seen(space: Space, name: str, viewpoint: ViewPoint) -> Iterator[Relation]:
    """Left of, right of, in front of and behind its neighbours, as a viewer sees them.

    The vantage is the viewer's, the front of a relatum is the side towards the viewer (Tenbrink and Kuhn
    2011); a direction counts within 50 degrees of its axis (Socher et al. 1997 grade it, and we cut at a
    half).
    """
    solid = _solid(space, name)
    vx, vy = viewpoint[0], viewpoint[1]
    for other in space.around(solid, 2.0 * space.limits.near_most_m):
        if other.is_place or measures.gap(solid, other) > 2.0 * space.limits.near_most_m:
            continue
        ox, oy, _ = other.centre
        sx, sy, _ = solid.centre
        length = math.hypot(ox - vx, oy - vy)
        if length < 1e-6:
            continue
        fx, fy = (ox - vx) / length, (oy - vy) / length
        ahead = (sx - ox) * fx + (sy - oy) * fy
        left = (sy - oy) * fx - (sx - ox) * fy
        if max(abs(ahead), abs(left)) < 0.5 * min(min(solid.size[:2]), min(other.size[:2])):
            continue
        if abs(left) >= abs(ahead) / _OPPOSITE_TOLERANCE:
            yield _seen("isLeftOf" if left > 0 else "isRightOf", solid, other, abs(left))
        if abs(ahead) >= abs(left) / _OPPOSITE_TOLERANCE:
            yield _seen("isBehind" if ahead > 0 else "isInFrontOf", solid, other, abs(ahead))


def _seen(relation: RelationName, solid: Solid, other: Solid, by_m: float) -> Relation:
    text = f"{solid.name} {SPOKEN[relation]} {other.name}, by {metres(by_m)} from centre to centre"
    return Relation(relation=relation, subject=solid.name, object=other.name, gap_m=round(by_m, 4), text=text)


SPOKEN: dict[RelationName, str] = {
    "isOn": "is on",
    "isInside": "is inside",
    "isLocatedIn": "is in",
    "isUnder": "is under",
    "isAbove": "is above",
    "isNear": "is near",
    "isLeftOf": "is left of",
    "isRightOf": "is right of",
    "isInFrontOf": "is in front of",
    "isBehind": "is behind",
}


def _beside(space: Space, solid: Solid, other: Solid) -> Iterator[Relation]:
    limits = space.limits
    for relation, measure in (
        ("isUnder", measures.beneath(solid, other, limits)),
        ("isAbove", measures.beneath(other, solid, limits)),
        ("isNear", measures.near(solid, other, limits)),
    ):
        if measure is not None:
            yield _told(relation, solid, other, measure)  # type: ignore[arg-type]


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
