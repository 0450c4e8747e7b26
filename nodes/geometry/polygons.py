"""Convex polygons on the floor plan: lists of (x, y) [m], counterclockwise."""

from __future__ import annotations

import math
from collections.abc import Sequence

Point = tuple[float, float]
Polygon = Sequence[Point]


def area(polygon: Polygon) -> float:
    """Return the area [m^2]; 0 for fewer than three corners."""
    doubled = 0.0
    x0, y0 = polygon[-1] if polygon else (0.0, 0.0)
    for x, y in polygon:
        doubled += x0 * y - x * y0
        x0, y0 = x, y
    return doubled / 2.0


def hull(points: Sequence[Point]) -> list[Point]:
    """Return the convex hull (Andrew's monotone chain)."""
    ordered = sorted(set(points))
    if len(ordered) < 3:
        return ordered
    chains: list[list[Point]] = []
    for run in (ordered, ordered[::-1]):
        chain: list[Point] = []
        for x, y in run:
            while len(chain) > 1:
                (ax, ay), (bx, by) = chain[-2], chain[-1]
                if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0:
                    break
                chain.pop()
            chain.append((x, y))
        chains.append(chain[:-1])
    return chains[0] + chains[1]


def clipped(subject: Polygon, by: Polygon) -> list[Point]:
    """Return the intersection of two convex polygons (Sutherland and Hodgman 1974)."""
    rest = list(subject)
    ax, ay = by[-1]
    for bx, by_ in by:
        if not rest:
            break
        ex, ey = bx - ax, by_ - ay
        sides = [ex * (y - ay) - ey * (x - ax) for x, y in rest]
        kept: list[Point] = []
        (px, py), before = rest[-1], sides[-1]
        for (x, y), side in zip(rest, sides, strict=True):
            if (before < 0.0) != (side < 0.0):
                share = before / (before - side)
                kept.append((px + share * (x - px), py + share * (y - py)))
            if side >= 0.0:
                kept.append((x, y))
            px, py, before = x, y, side
        rest = kept
        ax, ay = bx, by_
    return rest


def distance(a: Polygon, b: Polygon) -> float:
    """Return the distance of two convex polygons [m]; 0 if they meet."""
    if len(a) > 2 and len(b) > 2 and (contains(a, b[0]) or contains(b, a[0])):
        return 0.0
    least = math.inf
    for one, other in ((a, b), (b, a)):
        for point in one:
            x0, y0 = other[-1]
            for x, y in other:
                least = min(least, _from_segment(point, x0, y0, x, y))
                x0, y0 = x, y
    if least > 0.0 and len(a) > 2 and len(b) > 2 and clipped(a, b):
        return 0.0
    return least


def contains(polygon: Polygon, point: Point) -> bool:
    """Return whether a point lies in a convex polygon, including its border."""
    px, py = point
    ax, ay = polygon[-1]
    for bx, by in polygon:
        if (bx - ax) * (py - ay) - (by - ay) * (px - ax) < 0.0:
            return False
        ax, ay = bx, by
    return True


def covers(polygon: Polygon, points: Polygon) -> bool:
    """Return whether all points lie in a convex polygon, including its border."""
    ax, ay = polygon[-1]
    for bx, by in polygon:
        ex, ey = bx - ax, by - ay
        for px, py in points:
            if ex * (py - ay) - ey * (px - ax) < 0.0:
                return False
        ax, ay = bx, by
    return True


def _from_segment(point: Point, ax: float, ay: float, bx: float, by: float) -> float:
    px, py = point
    dx, dy = bx - ax, by - ay
    length = dx * dx + dy * dy
    share = 0.0 if length == 0.0 else min(1.0, max(0.0, ((px - ax) * dx + (py - ay) * dy) / length))
    return math.hypot(px - ax - share * dx, py - ay - share * dy)
