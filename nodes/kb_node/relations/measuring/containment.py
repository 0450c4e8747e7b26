"""Whether an object is in a hollow of another one, or stands in it and sticks out."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import combinations

from semmap.nodes.geometry.polygons import Point, area, clipped, contains
from semmap.nodes.kb_node.relations.geometry.convex import Convex
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring.measures import Measure, overlap
from semmap.nodes.kb_node.relations.measuring.recessed import may_be_recessed, measure_recess
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.ontology.model_shapes import Interior

_ROUNDING = 1e-9
"""Tolerance for rounding: 0.80 - 0.75 exceeds 0.05 in floats."""
_MOST = 0.5
"""The share of a base above which an object stands in a container."""
FIT = 1.1
"""How much larger than a hollow an object in it may be, because of flared walls and soft objects."""
_HOLDER_DEPTH = 0.2
"""The least depth of a container from which objects stick out, relative to its width."""
FLOOR_M = 0.002
"""Tolerance between the floor of a hollow and the top that forms it. A floor is thicker."""
_SLACK_M = 0.01
"""Tolerance of bounds around hollows, because an object that is nearly level counts as level."""


def inside(inner: Solid, outer: Solid, limits: Thresholds) -> Measure | None:
    """Return the share of a volume within a hollow of the other solid, in which the object must fit.

    If the object sticks out of a hollow in which it stands, such as an umbrella, it is the share of its
    base. A fixture, such as a sink, may be let into a top. None without a hollow, or if that is smaller.
    """
    if inner.is_fixed and (made := measure_recess(inner, outer, limits)) is not None and made.holds:
        return made
    if not outer.hollows or inner is outer or inner.is_place or not inner.is_measured:
        return None
    if not overlap(inner.bounds, outer.bounds):
        return None
    share, least = 0.0, limits.inside_share
    if is_smaller := inner.volume < outer.volume:
        shares = [_compute_share_in(inner, outer, hollow) for hollow in outer.hollows]
        share = max(shares)
        if share >= least:
            around = [hollow for hollow, its in zip(outer.hollows, shares, strict=True) if its >= least]
            return Measure(any(_fits(inner, hollow) for hollow in around), share=share, limit=least)
    if outer.is_level:
        standing = max([_compute_base_share_in(inner, outer, hollow, limits) for hollow in outer.hollows])
        if standing > _MOST:
            return Measure(True, share=standing, limit=_MOST, by_base=True)
    return Measure(False, share=share, limit=least) if is_smaller else None


def may_be_inside(inner: Solid, outer: Solid, limits: Thresholds) -> bool:
    """Return whether `inside` may hold. It is fast and may return True too often."""
    if may_be_recessed(inner, outer, limits):
        return True
    around = outer.form.hollow_bounds
    if around is None or not outer.is_measured:
        return False
    (x0, y0, z0), (x1, y1, z1) = around
    px, py, pz = outer.position
    bottom = inner.bottom - pz
    if outer.form.is_sealed:
        return z0 - _ROUNDING <= bottom and inner.top - pz <= z1 + _ROUNDING
    if bottom > z1 + _SLACK_M:
        return False
    if bottom > FLOOR_M:
        return True  # it may stand in a hollow and stick out
    if inner.volume >= outer.volume:
        return False
    if limits.inside_share < 0.5:
        return True
    # A convex hollow with half of the volume of a box contains its centre.
    x, y, z = inner.position
    if inner.is_level and outer.is_level:
        z += inner.size[2] / 2
    else:
        x, y, z = inner.centre
    return (
        x0 - _SLACK_M <= x - px <= x1 + _SLACK_M
        and y0 - _SLACK_M <= y - py <= y1 + _SLACK_M
        and z0 - _SLACK_M <= z - pz <= z1 + _SLACK_M
    )


def hollow_around(inner: Solid, outer: Solid) -> Interior:
    """Return the hollow of `outer` that contains most of the volume. `outer` must have one."""
    return max(outer.hollows, key=lambda hollow: _compute_share_in(inner, outer, hollow))


def _fits(inner: Solid, hollow: Interior) -> bool:
    """Return whether an object can be in a hollow: seen from above, it is not longer or wider.

    One that is not upright may be turned: its two shorter sides count.
    """
    (x0, y0, _), (x1, y1, _) = hollow.low, hollow.high
    narrow, wide = sorted((x1 - x0, y1 - y0))
    thin, broad, *_ = sorted(inner.size[:2] if inner.is_level else inner.size)
    return thin <= FIT * narrow and broad <= FIT * wide


def _is_enclosed(inner: Solid, outer: Solid, hollow: Interior) -> bool:
    """Return whether all corners of an object are in a hollow, which may be round."""
    (x0, y0, z0), (x1, y1, z1) = hollow.low, hollow.high
    px, py, pz = inner.position
    e = _ROUNDING
    for dx, dy, dz in inner.form.corners:
        x, y, z = outer.to_own((px + dx, py + dy, pz + dz))
        if not (x0 - e <= x <= x1 + e and y0 - e <= y <= y1 + e and z0 - e <= z <= z1 + e):
            return False
        if not _is_within_walls(x, y, hollow):
            return False
    return True


def _is_within_walls(x: float, y: float, hollow: Interior) -> bool:
    """Return whether a point in the box of a hollow, in the same frame, is in the hollow."""
    if not hollow.round:
        return True
    (x0, y0, _), (x1, y1, _) = hollow.low, hollow.high
    across, along = (2 * x - x0 - x1) / (x1 - x0), (2 * y - y0 - y1) / (y1 - y0)
    return across * across + along * along <= 1.0


def _compute_share_in(inner: Solid, outer: Solid, hollow: Interior) -> float:
    """Return the share of a volume in a hollow. In a sealed one it is all or nothing."""
    if hollow.is_sealed:
        return float(_is_enclosed(inner, outer, hollow))
    (x0, y0, z0), (x1, y1, z1) = hollow.low, hollow.high
    if not (inner.is_level and outer.is_level):
        points = inner.samples
        found = [outer.to_own(point) for point in points]
        return sum(
            x0 <= x <= x1 and y0 <= y <= y1 and z0 <= z <= z1 and _is_within_walls(x, y, hollow)
            for x, y, z in found
        ) / len(points)
    floor, lid = outer.position[2] + z0, outer.position[2] + z1
    height = min(lid, inner.position[2] + inner.size[2]) - max(floor, inner.position[2])
    if height <= 0.0:
        return 0.0
    if inner.form.is_square and outer.form.is_square and not hollow.round:
        (a0, b0, _), (a1, b1, _) = outer.to_map((x0, y0, 0.0)), outer.to_map((x1, y1, 0.0))
        u0, v0, u1, v1 = inner.bounds
        wide = min(u1, max(a0, a1)) - max(u0, min(a0, a1))
        deep = min(v1, max(b0, b1)) - max(v0, min(b0, b1))
        return wide * deep * height / inner.volume if wide > 0.0 and deep > 0.0 else 0.0
    return area(clipped(inner.outline, outer.outline_of(hollow))) * height / inner.volume


def is_holder(hollow: Interior) -> bool:
    """Return whether a hollow is deeper than that of a tray, so that objects may stick out of it."""
    (x0, y0, z0), (x1, y1, z1) = hollow.low, hollow.high
    return z1 - z0 >= _HOLDER_DEPTH * min(x1 - x0, y1 - y0)


def _compute_base_share_in(inner: Solid, outer: Solid, hollow: Interior, limits: Thresholds) -> float:
    """Return the share of a base that stands in the lower half of a holder; of a leaning one, its foot."""
    z0, z1 = hollow.low[2], hollow.high[2]
    above = inner.bottom - outer.position[2]
    sticks_out = inner.top > outer.position[2] + z1
    if not (sticks_out and is_holder(hollow) and max(FLOOR_M, z0 - limits.gap_m) < above <= (z0 + z1) / 2):
        return 0.0
    if hollow.is_sealed:
        return 0.0
    walls = outer.outline_of(hollow)
    if not inner.is_upright:
        return float(contains(walls, min(inner.parts, key=_get_bottom).lowest))
    whole = area(inner.base)
    if not 0.0 < whole <= area(walls) or _diameter(inner.base) > FIT * _diameter(walls):
        return 0.0
    return area(clipped(inner.base, walls)) / whole


def _diameter(outline: Sequence[Point]) -> float:
    return max(math.dist(*ends) for ends in combinations(outline, 2))


def _get_bottom(part: Convex) -> float:
    return part.low[2]
