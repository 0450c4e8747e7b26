"""What is measured between two solids, relation by relation. None where nothing can be measured.

*On* and *in* are grounded in support and containment, not in overlapping boxes (Richard-Bollans et al. 2019).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from nodes.kb_node.relations.polygons import area, clipped, contains, distance
from nodes.kb_node.relations.solids import Bounds, Solid
from nodes.kb_node.relations.thresholds import Thresholds


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


def on(upper: Solid, lower: Solid, limits: Thresholds, *, far: bool = False) -> Measure | None:
    """How the base of one stands over the best surface of the other.

    None where no surface is below it; and, unless `far`, where none is near.
    """
    if not upper.is_measured or upper.is_place or upper is lower or not overlap(upper.bounds, lower.bounds):
        return None
    best: Measure | None = None
    for support in lower.supports:
        gap = upper.bottom - support.height
        is_near = abs(gap) <= limits.gap_m
        if not (is_near or far):
            continue
        share = _covered(upper, support.outline)
        if share > 0.0:
            made = Measure(
                is_near and share >= limits.base_share, gap, share, support.height, limits.base_share
            )
            if best is None or preferred(made) > preferred(best):
                best = made
    return best


def preferred(made: Measure) -> tuple[bool, float, float, float]:
    """Of several surfaces the nearest counts, to a centimetre; of those the highest."""
    return (made.holds, -round(abs(made.gap_m), 2), made.height_m, made.share)


def _covered(upper: Solid, outline: tuple[tuple[float, float], ...]) -> float:
    base = upper.base
    whole = area(base)
    if whole <= 0.0:
        return 0.0
    if all(contains(outline, corner) for corner in base):
        return 1.0
    return area(clipped(base, outline)) / whole


def inside(inner: Solid, outer: Solid, limits: Thresholds) -> Measure | None:
    """The share of one's volume that is in a hollow of the other; None where that has none, or is smaller."""
    if not outer.hollows or inner is outer or inner.is_place or not inner.is_measured:
        return None
    if inner.volume >= outer.volume or not overlap(inner.bounds, outer.bounds):
        return None
    points = [outer.to_own(point) for point in inner.samples]
    most = 0
    for hollow in outer.hollows:
        (x0, y0, z0), (x1, y1, z1) = hollow.low, hollow.high
        most = max(most, sum(x0 <= x <= x1 and y0 <= y <= y1 and z0 <= z <= z1 for x, y, z in points))
    share = most / len(points)
    return Measure(share >= limits.inside_share, share=share, limit=limits.inside_share)


def within(solid: Solid, place: Solid, limits: Thresholds) -> Measure | None:
    """The share of one's footprint that is in a place; of what has no size, whether its position is."""
    if not place.is_place or not place.is_measured or solid.is_place:
        return None
    height = solid.centre[2] if solid.is_measured else solid.position[2]
    limit = limits.place_share
    if not place.bottom - limits.gap_m <= height <= place.top + limits.gap_m:
        return Measure(False, share=0.0, limit=limit)
    if not solid.is_measured:
        share = float(contains(place.outline, solid.position[:2]))
    elif not overlap(solid.bounds, place.bounds):
        share = 0.0
    elif all(contains(place.outline, corner) for corner in solid.outline):
        share = 1.0
    else:
        share = area(clipped(solid.outline, place.outline)) / max(area(solid.outline), 1e-9)
    return Measure(share >= limit, share=share, limit=limit)


def gap(one: Solid, other: Solid) -> float:
    """The distance of two boxes [m]; of leaning ones that of the upright prisms around them."""
    up = max(0.0, one.bottom - other.top, other.bottom - one.top)
    return math.hypot(distance(one.outline, other.outline), up)


def near(one: Solid, other: Solid, limits: Thresholds) -> Measure | None:
    """A gap that is small beside the sizes of both, as Gapp (1994) scales distances."""
    if one is other or one.is_place or other.is_place:
        return None
    limit = min(limits.near_most_m, limits.near_share * (max(one.size) + max(other.size)) / 2.0)
    between = gap(one, other)
    return Measure(between <= limit, between, limit=limit)


def beneath(lower: Solid, upper: Solid, limits: Thresholds) -> Measure | None:
    """Whether one is below a part of the other, as a box is under a table; None if nothing is over it."""
    if lower is upper or lower.is_place or upper.is_place or not (lower.is_measured and upper.is_measured):
        return None
    if not overlap(lower.bounds, upper.bounds):
        return None
    least = lower.top - limits.touch_m
    ceilings = [support.height for support in upper.supports if support.height >= least]
    if upper.bottom >= least:
        ceilings.append(upper.bottom)
    share = area(clipped(lower.outline, upper.outline)) / max(area(lower.outline), 1e-9)
    if share == 0.0 or not ceilings:
        return None
    height = min(ceilings)
    return Measure(share >= limits.beneath_share, height - lower.top, share, height, limits.beneath_share)


def overlap(one: Bounds, other: Bounds) -> bool:
    """Whether two rectangles along the axes meet."""
    return one[0] <= other[2] and other[0] <= one[2] and one[1] <= other[3] and other[1] <= one[3]
