"""Distances of two objects: contact, nearness, and one against the side of another."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from semmap.nodes.geometry.polygons import Point, distance
from semmap.nodes.kb_node.relations.geometry.convex import contact, over_flat_top
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring.measures import Measure, overlap
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds

BESIDE_M = 0.2
"""The largest horizontal distance at which an object can be attached [m]."""
ALONGSIDE = 0.5
"""The least share of the height of an attached object that is alongside what it is attached to."""
_Piece = tuple[Sequence[Point], float, float]
"""An outline, bottom and top [m]."""


def touches(one: Solid, other: Solid, limits: Thresholds) -> Measure | None:
    """Return the distance between the colliding parts of two solids, or None above the contact limit."""
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


def gap(one: Solid, other: Solid) -> float:
    """Return the distance of two boxes [m]. Tilted ones are replaced by the upright prisms around them.

    Open doors and drawers count as parts of their own.
    """
    if one.form.joints or other.form.joints:
        return min(_compute_piece_gap(a, b) for a in _list_pieces(one) for b in _list_pieces(other))
    up = max(0.0, one.bottom - other.top, other.bottom - one.top)
    if one.is_place or other.is_place:
        return math.hypot(_compute_plan_gap(one, other), up)
    return math.hypot(distance(one.outline, other.outline), up)


def gap_from_above(one: Solid, other: Solid) -> float:
    """Return the horizontal distance of two solids, with the parts that stand open [m]."""
    return min(distance(a, b) for a, _, _ in _list_pieces(one) for b, _, _ in _list_pieces(other))


def _list_pieces(solid: Solid) -> Iterator[_Piece]:
    """Yield the box, and the parts that stand open."""
    yield solid.outline, solid.bottom, solid.top
    for part in solid.open_parts:
        yield part.projection, part.low[2], part.high[2]


def _compute_piece_gap(one: _Piece, other: _Piece) -> float:
    (outline, bottom, top), (its, low, high) = one, other
    return math.hypot(distance(outline, its), max(0.0, bottom - high, low - top))


def _compute_plan_gap(one: Solid, other: Solid) -> float:
    """Return the horizontal distance of a place, which may be a polygon, and a solid [m]."""
    for place, solid in ((one, other), (other, one)):
        if (region := place.form.region) is not None:
            return region.distance(solid.outline, place.position[:2])
    return distance(one.outline, other.outline)


def against(solid: Solid, other: Solid, limits: Thresholds) -> Measure | None:
    """Return how a solid is against the side of another one, off its base. None if it is not beside it."""
    if solid is other or solid.is_place or other.is_place or not solid.is_measured:
        return None
    if solid.bottom <= other.bottom + limits.gap_m or solid.top <= solid.bottom:
        return None
    share = (min(solid.top, other.top) - solid.bottom) / (solid.top - solid.bottom)
    if share <= 0.0 or not overlap(solid.bounds, other.bounds, BESIDE_M):
        return None
    apart = distance(solid.outline, other.outline)
    return Measure(apart <= limits.attached_m and share >= ALONGSIDE, apart, share, limit=limits.attached_m)


def near(one: Solid, other: Solid, limits: Thresholds) -> Measure | None:
    """Return the gap relative to the sizes of both, as Gapp (1994) scales distances. None without a size."""
    if one is other or not (one.has_parts and other.has_parts):
        return None
    limit = near_limit(one, other, limits)
    between = gap(one, other)
    return Measure(between <= limit, between, limit=limit)


def near_limit(one: Solid, other: Solid, limits: Thresholds) -> float:
    """Return the greatest gap for which two solids are near [m]."""
    return min(limits.near_most_m, limits.near_share * (max(one.size) + max(other.size)) / 2.0)
