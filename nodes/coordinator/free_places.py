"""Finds positions for entities that are added without one: the free place nearest to a default position.

Objects on the floor are indexed by grid cells, and the progress of the search is stored for each size. A
request therefore costs what has changed since the last one, not the number of objects.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

from semmap.schemas.entities import Entity, Size, Vector

DEFAULT_POSITION: Vector = (2.0, 2.0, 0.0)
_STEP_M = 0.5
_STEPS_A_REACH = 4
"""The step of the search for a large object: its reach divided by this number."""
_GAP_M = 0.1
_UNDERFOOT_M = 0.05
_USUAL_SIZE: Size = (0.5, 0.5, 0.5)
_CELL_M = 1.0
_MANY_CELLS = 1000
"""An object that covers more cells is checked for every place instead of being indexed."""
_MANY_SIZES = 64

Spot = tuple[int, int]
"""A place to try: the number of a ring around the default position, and of a point on the ring."""


class Footprint(NamedTuple):
    """A rectangle on the floor [m]: centre, half extents, and the cosine and sine of its yaw."""

    x: float
    y: float
    half_width: float
    half_depth: float
    cos: float
    sin: float

    @property
    def radius(self) -> float:
        """Radius of the circumscribed circle [m]."""
        return math.hypot(self.half_width, self.half_depth)

    def distance(self, x: float, y: float) -> float:
        """Return the distance from a point [m], 0 inside."""
        dx, dy = x - self.x, y - self.y
        along = abs(self.cos * dx + self.sin * dy) - self.half_width
        across = abs(self.cos * dy - self.sin * dx) - self.half_depth
        return math.hypot(max(0.0, along), max(0.0, across))


class FreePlaces:
    """The objects on the floor of a map, and the free places between them."""

    def __init__(self) -> None:
        self._changed: set[str] = set()
        self._footprints: dict[str, Footprint] = {}
        self._cells: dict[Spot, dict[str, Footprint]] = {}
        self._large: dict[str, Footprint] = {}
        self._searches: dict[float, _Search] = {}
        """Searches by the reach of an object [m]."""

    def touch(self, names: Iterable[str]) -> None:
        """Note that entities were added, changed or removed; they are processed at the next request."""
        self._changed.update(names)

    def find(self, entities: Mapping[str, Entity], size_m: Size | None) -> Vector:
        """Return the place nearest to the default position where an object of `size_m` touches nothing.

        `entities` are those of the map. All changes since the last call were passed to `touch`.
        """
        self._catch_up(entities)
        width, depth, _ = size_m or _USUAL_SIZE
        reach_m = math.hypot(width, depth) / 2.0 + _GAP_M
        if len(self._searches) >= _MANY_SIZES and reach_m not in self._searches:
            self._searches.clear()
        search = self._searches.setdefault(reach_m, _Search(reach_m))
        positions = map(search.position, search.spots())
        x, y = next((x, y) for x, y in positions if self._is_free(x, y, reach_m))
        return (round(x, 3) + 0.0, round(y, 3) + 0.0, DEFAULT_POSITION[2])

    def _catch_up(self, entities: Mapping[str, Entity]) -> None:
        changed, self._changed = self._changed, set()
        for name in changed:
            entity = entities.get(name)
            now = _footprint(entity) if entity is not None else None
            was = self._footprints.get(name)
            if now == was:
                continue
            if was is not None:
                self._forget(name, was)
            if now is not None:
                self._note(name, now)

    def _note(self, name: str, footprint: Footprint) -> None:
        self._footprints[name] = footprint
        cells = _cells(footprint.x, footprint.y, footprint.radius)
        if cells is None:
            self._large[name] = footprint
            return
        for cell in cells:
            self._cells.setdefault(cell, {})[name] = footprint

    def _forget(self, name: str, footprint: Footprint) -> None:
        del self._footprints[name]
        if self._large.pop(name, None) is None:
            for cell in _cells(footprint.x, footprint.y, footprint.radius) or ():
                self._cells[cell].pop(name)
        for search in self._searches.values():
            search.release(footprint)

    def _is_free(self, x: float, y: float, reach_m: float) -> bool:
        if any(large.distance(x, y) <= reach_m for large in self._large.values()):
            return False
        cells = _cells(x, y, reach_m)
        if cells is None:  # a very large object
            return all(f.distance(x, y) > reach_m for f in self._footprints.values())
        return all(
            footprint.distance(x, y) > reach_m
            for cell in cells
            for footprint in self._cells.get(cell, {}).values()
        )


class _Search:
    """The progress of the search for one size; only some of the earlier places may be free again."""

    def __init__(self, reach_m: float) -> None:
        self._reach_m = reach_m
        self._step_m = max(_STEP_M, reach_m / _STEPS_A_REACH)
        self._next: Spot = (0, 0)
        self._freed: list[Spot] = []

    def spots(self) -> Iterator[Spot]:
        """Yield the places that may be free, nearest first; requesting the next marks the last occupied."""
        while self._freed:
            yield self._freed[0]
            heapq.heappop(self._freed)
        while True:
            yield self._next
            ring, point = self._next
            self._next = (ring, point + 1) if point + 1 < _points(ring) else (ring + 1, 0)

    def position(self, spot: Spot) -> tuple[float, float]:
        """Return the position of a place [m]."""
        ring, point = spot
        angle = 2.0 * math.pi * point / _points(ring)
        x, y, _ = DEFAULT_POSITION
        radius = ring * self._step_m
        return x + radius * math.cos(angle), y + radius * math.sin(angle)

    def release(self, footprint: Footprint) -> None:
        """Try the places again that a removed object had occupied."""
        dx, dy = footprint.x - DEFAULT_POSITION[0], footprint.y - DEFAULT_POSITION[1]
        away, around = math.hypot(dx, dy), footprint.radius + self._reach_m
        first = max(0, math.ceil((away - around) / self._step_m))
        last = min(self._next[0], math.floor((away + around) / self._step_m))
        for ring in range(first, last + 1):
            for point in _facing(math.atan2(dy, dx), away, around, _points(ring)):
                if (ring, point) < self._next:
                    heapq.heappush(self._freed, (ring, point))


def _points(ring: int) -> int:
    return max(1, 8 * ring)


def _facing(angle: float, away_m: float, around_m: float, count: int) -> Iterator[int]:
    """Yield the points of a ring in the directions of a circle."""
    if away_m <= around_m:
        return iter(range(count))
    half = math.asin(around_m / away_m)
    low = math.floor((angle - half) / (2.0 * math.pi) * count)
    high = math.ceil((angle + half) / (2.0 * math.pi) * count)
    return iter({point % count for point in range(low, high + 1)})


def _footprint(entity: Entity) -> Footprint | None:
    """Return the footprint; None for places and for flat objects such as rugs, on which others may stand."""
    if entity.pose is None or entity.place:
        return None
    if entity.size_m is not None and entity.size_m[2] < _UNDERFOOT_M:
        return None
    x, y, _ = entity.pose.position_m
    width, depth, _ = entity.size_m or _USUAL_SIZE
    yaw = entity.pose.yaw_rad
    return Footprint(x, y, width / 2.0, depth / 2.0, math.cos(yaw), math.sin(yaw))


def _cells(x: float, y: float, radius_m: float) -> list[Spot] | None:
    """Return the cells within a distance; None if they are too many."""
    left, right = (math.floor((x + side * radius_m) / _CELL_M) for side in (-1, 1))
    bottom, top = (math.floor((y + side * radius_m) / _CELL_M) for side in (-1, 1))
    if (right - left + 1) * (top - bottom + 1) > _MANY_CELLS:
        return None
    return [(i, j) for i in range(left, right + 1) for j in range(bottom, top + 1)]
