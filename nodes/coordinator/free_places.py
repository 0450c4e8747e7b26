"""Positions for entities that are added without one: the nearest to a default position that is free.

What stands on the floor is kept in cells, and how far the search came for each size, so that an answer costs
what has changed since the last one, not what there is.
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
"""A big thing is tried at fewer places: so many as far as it reaches."""
_GAP_M = 0.1
_UNDERFOOT_M = 0.05
_USUAL_SIZE: Size = (0.5, 0.5, 0.5)
_CELL_M = 1.0
_MANY_CELLS = 1000
"""What covers more cells is looked at for every place, instead of being noted in each."""
_MANY_SIZES = 64

Spot = tuple[int, int]
"""A place that is tried: of a ring around the default position, by its number, and of the points of that."""


class Footprint(NamedTuple):
    """A rectangle on the floor [m]: its middle, half its extents, and the cosine and sine of its yaw."""

    x: float
    y: float
    half_width: float
    half_depth: float
    cos: float
    sin: float

    @property
    def radius(self) -> float:
        """Of the circle around it."""
        return math.hypot(self.half_width, self.half_depth)

    def distance(self, x: float, y: float) -> float:
        """From a point, 0 inside."""
        dx, dy = x - self.x, y - self.y
        along = abs(self.cos * dx + self.sin * dy) - self.half_width
        across = abs(self.cos * dy - self.sin * dx) - self.half_depth
        return math.hypot(max(0.0, along), max(0.0, across))


class FreePlaces:
    """What stands on the floor of a map, and where there is room."""

    def __init__(self) -> None:
        self._changed: set[str] = set()
        self._footprints: dict[str, Footprint] = {}
        self._cells: dict[Spot, dict[str, Footprint]] = {}
        self._large: dict[str, Footprint] = {}
        self._searches: dict[float, _Search] = {}
        """By how far a thing reaches."""

    def touch(self, names: Iterable[str]) -> None:
        """Entities came, changed or went. Nothing is worked out until somebody asks."""
        self._changed.update(names)

    def find(self, entities: Mapping[str, Entity], size_m: Size | None) -> Vector:
        """The place nearest to the default position where a thing of `size_m` touches nothing.

        `entities` are those of the map; all that changed since the last question was `touch`ed.
        """
        self._catch_up(entities)
        width, depth, _ = size_m or _USUAL_SIZE
        reach_m = math.hypot(width, depth) / 2.0 + _GAP_M
        if len(self._searches) >= _MANY_SIZES and reach_m not in self._searches:
            self._searches.clear()
        search = self._searches.setdefault(reach_m, _Search(reach_m))
        for spot in search.spots():
            x, y = search.position(spot)
            if self._is_free(x, y, reach_m):
                return (round(x, 3) + 0.0, round(y, 3) + 0.0, DEFAULT_POSITION[2])
        raise AssertionError("the rings are endless")

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
        if cells is None:  # a very big thing
            return all(f.distance(x, y) > reach_m for f in self._footprints.values())
        return all(
            footprint.distance(x, y) > reach_m
            for cell in cells
            for footprint in self._cells.get(cell, {}).values()
        )


class _Search:
    """How far the search for places of one size came: of the spots before, only some may be free."""

    def __init__(self, reach_m: float) -> None:
        self._reach_m = reach_m
        self._step_m = max(_STEP_M, reach_m / _STEPS_A_REACH)
        self._next: Spot = (0, 0)
        self._freed: list[Spot] = []

    def spots(self) -> Iterator[Spot]:
        """Those that may be free, the nearest first; going on says that the last one is not."""
        while self._freed:
            yield self._freed[0]
            heapq.heappop(self._freed)
        while True:
            yield self._next
            ring, point = self._next
            self._next = (ring, point + 1) if point + 1 < _points(ring) else (ring + 1, 0)

    def position(self, spot: Spot) -> tuple[float, float]:
        """Where a spot is [m]."""
        ring, point = spot
        angle = 2.0 * math.pi * point / _points(ring)
        x, y, _ = DEFAULT_POSITION
        radius = ring * self._step_m
        return x + radius * math.cos(angle), y + radius * math.sin(angle)

    def release(self, footprint: Footprint) -> None:
        """Something no longer stands there: the spots that it kept from being free are tried again."""
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
    """Of so many points of a ring, those in the directions in which a circle lies."""
    if away_m <= around_m:
        return iter(range(count))
    half = math.asin(around_m / away_m)
    low = math.floor((angle - half) / (2.0 * math.pi) * count)
    high = math.ceil((angle + half) / (2.0 * math.pi) * count)
    return iter({point % count for point in range(low, high + 1)})


def _footprint(entity: Entity) -> Footprint | None:
    """None for what is not in the way: places, and rugs and the like, on which things may stand."""
    if entity.pose is None or entity.place:
        return None
    if entity.size_m is not None and entity.size_m[2] < _UNDERFOOT_M:
        return None
    x, y, _ = entity.pose.position_m
    width, depth, _ = entity.size_m or _USUAL_SIZE
    yaw = entity.pose.yaw_rad
    return Footprint(x, y, width / 2.0, depth / 2.0, math.cos(yaw), math.sin(yaw))


def _cells(x: float, y: float, radius_m: float) -> list[Spot] | None:
    """The cells within a distance; None if they are too many."""
    left, right = (math.floor((x + side * radius_m) / _CELL_M) for side in (-1, 1))
    bottom, top = (math.floor((y + side * radius_m) / _CELL_M) for side in (-1, 1))
    if (right - left + 1) * (top - bottom + 1) > _MANY_CELLS:
        return None
    return [(i, j) for i in range(left, right + 1) for j in range(bottom, top + 1)]
