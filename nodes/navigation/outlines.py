"""The outlines of masks as simple polygons with few corners."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from semmap.nodes.navigation.grid import Mask
from semmap.schemas.errors import BadRequest
from semmap.schemas.polygons import Point, Polygon, signed_area, simple

_OFF: Final = (1.1, 0.8, 0.5, 0.0)
"""Tolerances of simplification in cells, tried in order until the border does not cross itself."""
_MOST_OFF: Final = 8.0
_LEAST_HOLE_M2: Final = 1.0


def outline_of(mask: Mask, resolution: float) -> Polygon | None:
    """Return the polygon around the largest piece of a mask [m]; the corner of the first cell is (0, 0).

    The polygon is simplified with a tolerance of about one cell. Returns None for an empty mask.
    """
    rings = _rings(mask)
    if not rings:
        return None
    outer = max(rings, key=signed_area)
    inner = [ring for ring in rings if -signed_area(ring) * resolution**2 >= _LEAST_HOLE_M2]
    within = [ring for ring in inner if Polygon(tuple(outer)).contains(ring[0])]
    off = 1.1
    tries = [*_OFF, *(off * 2.0**k for k in range(1, 4))]
    for tolerance in tries:
        found = [_scaled(_simplified(ring, tolerance), resolution) for ring in (outer, *within)]
        try:
            return simple([found[0], *(ring for ring in found[1:] if len(ring) > 2)])
        except BadRequest:
            continue
    xs, ys = zip(*outer, strict=True)  # too ragged for any tolerance: the box around it
    box = [(min(xs), min(ys)), (max(xs), min(ys)), (max(xs), max(ys)), (min(xs), max(ys))]
    return simple([_scaled(box, resolution)])


def _rings(mask: Mask) -> list[list[Point]]:
    """Return the borders along the sides of cells, with the mask on the left; corners are (column, row)."""
    padded = np.pad(mask, 1)
    following: dict[tuple[int, int], list[tuple[int, int]]] = {}
    inside = padded[1:-1, 1:-1]

    def add(cells: Mask, start: tuple[int, int], end: tuple[int, int]) -> None:
        for row, column in zip(*(axis.tolist() for axis in np.nonzero(cells)), strict=True):
            a = (column + start[0], row + start[1])
            following.setdefault(a, []).append((column + end[0], row + end[1]))

    add(inside & ~padded[:-2, 1:-1], (0, 0), (1, 0))
    add(inside & ~padded[1:-1, 2:], (1, 0), (1, 1))
    add(inside & ~padded[2:, 1:-1], (1, 1), (0, 1))
    add(inside & ~padded[1:-1, :-2], (0, 1), (0, 0))
    rings: list[list[Point]] = []
    while following:
        start = min(following)
        ring: list[Point] = [start]
        came = (0, 0)
        at = start
        while True:
            next_corners = following[at]
            if len(next_corners) > 1:  # two cells touch at a corner: stay with the same cell
                left = (-came[1], came[0])
                turn = (at[0] + left[0], at[1] + left[1])
                next_corners.sort(key=turn.__ne__)
            to = next_corners.pop(0)
            if not next_corners:
                del following[at]
            came = (to[0] - at[0], to[1] - at[1])
            at = to
            if at == start:
                break
            ring.append(at)
        rings.append(_straight(ring))
    return rings


def _straight(ring: list[Point]) -> list[Point]:
    """Remove corners on straight lines."""
    kept = []
    for k, (x, y) in enumerate(ring):
        (ax, ay), (bx, by) = ring[k - 1], ring[(k + 1) % len(ring)]
        if (x - ax) * (by - y) != (y - ay) * (bx - x):
            kept.append((x, y))
    return kept


def _simplified(ring: list[Point], tolerance: float) -> list[Point]:
    """Simplify a ring (Douglas and Peucker 1973), split at its two most distant corners."""
    if tolerance <= 0.0 or len(ring) < 5:
        return ring
    first = min(range(len(ring)), key=lambda k: ring[k])
    second = max(range(len(ring)), key=lambda k: (math.dist(ring[k], ring[first]), k))
    turned = ring[first:] + ring[:first]
    split = (second - first) % len(ring)
    there = _thinned(turned[: split + 1], tolerance)
    back = _thinned([*turned[split:], turned[0]], tolerance)
    return there[:-1] + back[:-1]


def _thinned(line: list[Point], tolerance: float) -> list[Point]:
    points = np.array(line, dtype=np.float64)
    keep = np.zeros(len(line), dtype=bool)
    keep[[0, -1]] = True
    waiting = [(0, len(line) - 1)]
    while waiting:
        low, high = waiting.pop()
        if high - low < 2:
            continue
        direction = points[high] - points[low]
        offset = points[low + 1 : high] - points[low]
        length = float(np.hypot(*direction))
        if length == 0.0:
            away = np.hypot(offset[:, 0], offset[:, 1])
        else:
            away = np.abs(direction[0] * offset[:, 1] - direction[1] * offset[:, 0]) / length
        furthest = int(away.argmax())
        if away[furthest] > tolerance:
            middle = low + 1 + furthest
            keep[middle] = True
            waiting += [(low, middle), (middle, high)]
    return [point for point, kept in zip(line, keep.tolist(), strict=True) if kept]


def _scaled(ring: list[Point], resolution: float) -> list[Point]:
    return [(x * resolution, y * resolution) for x, y in ring]
