"""Ways over places and through doors, and why there is none."""

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
"""More would take seconds, so a large map has larger cells."""
_COARSEST_M: Final = 0.2
"""Doors do not fit between larger cells."""
_BESIDE_M: Final = 0.4
"""How near to a thing a robot gets that is sent to it, but for its own radius."""
_ASIDE_M: Final = 0.5
"""How far from a position that has no room for it a robot may stop."""
_POSITION = re.compile(r"\(?\s*(-?[\d.]+(?:e-?\d+)?)\s*[,\s]\s*(-?[\d.]+(?:e-?\d+)?)\s*\)?", re.IGNORECASE)


def parse_position(word: str) -> Point | None:
    """The position that is written `2.5,1`; None for what is a name."""
    match = _POSITION.fullmatch(word.strip())
    if match is None:
        return None
    try:
        return float(match[1]), float(match[2])
    except ValueError:
        return None


@dataclass(frozen=True)
class PathEnd:
    """An end of a way: the cells that count as being there, and what it is called."""

    name: str
    cells: tuple[Cell, ...]


class TraversabilityMap:
    """Where a robot of a radius can be on a plan: as it is, and if less were in its way."""

    def __init__(self, plan: Plan, radius_m: float, heights: HeightRange) -> None:
        """Raises Refused for a plan with nothing on it, or that is too large."""
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
        """What the middle of the robot keeps out of; half a cell less, since a cell counts as a whole."""
        return grids.inflated(mask, self.radius_m, self.frame.resolution)

    def free_mask(
        self, *, through_closed: bool = False, through_forbidden: bool = False, through_things: bool = False
    ) -> Mask:
        """Where its middle may be."""
        free = ~self._walls
        if not through_closed:
            free &= ~self._doors
        if not through_forbidden:
            free &= ~self._forbidden
        if not through_things:
            free &= ~self._things
        return free

    def end_at_position(self, at: Point, free: Mask) -> PathEnd:
        """A position, or the nearest one to it with room for the robot. Raises Refused."""
        name = f"({at[0]:g}, {at[1]:g})"
        found = self._nearest(free, at, _ASIDE_M)
        if found is None:
            raise errors.Refused(
                f"there is no room for {self._robot()} at {name}: {self._explain_no_room(at)}"
            )
        return PathEnd(name, (found,))

    def end_at_place(self, place: PlannedPlace, free: Mask) -> PathEnd:
        """The free cell of a place that is nearest to its middle. Raises Refused."""
        mask = self.frame.mask()
        self.frame.add_rings(mask, place.rings)
        xs, ys = zip(*place.rings[0], strict=True)
        middle = ((min(xs) + max(xs)) / 2.0, (min(ys) + max(ys)) / 2.0)
        found = self._nearest(free & mask, middle, math.inf)
        if found is None:
            raise errors.Refused(f"there is no room for {self._robot()} in {place.name}")
        return PathEnd(place.name, (found,))

    def end_beside(self, thing: PlannedThing, free: Mask) -> PathEnd:
        """All cells beside a thing, in its own room. Raises Refused."""
        near = self.frame.mask()
        outline = thing.footprint
        if len(outline) < 3:
            raise errors.Refused(f"{thing.name} has no size, so nobody can say what is beside it")
        self.frame.add_convex(near, outline)
        own_rooms = set(np.unique(self.rooms[near]).tolist()) - {-1}
        near = grids.inflated(near, self.radius_m + _BESIDE_M, self.frame.resolution)
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
            return "it is in no place of the map"
        if things := self.obstacles_at([cell]):
            return f"{_listed(things)} {'is' if len(things) == 1 else 'are'} in the way"
        return "a wall is too near"

    def obstacles_at(self, cells: Sequence[Cell]) -> list[str]:
        """The things, but doors, that are in the way of a robot somewhere in these cells."""
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
        """The corners of a way, and its length [m]."""
        corners = without_detours(cells, free) if len(cells) > 1 else list(cells)
        points = [self.frame.middle(*cell) for cell in corners]
        return points, sum(math.dist(a, b) for a, b in pairwise(points))

    def places_along(self, cells: Iterable[Cell]) -> list[str]:
        """The places that a way leads through, in order."""
        found: list[str] = []
        for cell in cells:
            room = int(self.rooms[cell])
            if room >= 0 and (not found or found[-1] != self.plan.places[room].name):
                found.append(self.plan.places[room].name)
        return found

    def doors_along(self, cells: Sequence[Cell]) -> list[str]:
        """The doors that a way leads through, in order."""
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
    """The shortest way between two ends, each a position or the name of a place or thing of the plan.

    Through closed doors only if there is no other, which the answer then says. Raises Refused where there is
    none even so, with what stands in the way.
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
    raise errors.Refused(f"{word} has no position or no size, so no way leads there")


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
        opened = f"opening {'it' if len(closed) == 1 else 'them'} makes one of {metres:.2f} m"
        text = (
            f"no way is open from {ends[0].name} to {ends[1].name}: {_listed(closed)} {are} closed; {opened}:"
            f" {over}{through}"
        )
    notes = [*terrain.plan.notes]
    if terrain.frame.resolution > _RESOLUTION_M:
        notes.append(f"the map is large, so the way is found on cells of {terrain.frame.resolution:g} m")
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
    """What is in the way: forbidden places, things, or walls."""
    said = [word if isinstance(word, str) else f"({word[0]:g}, {word[1]:g})" for word in (start, end)]
    none = f"there is no way from {said[0]} to {said[1]} for a robot {2.0 * terrain.radius_m:.2g} m wide"
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
            names = [p.name for p in terrain.plan.places if p.forbidden and _crosses(terrain, p, cells)]
            reasons.append(f"it would lead through {_listed(names)}, which {_is_are(names)} forbidden")
        if "through_things" in allowed and (names := terrain.obstacles_at(cells)):
            reasons.append(f"{_listed(names)} {_is_are(names)} in the way; without that there would be one")
        return f"{none}: {' and '.join(reasons)}"
    return f"{none}: there are walls all around, and no door or opening that is wide enough"


def _crosses(terrain: TraversabilityMap, place: PlannedPlace, cells: Sequence[Cell]) -> bool:
    mask = terrain.frame.mask()
    terrain.frame.add_rings(mask, place.rings)
    mask = grids.inflated(mask, terrain.radius_m, terrain.frame.resolution)
    return any(mask[cell] for cell in cells)


def _frame(plan: Plan) -> Frame:
    """The finest grid, from 5 cm on, that is searched in moments."""
    resolution = _RESOLUTION_M
    while True:
        try:
            return grids.frame_around(plan, resolution, _MOST_CELLS)
        except errors.Refused:
            if resolution >= _COARSEST_M:
                raise errors.Refused(
                    "the map is too large to find ways on: they are found on a grid of"
                    f" {_MOST_CELLS:,} cells of at most {_COARSEST_M:g} m"
                ) from None
            resolution = min(_COARSEST_M, resolution * 2.0)


def _is_are(names: Sequence[str]) -> str:
    return "is" if len(names) == 1 else "are"


def _listed(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}" if names else "nothing"
