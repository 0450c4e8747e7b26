"""Whether a part of an object is above another one, seen from above."""

from __future__ import annotations

import math
from collections.abc import Iterable

from semmap.nodes.geometry.polygons import Point, area, clipped, contains
from semmap.nodes.kb_node.relations.geometry.convex import Convex
from semmap.nodes.kb_node.relations.geometry.forms import Bounds
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring.measures import Measure, overlap
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds

_SAMPLES = 10
"""Samples along each side of a footprint."""


def beneath(lower: Solid, upper: Solid, limits: Thresholds) -> Measure | None:
    """Return how one solid is below a part of another, such as a box under a table.

    A part counts only where it is over the other footprint. None if nothing is above.
    """
    if lower is upper or lower.is_place or upper.is_place or not (lower.is_measured and upper.is_measured):
        return None
    if not overlap(lower.bounds, upper.bounds):
        return None
    if upper.top < min([part.lowest_top for part in lower.parts]) - limits.touch_m:
        return None
    are_single = len(lower.parts) == len(upper.parts) == 1 and lower.is_level and upper.is_level
    if are_single and not lower.form.has_slopes:
        if upper.bottom < lower.top - limits.touch_m:
            return None
        (one,), (other,) = lower.parts, upper.parts
        smaller = max(min(area(one.projection), area(other.projection)), 1e-9)
        share = area(clipped(one.projection, other.projection)) / smaller
        height, gap_m = upper.bottom, upper.bottom - lower.top
    else:
        share, height, gap_m = _compute_covered_footprint(lower, upper, limits)
    if share == 0.0:
        return None
    return Measure(share >= limits.beneath_share, gap_m, share, height, limits.beneath_share)


def _compute_covered_footprint(lower: Solid, upper: Solid, limits: Thresholds) -> tuple[float, float, float]:
    """Return the share of the smaller footprint where a part of `upper` is over `lower`, sampled on a grid.

    Also return the height of the lowest such part, and its gap to the top of `lower` at that place [m]. A
    chair's backrest beside a desk does not matter to the seat below the desk.
    """
    smaller = lower if lower.footprint < upper.footprint else upper
    points = _sample_footprint(smaller)
    tops, bottoms = _list_parts_over(lower, smaller.bounds), _list_parts_over(upper, smaller.bounds)
    lowest = min([part.lowest_top for part in tops], default=math.inf) - limits.touch_m
    bottoms = [part for part in bottoms if part.high[2] >= lowest]
    gaps = list[tuple[float, float]]()
    for point in points:
        below, above = _list_parts_at(tops, point), _list_parts_at(bottoms, point)
        if not (below and above):
            continue
        top = max([part.find_heights(point)[1] for part in below])
        over = [low for part in above if (low := part.find_heights(point)[0]) >= top - limits.touch_m]
        if over:
            gaps.append((min(over) - top, min(over)))
    if not gaps:
        return 0.0, 0.0, 0.0
    gap_m, height = min(gaps)
    return len(gaps) / len(points), height, gap_m


def _sample_footprint(solid: Solid) -> list[Point]:
    """Return points on the floor plan that are in parts of a solid.

    They are on a grid over its bounds. If this has few points in parts, as for a clothes rack, they are in
    the middle and towards the corners of each part.
    """
    x0, y0, x1, y1 = solid.bounds
    steps = [(k + 0.5) / _SAMPLES for k in range(_SAMPLES)]
    grid = [(x0 + u * (x1 - x0), y0 + v * (y1 - y0)) for u in steps for v in steps]
    found = [point for point in grid if _list_parts_at(solid.parts, point)]
    if len(found) > _SAMPLES:
        return found
    found = []
    for part in solid.parts:
        corners = part.projection
        x, y = (sum(along) / len(corners) for along in zip(*corners, strict=True))
        found += [(x, y), *(((x + u) / 2, (y + v) / 2) for u, v in corners)]
    return found


def _list_parts_over(solid: Solid, bounds: Bounds) -> list[Convex]:
    return [part for part in solid.parts if overlap((*part.low[:2], *part.high[:2]), bounds)]


def _list_parts_at(parts: Iterable[Convex], point: Point) -> list[Convex]:
    """Return the parts that the vertical line through a point meets."""
    x, y = point
    return [
        part
        for part in parts
        if part.low[0] <= x <= part.high[0]
        and part.low[1] <= y <= part.high[1]
        and (part.is_square or contains(part.projection, point))
    ]
