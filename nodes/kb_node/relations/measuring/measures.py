"""What is measured between two solids, relation by relation. None where nothing can be measured.

*On* and *in* are grounded in support and containment, not in overlapping boxes (Richard-Bollans et al. 2019).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from semmap.nodes.geometry.polygons import Point, area, clipped, contains, covers, distance, hull
from semmap.nodes.geometry.regions import Region
from semmap.nodes.kb_node.relations.geometry.convex import Convex, contact, over_flat_top
from semmap.nodes.kb_node.relations.geometry.forms import LOWEST_M, Bounds
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.ontology.model_shapes import Interior

_ROUNDING = 1e-9
"""0.80 - 0.75 is more than 0.05 in floats."""
_SIDEWAYS = math.sin(math.radians(10.0))
"""A normal nearer to the horizontal than this is that of two who stand side by side."""
_FLAT = math.cos(math.radians(2.0))
"""A normal this near to the vertical is that of a flat contact."""
_FLOOR_M = 0.002
"""Between the floor of a hollow and a top that is the floor."""


_Piece = tuple[Sequence[Point], float, float]
"""An outline, bottom and top [m]."""


class Measure(NamedTuple):
    """Whether a relation holds between two solids, and the numbers behind it."""

    holds: bool
    gap_m: float = 0.0
    """Between the two; of *on* how far the bottom is above the surface, negative below it."""
    share: float = 1.0
    """Of the first one's base, volume or footprint that the relation is about."""
    height_m: float = 0.0
    """Of the surface, in the map."""
    limit: float = 0.0
    """Up to which gap, or from which share on, it holds."""


def on(upper: Solid, lower: Solid, limits: Thresholds) -> Measure | None:
    """How one rests on another: where they meet, or nearly do, along a normal that points up.

    None where they do not, or where the one's base is nowhere over the other. It does not hold of what only
    leans there, along a steeper normal.
    """
    reach = limits.gap_m + _ROUNDING
    if upper is lower or upper.bottom - lower.top > reach or not overlap(upper.bounds, lower.bounds):
        return None
    # What is let down onto a thing does not end up lower than that: beside a thing one is not on it.
    most = min(reach, upper.bottom - lower.bottom + limits.contact_m)
    is_level = upper.is_level and lower.is_level
    if is_level and (most < 0.0 or upper.highest_bottom - lower.lowest_top < -reach):
        return None
    most = max(most, limits.contact_m)
    pairs = []
    for part in upper.parts:
        (x0, y0, z0), (x1, y1, z1) = part.low, part.high
        for other in lower.parts:
            (low_x, low_y, low_z), (high_x, high_y, high_z) = other.low, other.high
            least = z0 - high_z
            if least > most or z1 <= low_z or (is_level and least < -reach):
                continue
            if x0 <= high_x and low_x <= x1 and y0 <= high_y and low_y <= y1:
                pairs.append((least, part, other))
    if not pairs:
        return None
    if len(pairs) > 1:
        pairs.sort(key=_least)
    best: Measure | None = None
    leaning: Measure | None = None
    for least, part, other in pairs:
        if best is not None and least >= best.gap_m:
            break
        gap, upright = least, 1.0
        if not over_flat_top(part, other):
            gap, (_, _, upright) = contact(part, other, most)
            if not -reach <= gap <= most:
                continue
            if upright < limits.upright:
                if upright > _SIDEWAYS and abs(gap) <= limits.contact_m:
                    leaning = Measure(False, gap, 1.0, upper.bottom - gap, most)
                continue
        if best is None or gap < best.gap_m:
            best = Measure(True, gap, 1.0, upper.bottom - gap, most)
            is_flat = upright > _FLAT and other.has_flat_top
    if best is None:
        return leaning
    if not (is_flat and upper.is_upright):
        return best
    share = _covered(upper, lower, best.height_m)
    if share <= 0.0:
        return None
    best = best._replace(share=share)
    if share < limits.base_share and not is_balanced(upper, (lower,), best.height_m):
        tops = {other.high[2] for _, _, other in pairs if other.has_flat_top}
        return _within_rim(upper, lower, best, sorted(tops, reverse=True), limits) or best
    return best


def _within_rim(
    upper: Solid, lower: Solid, rim: Measure, tops: Sequence[float], limits: Thresholds
) -> Measure | None:
    """How one rests on the highest of the lower tops that is under enough of its base; None without one.

    A pose is worth less than a rim is wide: what stands in a tray may seem to reach over the edge of it.
    """
    for height in tops:
        gap = upper.bottom - height
        if height < rim.height_m - LOWEST_M and gap <= rim.limit:
            share = _covered(upper, lower, height)
            if share >= limits.base_share:
                return Measure(True, gap, share, height, rim.limit)
    return None


def is_in_open_hollow(lower: Solid, upper: Solid, made: Measure) -> bool:
    """Whether what is on another is so in an open hollow of it, as what stands in a tray is.

    Most of the base is over the floor of the hollow, so that nothing below the other one can bear it.
    """
    if not (lower.is_level and upper.volume < lower.volume):
        return False
    whole = area(upper.outline)
    for hollow in lower.hollows:
        (x0, y0, z0), (x1, y1, _) = hollow.low, hollow.high
        if hollow.open and abs(lower.position[2] + z0 - made.height_m) <= _FLOOR_M:
            floor = [lower.to_map((x, y, 0.0))[:2] for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))]
            if area(clipped(upper.outline, floor)) > 0.5 * whole:
                return True
    return False


def _least(pair: tuple[float, object, object]) -> float:
    return pair[0]


def _covered(upper: Solid, lower: Solid, height: float) -> float:
    """The share of a base that is over flat tops at a height."""
    bearing = [p for p in lower.parts if p.has_flat_top and abs(p.high[2] - height) <= LOWEST_M]
    for part in bearing:
        if part.is_square and _is_amid(upper.bounds, (*part.low[:2], *part.high[:2])):
            return 1.0
    if len(bearing) == len(upper.parts) == 1 and bearing[0].is_square and upper.parts[0].is_square:
        return _share_of_box(upper.parts[0], bearing[0])
    base = upper.base
    tops = [part.projection for part in bearing]
    for top in tops:
        if covers(top, base):
            return 1.0
    whole = area(base)
    return min(1.0, sum(area(clipped(base, top)) for top in tops) / whole) if whole > 0.0 else 0.0


def _share_of_box(upper: Convex, lower: Convex) -> float:
    """The share of one box, from above, that is over another; both are along the axes."""
    (x0, y0, _), (x1, y1, _) = upper.low, upper.high
    (a0, b0, _), (a1, b1, _) = lower.low, lower.high
    wide, deep = min(x1, a1) - max(x0, a0), min(y1, b1) - max(y0, b0)
    return wide * deep / ((x1 - x0) * (y1 - y0)) if wide > 0.0 and deep > 0.0 else 0.0


def is_balanced(upper: Solid, lower: Iterable[Solid], height: float) -> bool:
    """Whether the middle of a base is over what bears it at a height, or between that."""
    base = upper.base
    region = hull(
        [
            corner
            for other in lower
            for part in other.parts
            if part.has_flat_top and abs(part.high[2] - height) <= LOWEST_M
            for corner in clipped(base, part.projection)
        ]
    )
    x0, y0, x1, y1 = (limit(along) for limit in (min, max) for along in zip(*base, strict=True))
    return len(region) > 2 and contains(region, ((x0 + x1) / 2, (y0 + y1) / 2))


def over(upper: Solid, lower: Solid, limits: Thresholds) -> Measure | None:
    """How far above the best surface of the other one is, however far; None where it is over none of them."""
    if upper is lower or not upper.is_measured or not overlap(upper.bounds, lower.bounds):
        return None
    whole = area(upper.outline)
    best: Measure | None = None
    for support in lower.supports:
        gap = upper.bottom - support.height
        share = area(clipped(upper.outline, support.outline)) / whole if whole > 0.0 else 0.0
        if share > 0.0 and (best is None or abs(gap) < abs(best.gap_m)):
            best = Measure(False, gap, share, support.height, limits.base_share)
    return best


def inside(inner: Solid, outer: Solid, limits: Thresholds) -> Measure | None:
    """The share of one's volume that is in a hollow of the other; None where that has none, or is smaller."""
    if not outer.hollows or inner is outer or inner.is_place or not inner.is_measured:
        return None
    if inner.volume >= outer.volume or not overlap(inner.bounds, outer.bounds):
        return None
    share = max([_share_in(inner, outer, hollow) for hollow in outer.hollows])
    return Measure(share >= limits.inside_share, share=share, limit=limits.inside_share)


def hollow_around(inner: Solid, outer: Solid) -> Interior:
    """That hollow of the other, which has some, in which most of its volume is."""
    return max(outer.hollows, key=lambda hollow: _share_in(inner, outer, hollow))


def _share_in(inner: Solid, outer: Solid, hollow: Interior) -> float:
    (x0, y0, z0), (x1, y1, z1) = hollow.low, hollow.high
    if not (inner.is_level and outer.is_level):
        points = inner.samples
        found = [outer.to_own(point) for point in points]
        return sum(x0 <= x <= x1 and y0 <= y <= y1 and z0 <= z <= z1 for x, y, z in found) / len(points)
    floor, lid = outer.position[2] + z0, outer.position[2] + z1
    height = min(lid, inner.position[2] + inner.size[2]) - max(floor, inner.position[2])
    if height <= 0.0:
        return 0.0
    walls = [outer.to_map((x, y, 0.0))[:2] for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))]
    return area(clipped(inner.outline, walls)) * height / inner.volume


def touches(one: Solid, other: Solid, limits: Thresholds) -> Measure | None:
    """How near what collides of the two is; None for what is further apart than counts."""
    if one is other or not overlap(one.bounds, other.bounds, limits.contact_m):
        return None
    limit = limits.contact_m
    nearest: float | None = None
    for part in one.parts:
        (x0, y0, z0), (x1, y1, z1) = part.low, part.high
        for its in other.parts:
            (a0, b0, c0), (a1, b1, c1) = its.low, its.high
            if max(x0 - a1, a0 - x1, y0 - b1, b0 - y1, z0 - c1, c0 - z1) > limit:
                continue
            if over_flat_top(part, its):
                apart = z0 - c1
            elif over_flat_top(its, part):
                apart = c0 - z1
            else:
                apart = contact(part, its, limit).distance
            if apart <= limit and (nearest is None or apart < nearest):
                nearest = apart
    return None if nearest is None else Measure(True, nearest, limit=limit)


def within(solid: Solid, place: Solid, limits: Thresholds, *, also_places: bool = False) -> Measure | None:
    """The share of one's footprint that is in a place; of what has no size, whether its position is.

    None where the other is no place with an extent, and of a place, unless with `also_places`.
    """
    if not place.is_place or not place.is_measured or (solid.is_place and not also_places):
        return None
    height = solid.centre[2] if solid.is_measured else solid.position[2]
    limit = limits.place_share
    if not place.bottom - limits.gap_m <= height <= place.top + limits.gap_m:
        return Measure(False, share=0.0, limit=limit)
    if place.form.region is not None:
        share = _share_in_region(solid, place, place.form.region)
    elif not solid.is_measured:
        share = float(contains(place.outline, solid.position[:2]))
    elif not overlap(solid.bounds, place.bounds):
        share = 0.0
    elif solid.form.region is not None:
        share = solid.form.region.shared(place.outline, solid.position[:2]) / max(solid.footprint, 1e-9)
    elif (place.form.is_square and _is_amid(solid.bounds, place.bounds)) or covers(
        place.outline, solid.outline
    ):
        share = 1.0
    else:
        share = area(clipped(solid.outline, place.outline)) / max(area(solid.outline), 1e-9)
    return Measure(share >= limit, share=share, limit=limit)


def _share_in_region(solid: Solid, place: Solid, region: Region) -> float:
    """The share of a footprint that a polygon covers; of what has no size, whether its position is in it."""
    x, y, _ = place.position
    if not solid.is_measured:
        px, py, _ = solid.position
        return float(region.contains((px - x, py - y)))
    if not overlap(solid.bounds, place.bounds):
        return 0.0
    if (its := solid.form.region) is not None:
        to = (x - solid.position[0], y - solid.position[1])
        shared = sum(region.shared(piece.corners, to) for piece in its.pieces)
        return min(1.0, shared / max(its.area, 1e-9))
    return min(1.0, region.shared(solid.outline, (x, y)) / max(area(solid.outline), 1e-9))


def gap(one: Solid, other: Solid) -> float:
    """The distance of two boxes [m]; of leaning ones that of the upright prisms around them.

    What stands open counts as a part of its own.
    """
    if one.form.joints or other.form.joints:
        return min(_gap_of_pieces(a, b) for a in _pieces(one) for b in _pieces(other))
    up = max(0.0, one.bottom - other.top, other.bottom - one.top)
    if one.is_place or other.is_place:
        return math.hypot(_apart_in_plan(one, other), up)
    return math.hypot(distance(one.outline, other.outline), up)


def _pieces(solid: Solid) -> Iterator[_Piece]:
    """Its box, and what of it stands open."""
    yield solid.outline, solid.bottom, solid.top
    for part in solid.open_parts:
        yield part.projection, part.low[2], part.high[2]


def _gap_of_pieces(one: _Piece, other: _Piece) -> float:
    (outline, bottom, top), (its, low, high) = one, other
    return math.hypot(distance(outline, its), max(0.0, bottom - high, low - top))


def _apart_in_plan(one: Solid, other: Solid) -> float:
    """The distance of two outlines, of which one is a place's and may be a polygon [m]."""
    for place, solid in ((one, other), (other, one)):
        if (region := place.form.region) is not None:
            return region.distance(solid.outline, place.position[:2])
    return distance(one.outline, other.outline)


def near(one: Solid, other: Solid, limits: Thresholds) -> Measure | None:
    """A gap that is small beside the sizes of both, as Gapp (1994) scales distances; None without a size."""
    if one is other or not (one.has_parts and other.has_parts):
        return None
    limit = near_limit(one, other, limits)
    between = gap(one, other)
    return Measure(between <= limit, between, limit=limit)


def near_limit(one: Solid, other: Solid, limits: Thresholds) -> float:
    """Up to which gap two things are near to one another [m]."""
    return min(limits.near_most_m, limits.near_share * (max(one.size) + max(other.size)) / 2.0)


def beneath(lower: Solid, upper: Solid, limits: Thresholds) -> Measure | None:
    """Whether one is below a part of the other, as a box is under a table; None if nothing is over it."""
    if lower is upper or lower.is_place or upper.is_place or not (lower.is_measured and upper.is_measured):
        return None
    if not overlap(lower.bounds, upper.bounds):
        return None
    least = lower.top - limits.touch_m
    above = lower.top + limits.contact_m  # a surface at the height of its own top is beside it
    ceilings = [support.height for support in upper.supports if support.height > above]
    if upper.bottom >= least:
        ceilings.append(upper.bottom)
    smaller = max(min(lower.footprint, upper.footprint), 1e-9)
    share = area(clipped(lower.outline, upper.outline)) / smaller
    if share == 0.0 or not ceilings:
        return None
    height = min(ceilings)
    return Measure(share >= limits.beneath_share, height - lower.top, share, height, limits.beneath_share)


def _is_amid(one: Bounds, other: Bounds) -> bool:
    """Whether one rectangle along the axes is within another."""
    return one[0] >= other[0] and one[1] >= other[1] and one[2] <= other[2] and one[3] <= other[3]


def overlap(one: Bounds, other: Bounds, margin_m: float = 0.0) -> bool:
    """Whether two rectangles along the axes meet, or are within a margin."""
    return (
        one[0] - margin_m <= other[2]
        and other[0] - margin_m <= one[2]
        and one[1] - margin_m <= other[3]
        and other[1] - margin_m <= one[3]
    )
