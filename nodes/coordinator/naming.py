"""Positions for entities that are added without one."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from schemas.entities import Entity, Size, Vector

DEFAULT_POSITION: Vector = (2.0, 2.0, 0.0)
_STEP_M = 0.5
_STEPS_A_REACH = 4
"""A big thing is tried at fewer places: so many as far as it reaches."""
_GAP_M = 0.1
_UNDERFOOT_M = 0.05
_USUAL_SIZE: Size = (0.5, 0.5, 0.5)

Floats = NDArray[np.float64]


def free_position(entities: Iterable[Entity], size_m: Size | None) -> Vector:
    """The place nearest to the default position where a thing of `size_m` touches nothing."""
    footprints = np.array([_footprint(e) for e in entities if e.pose is not None and _is_in_the_way(e)])
    width, depth, _ = size_m or _USUAL_SIZE
    reach_m = math.hypot(width, depth) / 2.0 + _GAP_M
    footprints = footprints.reshape(-1, 6)
    from_middle_m = np.hypot(*(footprints[:, :2] - DEFAULT_POSITION[:2]).T)
    extent_m = np.hypot(footprints[:, 2], footprints[:, 3]) + reach_m
    for radius_m, ring in _rings(max(_STEP_M, reach_m / _STEPS_A_REACH)):
        near = footprints[np.abs(from_middle_m - radius_m) <= extent_m]
        free = _distances_m(ring, near).min(axis=1, initial=np.inf) > reach_m
        if free.any():
            x, y = ring[free.argmax()].round(3)
            return (float(x), float(y), DEFAULT_POSITION[2])
    raise AssertionError("the rings are endless")


def _is_in_the_way(entity: Entity) -> bool:
    """Places are not, nor are rugs and the like: things may stand on them."""
    return not entity.place and (entity.size_m is None or entity.size_m[2] >= _UNDERFOOT_M)


def _footprint(entity: Entity) -> tuple[float, ...]:
    """Its middle x, y, half its width and depth, and the cosine and sine of its yaw."""
    assert entity.pose is not None
    x, y, _ = entity.pose.position_m
    width, depth, _ = entity.size_m or _USUAL_SIZE
    return (x, y, width / 2.0, depth / 2.0, math.cos(entity.pose.yaw_rad), math.sin(entity.pose.yaw_rad))


def _distances_m(points: Floats, footprints: Floats) -> Floats:
    """(N, M) from N points (N, 2) of the floor to M footprints (M, 6), 0 inside."""
    x, y, half_width, half_depth, c, s = footprints.T
    dx, dy = points[:, :1] - x, points[:, 1:] - y
    along, across = np.abs(c * dx + s * dy) - half_width, np.abs(c * dy - s * dx) - half_depth
    return np.asarray(np.hypot(np.maximum(0.0, along), np.maximum(0.0, across)))


def _rings(step_m: float) -> Iterator[tuple[float, Floats]]:
    """Radius and points (N, 2) of rings around the default position, `step_m` apart; the first is a point."""
    middle = np.array(DEFAULT_POSITION[:2])
    for ring in itertools.count():
        angles = np.linspace(0.0, 2.0 * np.pi, max(1, 8 * ring), endpoint=False)
        yield ring * step_m, middle + ring * step_m * np.column_stack([np.cos(angles), np.sin(angles)])
