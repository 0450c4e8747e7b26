"""Places for what comes without."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from schemas.entities import Entity, Size, Vector

DEFAULT_POSITION: Vector = (2.0, 2.0, 0.0)
_STEP_M = 0.5
_GAP_M = 0.1
_UNDERFOOT_M = 0.05
_USUAL_SIZE: Size = (0.5, 0.5, 0.5)


def free_position(entities: Iterable[Entity], size_m: Size | None) -> Vector:
    """The place nearest to the default position where a thing of `size_m` touches nothing."""
    standing = [e for e in entities if e.pose is not None and not e.place and not _is_underfoot(e)]
    width, depth, _ = size_m or _USUAL_SIZE
    reach_m = math.hypot(width, depth) / 2.0 + _GAP_M
    for x, y in _spiral():
        if all(_distance_m(x, y, entity) > reach_m for entity in standing):
            return (x, y, DEFAULT_POSITION[2])
    raise AssertionError("the spiral is endless")


def _is_underfoot(entity: Entity) -> bool:
    """Rugs and the like: things may stand on them."""
    return entity.size_m is not None and entity.size_m[2] < _UNDERFOOT_M


def _distance_m(x: float, y: float, entity: Entity) -> float:
    """From a point of the floor to the footprint of an entity, 0 inside it."""
    assert entity.pose is not None
    width, depth, _ = entity.size_m or _USUAL_SIZE
    dx, dy = x - entity.pose.position_m[0], y - entity.pose.position_m[1]
    c, s = math.cos(entity.pose.yaw_rad), math.sin(entity.pose.yaw_rad)
    along, across = abs(c * dx + s * dy), abs(c * dy - s * dx)
    return math.hypot(max(0.0, along - width / 2.0), max(0.0, across - depth / 2.0))


def _spiral() -> Iterator[tuple[float, float]]:
    """Points around the default position, ring by ring."""
    x0, y0, _ = DEFAULT_POSITION
    yield x0, y0
    ring = 1
    while True:
        for k in range(8 * ring):
            angle = 2.0 * math.pi * k / (8 * ring)
            yield (
                round(x0 + ring * _STEP_M * math.cos(angle), 3),
                round(y0 + ring * _STEP_M * math.sin(angle), 3),
            )
        ring += 1
