"""Placement of objects on a table or floor: loose, close together, or pushed together."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.sim_node.models.parts import Vec3

_PUSHED = 0.6  # of the crowded tables have their things pushed together until they touch
_SQUARE = 0.6  # of these have all things in the directions of one grid
_PUSHES = 6
_FAR_M, _STEP_M, _HALVINGS = 1.6, 0.02, 6

Rectangle = tuple[float, float, float, float, float]
"""Middle x and y, extents along its own x and y [m], yaw [rad]."""


def overlap(a: Rectangle, b: Rectangle, gap_m: float) -> bool:
    """Return whether two rectangles are closer than `gap_m`."""
    offset = np.array([b[0] - a[0], b[1] - a[1]])
    if math.hypot(*offset) > (math.hypot(*a[2:4]) + math.hypot(*b[2:4])) / 2 + gap_m:
        return False
    axes = np.array(
        [(math.cos(yaw + turn), math.sin(yaw + turn)) for yaw in (a[4], b[4]) for turn in (0.0, math.pi / 2)]
    )
    reach = sum(
        np.abs(axes @ (math.cos(r[4] + turn), math.sin(r[4] + turn))) * extent / 2
        for r in (a, b)
        for turn, extent in ((0.0, r[2]), (math.pi / 2, r[3]))
    )
    return bool(np.all(np.abs(axes @ offset) < reach + gap_m))


def spread(
    sizes: Sequence[Vec3],
    area_m: tuple[float, float],
    gap_m: float,
    rng: np.random.Generator,
    *,
    crowded: bool = False,
) -> list[Rectangle | None]:
    """Return a free placement around the origin for each thing, or None if there is no room.

    Crowded things are as close to the others as `gap_m` allows, or are pushed together.
    """
    if crowded and rng.random() < _PUSHED:
        return _pushed(sizes, area_m, float(rng.uniform(0.0, 0.004)), rng)
    taken: list[Rectangle] = []
    placements: list[Rectangle | None] = []
    for x, y, _ in sizes:
        free: list[Rectangle] = []
        for _ in range(60 if crowded else 25):
            at = rng.uniform(-0.5, 0.5, 2) * (np.array(area_m) - 0.7 * max(x, y))
            placement = (float(at[0]), float(at[1]), x, y, float(rng.uniform(-math.pi, math.pi)))
            if not any(overlap(placement, other, gap_m) for other in taken):
                free.append(placement)
                if not crowded:
                    break
        best = min(free, key=lambda placement: _nearest(placement, taken), default=None)
        placements.append(best)
        if best is not None:
            taken.append(best)
    return placements


def _pushed(
    sizes: Sequence[Vec3], area_m: tuple[float, float], gap_m: float, rng: np.random.Generator
) -> list[Rectangle | None]:
    """Move each thing from a random direction towards the middle until it touches another."""
    taken: list[Rectangle] = []
    placements: list[Rectangle | None] = []
    grid, square = float(rng.uniform(-math.pi, math.pi)), rng.random() < _SQUARE
    for x, y, _ in sizes:
        best = None
        for _try in range(_PUSHES):
            yaw = float(grid + rng.integers(4) * math.pi / 2 if square else rng.uniform(-math.pi, math.pi))
            azimuth = rng.uniform(-math.pi, math.pi)
            way = np.array([math.cos(azimuth), math.sin(azimuth)])
            placement = _until_it_touches((x, y, yaw), rng.normal(0.0, 0.08, 2), way, taken, gap_m)
            if (np.abs(placement[:2]) < np.array(area_m) / 2 - 0.3 * max(x, y)).all():
                best = placement
                taken.append(placement)
                break
        placements.append(best)
    return placements


def _until_it_touches(
    thing: tuple[float, float, float],
    aim_m: NDArray[np.float64],
    way: NDArray[np.float64],
    taken: Sequence[Rectangle],
    gap_m: float,
) -> Rectangle:
    """Return the position at which a moving thing (extents, yaw) stops: at the aim (2,) or before another."""
    x, y, yaw = thing

    def at(distance_m: float) -> Rectangle:
        u, v = (aim_m + distance_m * way).tolist()
        return (u, v, x, y, yaw)

    def free(distance_m: float) -> bool:
        return not any(overlap(at(distance_m), other, gap_m) for other in taken)

    if free(0.0):
        return at(0.0)
    met = _FAR_M
    while met > 0.0 and free(met):
        met -= _STEP_M
    clear = met + _STEP_M
    for _ in range(_HALVINGS):
        middle = (met + clear) / 2
        met, clear = (met, middle) if free(middle) else (middle, clear)
    return at(clear)


def _nearest(placement: Rectangle, others: Sequence[Rectangle]) -> float:
    return min((math.dist(placement[:2], other[:2]) for other in others), default=0.0)
