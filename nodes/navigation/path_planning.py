"""Path planning over places and through doors, with the reason if there is no path."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np

from semmap.nodes.geometry.polygons import Point
from semmap.nodes.navigation import grid as grids
from semmap.nodes.navigation.grid import Frame, Mask
from semmap.nodes.navigation.search import Cell, shortest_path, without_detours
from semmap.schemas import errors
from semmap.schemas.plans import HeightRange, Plan, PlannedPlace, PlannedThing, Way

_RESOLUTION_M: Final = 0.05
_MOST_CELLS: Final = 400_000
"""A larger grid would take seconds, so a large map has larger cells."""
_COARSEST_M: Final = 0.2
"""Doors are narrower than larger cells."""
_END_DISTANCE_M: Final = 0.4
"""Maximum distance to a thing at the end of a path, in addition to the robot's radius."""
_POSITION_TOLERANCE_M: Final = 0.5
"""Maximum distance from a requested position without room for the robot."""
_POSITION = re.compile(r"\(?\s*(-?[\d.]+(?:e-?\d+)?)\s*[,\s]\s*(-?[\d.]+(?:e-?\d+)?)\s*\)?", re.IGNORECASE)


def parse_position(word: str) -> Point | None:
    """Parse a position such as `2.5,1`; return None for a name."""
    match = _POSITION.fullmatch(word.strip())
    if match is None:
        return None
    try:
        return float(match[1]), float(match[2])
    except ValueError:
        return None


@dataclass(frozen=True)
class PathEnd:
    """An end of a path: the cells that count as reached, and its name."""

    name: str
    cells: tuple[Cell, ...]


class TraversabilityMap:
    """The free space of a plan for a robot of a radius, optionally without some kinds of obstacles."""

    def __init__(self, plan: Plan, radius_m: float, heights: HeightRange) -> None:
        """Compute the masks. Raises Refused for an empty or too large plan."""
        self.plan, self.radius_m, self.heights = plan, radius_m, heights
        self.frame = _frame(plan)
        solid = ~grids.floor_mask(plan, self.frame) | grids.wall_mask(plan, self.frame, heights)
        built = [thing for thing in plan.things if thing.class_ in ("Wall", "Window", "Stairs")]
        self._walls = self._inflated(solid | grids.things_mask(plan, self.frame, heights, built))
        others = [t for t in plan.things if not t.door and t not in built]
        self._things = self._inflated(grids.things_mask(plan, self.frame, heights, others))
        self._forbidden = self._inflated(grids.forbidden_mask(plan, self.frame))
        self.closed = [thing for thing in plan.things if thing.door and thing.open is False]
        self._doors = self.frame.mask()
        for door in self.closed:
            self.frame.add_convex(self._doors, grids.doorway(door))
        self.rooms = grids.rooms_by_cell(plan, self.frame)

    def _inflated(self, mask: Mask) -> Mask:
        """Inflate a mask by the robot's radius."""
        return grids.inflated(mask, self.radius_m, self.frame.resolution)

    def free_mask(
        self, *, through_closed: bool = False, through_forbidden: bool = False, through_things: bool = False
    ) -> Mask:
        """Return where the centre of the robot may be."""
        free = ~self._walls
        if not through_closed:
            free &= ~self._doors
        if not through_forbidden:
            free &= ~self._forbidden
        if not through_things:
            free &= ~self._things
        return free

    def end_at_position(self, at: Point, free: Mask) -> PathEnd:
        """Return a position, or the nearest one with room for the robot. Raises Refused."""
        name = f"({at[0]:g}, {at[1]:g})"
        found = self._nearest(free, at, _POSITION_TOLERANCE_M)
        if found is None:
            raise errors.Refused(
                f"there is no room for {self._robot()} at {name}: {self._explain_no_room(at)}"
            )
        return PathEnd(name, (found,))

    def end_at_place(self, place: PlannedPlace, free: Mask) -> PathEnd:
        """Return the free cell of a place that is nearest to its centre. Raises Refused."""
        mask = self.frame.mask()
        self.frame.add_rings(mask, place.rings)
        xs, ys = zip(*place.rings[0], strict=True)
        middle = ((min(xs) + max(xs)) / 2.0, (min(ys) + max(ys)) / 2.0)
        found = self._nearest(free & mask, middle, math.inf)
        if found is None:
            raise errors.Refused(f"there is no room for {self._robot()} in {place.name}")
        return PathEnd(place.name, (found,))

    def end_beside(self, thing: PlannedThing, free: Mask) -> PathEnd:
        """Return all free cells next to a thing, in its room. Raises Refused."""
        near = self.frame.mask()
        outline = thing.footprint
        if len(outline) < 3:
            raise errors.Refused(f"{thing.name} has no size; cannot compute a route next to it")
        self.frame.add_convex(near, outline)
        own_rooms = set(np.unique(self.rooms[near]).tolist()) - {-1}
        near = grids.inflated(near, self.radius_m + _END_DISTANCE_M, self.frame.resolution)
        if own_rooms and not thing.door:
            near &= np.isin(self.rooms, list(own_rooms))
        rows, columns = np.nonzero(near & free)
        if not len(rows):
            raise errors.Refused(f"there is no room for {self._robot()} beside {thing.name}")
        return PathEnd(thing.name, tuple(zip(rows.tolist(), columns.tolist(), strict=True)))

    def _nearest(self, free: Mask, at: Point, most_m: float) -> Cell | None:
        rows, columns = np.nonzero(free)
        if not len(rows):
            return None
        frame = self.frame
        xs, ys = frame.x + (columns + 0.5) * frame.resolution, frame.y + (rows + 0.5) * frame.resolution
        away = np.hypot(xs - at[0], ys - at[1])
        best = int(away.argmin())
        return (int(rows[best]), int(columns[best])) if away[best] <= most_m else None

    def _explain_no_room(self, at: Point) -> str:
        cell = self.frame.cell(at)
        if cell is None or (self.plan.places and self.rooms[cell] < 0):
            return "it is outside every place of the map"
        if things := self.obstacles_at([cell]):
            return f"{_listed(things)} {'is' if len(things) == 1 else 'are'} in the way"
        return "a wall is too near"

    def obstacles_at(self, cells: Sequence[Cell]) -> list[str]:
        """Return the things, except doors, that block a robot in these cells."""
        where = self.frame.mask()
        for row, column in cells:
            where[row, column] = True
        where = self._inflated(where)
        found = []
        for thing in self.plan.things:
            if not thing.door:
                mask = grids.things_mask(self.plan, self.frame, self.heights, [thing])
                if (mask & where).any():
                    found.append(thing.name)
        return found

    def _robot(self) -> str:
        return f"a robot {2.0 * self.radius_m:.2g} m wide"

    def shorten(self, cells: Sequence[Cell], free: Mask) -> tuple[list[Point], float]:
        """Return the corners of a path after shortcuts, and its length [m]."""
        corners = without_detours(cells, free) if len(cells) > 1 else list(cells)
        points = [self.frame.middle(*cell) for cell in corners]
        return points, sum(math.dist(a, b) for a, b in pairwise(points))

    def places_along(self, cells: Iterable[Cell]) -> list[str]:
        """Return the places along a path, in order."""
        found: list[str] = []
        for cell in cells:
            room = int(self.rooms[cell])
            if room >= 0 and (not found or found[-1] != self.plan.places[room].name):
                found.append(self.plan.places[room].name)
        return found

    def doors_along(self, cells: Sequence[Cell]) -> list[str]:
        """Return the doors along a path, in order."""
        found: dict[str, int] = {}
        index = {cell: k for k, cell in reversed(list(enumerate(cells)))}
        for door in self.plan.things:
            if door.door:
                mask = self.frame.mask()
                self.frame.add_convex(mask, grids.doorway(door))
                for cell in zip(*(axis.tolist() for axis in np.nonzero(mask)), strict=True):
                    if cell in index:
                        found[door.name] = min(found.get(door.name, len(cells)), index[cell])
        return sorted(found, key=found.__getitem__)


def find_path(plan: Plan, start: Point | str, end: Point | str, radius_m: float, heights: HeightRange) -> Way:
    """Return the shortest path between two ends, each a position or the name of a place or thing.

    A path through closed doors is returned only if there is no other, and its text says so. Raises Refused
    with the obstacles if there is no path.
    """
    terrain = TraversabilityMap(plan, radius_m, heights)
    tries: tuple[dict[str, bool], ...] = ({}, {"through_closed": True})
    no_room: errors.Refused | None = None
    for allowed in tries:
        free = terrain.free_mask(**allowed)
        try:
            ends = [_resolve_end(terrain, word, free) for word in (start, end)]
        except errors.Refused as error:
            no_room = error
            continue
        cells = shortest_path(free, ends[0].cells, ends[1].cells)
        if cells is not None:
            return _to_message(terrain, ends, cells, free)
    reason = _explain_no_path(terrain, start, end)
    if no_room is not None and "forbidden" not in reason:
        raise no_room
    raise errors.Refused(reason)


def _resolve_end(terrain: TraversabilityMap, word: Point | str, free: Mask) -> PathEnd:
    if not isinstance(word, str):
        return terrain.end_at_position(word, free)
    for place in terrain.plan.places:
        if place.name == word:
            return terrain.end_at_place(place, free)
    for thing in terrain.plan.things:
        if thing.name == word:
            return terrain.end_beside(thing, free)
    raise errors.Refused(f"{word} has no position or size; cannot compute a route to it")


def _to_message(terrain: TraversabilityMap, ends: Sequence[PathEnd], cells: list[Cell], free: Mask) -> Way:
    points, metres = terrain.shorten(cells, free)
    places, doors = terrain.places_along(cells), terrain.doors_along(cells)
    shut = {door.name for door in terrain.closed}
    closed = tuple(name for name in doors if name in shut)
    over = " to ".join(places) if places else "over open floor"
    through = f", through {_listed(doors)}" if doors else ""
    text = f"{metres:.2f} m from {ends[0].name} to {ends[1].name}: {over}{through}"
    if closed:
        are = "is" if len(closed) == 1 else "are"
        opened = f"with {'it' if len(closed) == 1 else 'them'} open, the route is {metres:.2f} m"
        text = (
            f"no route is open from {ends[0].name} to {ends[1].name}: {_listed(closed)} {are} closed;"
            f" {opened}: {over}{through}"
        )
    notes = [*terrain.plan.notes]
    if terrain.frame.resolution > _RESOLUTION_M:
        notes.append(f"the map is large; the route uses cells of {terrain.frame.resolution:g} m")
    rounded = tuple((round(x, 3), round(y, 3)) for x, y in points)
    return Way(
        metres=round(metres, 3),
        places=tuple(places),
        doors=tuple(doors),
        closed=closed,
        points=rounded,
        text=text,
        notes=tuple(notes),
    )


def _explain_no_path(terrain: TraversabilityMap, start: Point | str, end: Point | str) -> str:
    """Describe what blocks the path: forbidden places, things, or walls."""
    names = [word if isinstance(word, str) else f"({word[0]:g}, {word[1]:g})" for word in (start, end)]
    none = f"there is no route from {names[0]} to {names[1]} for a robot {2.0 * terrain.radius_m:.2g} m wide"
    for allowed in (
        {"through_forbidden": True},
        {"through_things": True},
        {"through_things": True, "through_forbidden": True},
    ):
        free = terrain.free_mask(through_closed=True, **allowed)
        try:
            ends = [_resolve_end(terrain, word, free) for word in (start, end)]
        except errors.Refused:
            continue
        cells = shortest_path(free, ends[0].cells, ends[1].cells)
        if cells is None:
            continue
        reasons = []
        if "through_forbidden" in allowed:
            blocked = [p.name for p in terrain.plan.places if p.forbidden and _crosses(terrain, p, cells)]
            reasons.append(
                f"every route leads through {_listed(blocked)}, which {_is_are(blocked)} forbidden"
            )
        if "through_things" in allowed and (things := terrain.obstacles_at(cells)):
            them = "it" if len(things) == 1 else "them"
            reasons.append(f"{_listed(things)} {_is_are(things)} in the way; move {them} to open a route")
        return f"{none}: {' and '.join(reasons)}"
    return f"{none}: no door or opening is wide enough"


def _crosses(terrain: TraversabilityMap, place: PlannedPlace, cells: Sequence[Cell]) -> bool:
    mask = terrain.frame.mask()
    terrain.frame.add_rings(mask, place.rings)
    mask = grids.inflated(mask, terrain.radius_m, terrain.frame.resolution)
    return any(mask[cell] for cell in cells)


def _frame(plan: Plan) -> Frame:
    """Return the finest grid, from 5 cm, that can be searched quickly."""
    resolution = _RESOLUTION_M
    while True:
        try:
            return grids.frame_around(plan, resolution, _MOST_CELLS)
        except errors.Refused:
            if resolution >= _COARSEST_M:
                raise errors.Refused(
                    "the map is too large for route planning; the maximum is"
                    f" {_MOST_CELLS:,} cells of {_COARSEST_M:g} m"
                ) from None
            resolution = min(_COARSEST_M, resolution * 2.0)


def _is_are(names: Sequence[str]) -> str:
    return "is" if len(names) == 1 else "are"


def _listed(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}" if names else "nothing"
