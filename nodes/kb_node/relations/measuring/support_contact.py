"""How an object rests on another one: contacts along upward normals, and the share of its base."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from semmap.nodes.geometry.polygons import area, clipped, contains, covers, hull
from semmap.nodes.kb_node.relations.geometry.convex import Convex, contact, over_flat_top
from semmap.nodes.kb_node.relations.geometry.forms import LOWEST_M
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring.containment import FLOOR_M
from semmap.nodes.kb_node.relations.measuring.measures import Measure, is_rectangle_within, overlap
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds

_ROUNDING = 1e-9
"""Tolerance for rounding: 0.80 - 0.75 exceeds 0.05 in floats."""
_SIDEWAYS = math.sin(math.radians(10.0))
"""A contact normal closer to the horizontal than this means that two objects are side by side."""
_FLAT = math.cos(math.radians(2.0))
"""A contact normal this close to the vertical means a flat contact."""


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
        if part.is_square and is_rectangle_within(upper.bounds, (*part.low[:2], *part.high[:2])):
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
