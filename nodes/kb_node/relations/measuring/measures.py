"""Measurement of relations between two solids. None means that a relation cannot be measured.

*On* and *in* are grounded in support and containment, not in overlapping boxes (Richard-Bollans et al.
2019).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations
from typing import NamedTuple

from semmap.nodes.geometry.polygons import Point, area, clipped, contains, covers, distance, hull
from semmap.nodes.geometry.regions import Region
from semmap.nodes.kb_node.relations.geometry.convex import Convex, contact, over_flat_top
from semmap.nodes.kb_node.relations.geometry.forms import LOWEST_M, Bounds
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.ontology.model_shapes import Interior

_ROUNDING = 1e-9
"""Tolerance for rounding: 0.80 - 0.75 exceeds 0.05 in floats."""
_SIDEWAYS = math.sin(math.radians(10.0))
"""A contact normal closer to the horizontal than this means that two objects are side by side."""
_FLAT = math.cos(math.radians(2.0))
"""A contact normal this close to the vertical means a flat contact."""
_MOST = 0.5
"""The share of a base above which an object stands in a container."""
FIT = 1.1
"""How much larger than a hollow an object in it may be, because of flared walls and soft objects."""
_HOLDER_DEPTH = 0.2
"""The least depth of a container from which objects stick out, relative to its width."""
BESIDE_M = 0.2
"""The largest horizontal distance at which an object can be attached [m]."""
ALONGSIDE = 0.5
"""The least share of the height of an attached object that is alongside what it is attached to."""
_SLACK_M = 0.01
"""Tolerance of bounds around hollows, because an object that is nearly level counts as level."""
_SAMPLES = 10
"""Samples along each side of a footprint."""
FLOOR_M = 0.002
"""Tolerance between the floor of a hollow and the top that forms it. A floor is thicker."""


_Piece = tuple[Sequence[Point], float, float]
"""An outline, bottom and top [m]."""


class Measure(NamedTuple):
    """Whether a relation holds between two solids, with the measured values."""

    holds: bool
    gap_m: float = 0.0
    """Distance between the two. For *on*: height of the bottom above the surface, negative below it."""
    share: float = 1.0
    """Share of the first one's base, volume or footprint, depending on the relation."""
    height_m: float = 0.0
    """Height of the surface in the map."""
    limit: float = 0.0
    """The greatest gap, or least share, for which the relation holds."""
    by_base: bool = False
    """Whether the share is of the base, for an object that stands in a container and sticks out of it."""


def on(upper: Solid, lower: Solid, limits: Thresholds) -> Measure | None:
    """Return how one solid rests on another: the contact, or near contact, along an upward normal.

    None if there is no contact or the base is not over the other solid. `holds` is False for a solid that
    only leans on the other one, along a steeper normal.
    """
    reach = limits.gap_m + _ROUNDING
    if upper is lower or upper.bottom - lower.top > reach or not overlap(upper.bounds, lower.bounds):
        return None
    # An object put down on another does not end up lower than it: beside is not on.
    most = min(reach, upper.bottom - lower.bottom + limits.contact_m)
    is_level = upper.is_level and lower.is_level
    if is_level and most < 0.0:
        return None
    has_level_tops = is_level and not lower.form.has_slopes
    if has_level_tops and upper.highest_bottom - lower.lowest_top < -reach:
        return None
    most = max(most, limits.contact_m)
    pairs = []
    for part in upper.parts:
        (x0, y0, z0), (x1, y1, z1) = part.low, part.high
        for other in lower.parts:
            (low_x, low_y, low_z), (high_x, high_y, high_z) = other.low, other.high
            least = z0 - high_z
            if least > most or z1 <= low_z or (has_level_tops and least < -reach):
                continue
            if x0 <= high_x and low_x <= x1 and y0 <= high_y and low_y <= y1:
                pairs.append((least, part, other))
    if not pairs:
        return None
    if len(pairs) > 1:
        pairs.sort(key=_by_gap)
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
    share = _compute_covered_share(upper, lower, best.height_m)
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
    """Return how a solid rests on the highest lower top that is under enough of its base, or None.

    The position tolerance is larger than a rim is wide, so an object in a tray may appear to overlap the
    rim.
    """
    for height in tops:
        gap = upper.bottom - height
        if height < rim.height_m - LOWEST_M and gap <= rim.limit:
            share = _compute_covered_share(upper, lower, height)
            if share >= limits.base_share:
                return Measure(True, gap, share, height, rim.limit)
    return None


def is_in_open_hollow(lower: Solid, upper: Solid, made: Measure) -> bool:
    """Return whether a supported solid stands in an open hollow of its support, such as in a tray.

    Then most of its base is over the floor of the hollow, and nothing below the support can support it.
    """
    if not (lower.is_level and upper.volume < lower.volume):
        return False
    whole = area(upper.outline)
    for hollow in lower.form.shape.interiors:
        is_on_floor = abs(lower.position[2] + hollow.low[2] - made.height_m) <= FLOOR_M
        if not (hollow.open and is_on_floor):
            continue
        if area(clipped(upper.outline, lower.outline_of(hollow))) > 0.5 * whole:
            return True
    return False


def _by_gap(pair: tuple[float, object, object]) -> float:
    return pair[0]


def _compute_covered_share(upper: Solid, lower: Solid, height: float) -> float:
    """Return the share of a base over flat tops at this height."""
    supporting = [p for p in lower.parts if p.has_flat_top and abs(p.high[2] - height) <= LOWEST_M]
    for part in supporting:
        if part.is_square and _is_rectangle_within(upper.bounds, (*part.low[:2], *part.high[:2])):
            return 1.0
    if len(supporting) == len(upper.parts) == 1 and supporting[0].is_square and upper.parts[0].is_square:
        return _compute_box_share(upper.parts[0], supporting[0])
    base = upper.base
    tops = [part.projection for part in supporting]
    for top in tops:
        if covers(top, base):
            return 1.0
    whole = area(base)
    return min(1.0, sum(area(clipped(base, top)) for top in tops) / whole) if whole > 0.0 else 0.0


def _compute_box_share(upper: Convex, lower: Convex) -> float:
    """Return the share of an axis-aligned box that is over another one, seen from above."""
    (x0, y0, _), (x1, y1, _) = upper.low, upper.high
    (a0, b0, _), (a1, b1, _) = lower.low, lower.high
    wide, deep = min(x1, a1) - max(x0, a0), min(y1, b1) - max(y0, b0)
    return wide * deep / ((x1 - x0) * (y1 - y0)) if wide > 0.0 and deep > 0.0 else 0.0


def is_balanced(upper: Solid, lower: Iterable[Solid], height: float) -> bool:
    """Return whether the centre of a base is within the hull of its support areas at this height."""
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
    """Return the height of a solid above the nearest surface of another one, or None if it is over none."""
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
    """Return the share of a volume within a hollow of the other solid, in which the object must fit.

    If the object sticks out of a hollow in which it stands, such as an umbrella, it is the share of its
    base. None without a hollow, or if that is smaller.
    """
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


def within(solid: Solid, place: Solid, limits: Thresholds, *, also_places: bool = False) -> Measure | None:
    """Return the share of a footprint within a place, or of a position if the size is unknown.

    None if `place` is not a place with an extent. None also if `solid` is a place, unless with
    `also_places`.
    """
    if not place.is_place or not place.is_measured or (solid.is_place and not also_places):
        return None
    height = solid.centre[2] if solid.is_measured else solid.position[2]
    limit = limits.place_share
    if not place.bottom - limits.gap_m <= height <= place.top + limits.gap_m:
        return Measure(False, share=0.0, limit=limit)
    if place.form.region is not None:
        share = _compute_share_in_region(solid, place, place.form.region)
    elif not solid.is_measured:
        share = float(contains(place.outline, solid.position[:2]))
    elif not overlap(solid.bounds, place.bounds):
        share = 0.0
    elif solid.form.region is not None:
        share = solid.form.region.shared(place.outline, solid.position[:2]) / max(solid.footprint, 1e-9)
    elif (place.form.is_square and _is_rectangle_within(solid.bounds, place.bounds)) or covers(
        place.outline, solid.outline
    ):
        share = 1.0
    else:
        share = area(clipped(solid.outline, place.outline)) / max(area(solid.outline), 1e-9)
    return Measure(share >= limit, share=share, limit=limit)


def _compute_share_in_region(solid: Solid, place: Solid, region: Region) -> float:
    """Return the share of a footprint, or of a position without a size, that a polygon covers."""
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
    """Return the distance of two boxes [m]. Tilted ones are replaced by the upright prisms around them.

    Open doors and drawers count as parts of their own.
    """
    if one.form.joints or other.form.joints:
        return min(_compute_piece_gap(a, b) for a in _list_pieces(one) for b in _list_pieces(other))
    up = max(0.0, one.bottom - other.top, other.bottom - one.top)
    if one.is_place or other.is_place:
        return math.hypot(_compute_plan_gap(one, other), up)
    return math.hypot(distance(one.outline, other.outline), up)


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


def _is_rectangle_within(one: Bounds, other: Bounds) -> bool:
    """Return whether one axis-aligned rectangle is within another."""
    return one[0] >= other[0] and one[1] >= other[1] and one[2] <= other[2] and one[3] <= other[3]


def overlap(one: Bounds, other: Bounds, margin_m: float = 0.0) -> bool:
    """Return whether two axis-aligned rectangles meet or are within a margin."""
    return (
        one[0] - margin_m <= other[2]
        and other[0] - margin_m <= one[2]
        and one[1] - margin_m <= other[3]
        and other[1] - margin_m <= one[3]
    )
