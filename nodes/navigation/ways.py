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
from semmap.nodes.navigation.search import Cell, shortest, straightened
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


def position(word: str) -> Point | None:
    """The position that is written `2.5,1`; None for what is a name."""
    match = _POSITION.fullmatch(word.strip())
    if match is None:
        return None
    try:
        return float(match[1]), float(match[2])
    except ValueError:
        return None


@dataclass(frozen=True)
class End:
    """An end of a way: the cells that count as being there, and what it is called."""

    name: str
    cells: tuple[Cell, ...]


class Ground:
    """Where a robot of a radius can be on a plan: as it is, and if less were in its way."""

    def __init__(self, plan: Plan, radius_m: float, heights: HeightRange) -> None:
        """Raises Refused for a plan with nothing on it, or that is too large."""
        self.plan, self.radius_m, self.heights = plan, radius_m, heights
        self.frame = _frame(plan)
        solid = ~grids.floor_mask(plan, self.frame) | grids.wall_mask(plan, self.frame, heights)
        built = [thing for thing in plan.things if thing.class_ in ("Wall", "Window", "Stairs")]
        self._walls = self._wide(solid | grids.things_mask(plan, self.frame, heights, built))
        others = [t for t in plan.things if not t.door and t not in built]
        self._things = self._wide(grids.things_mask(plan, self.frame, heights, others))
        self._forbidden = self._wide(grids.forbidden(plan, self.frame))
        self.closed = [thing for thing in plan.things if thing.door and thing.open is False]
        self._doors = self.frame.mask()
        for door in self.closed:
            self.frame.add_convex(self._doors, grids.doorway(door))
        self.rooms = grids.rooms_by_cell(plan, self.frame)

    def _wide(self, mask: Mask) -> Mask:
        """What the middle of the robot keeps out of; half a cell less, since a cell counts as a whole."""
        return grids.widened(mask, self.radius_m, self.frame.resolution)

    def passable(
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

    def at_position(self, at: Point, free: Mask) -> End:
        """A position, or the nearest one to it with room for the robot. Raises Refused."""
        name = f"({at[0]:g}, {at[1]:g})"
        found = self._nearest(free, at, _ASIDE_M)
        if found is None:
            raise errors.Refused(f"there is no room for {self._robot()} at {name}: {self._why(at)}")
        return End(name, (found,))

    def at_place(self, place: PlannedPlace, free: Mask) -> End:
        """The free cell of a place that is nearest to its middle. Raises Refused."""
        mask = self.frame.mask()
        self.frame.add_rings(mask, place.rings)
        xs, ys = zip(*place.rings[0], strict=True)
        middle = ((min(xs) + max(xs)) / 2.0, (min(ys) + max(ys)) / 2.0)
        found = self._nearest(free & mask, middle, math.inf)
        if found is None:
            raise errors.Refused(f"there is no room for {self._robot()} in {place.name}")
        return End(place.name, (found,))

    def beside(self, thing: PlannedThing, free: Mask) -> End:
        """All cells beside a thing, in its own room. Raises Refused."""
        near = self.frame.mask()
        outline = thing.footprint
        if len(outline) < 3:
            raise errors.Refused(f"{thing.name} has no size, so nobody can say what is beside it")
        self.frame.add_convex(near, outline)
        own_rooms = set(np.unique(self.rooms[near]).tolist()) - {-1}
        near = grids.widened(near, self.radius_m + _BESIDE_M, self.frame.resolution)
        if own_rooms and not thing.door:
            near &= np.isin(self.rooms, list(own_rooms))
        rows, columns = np.nonzero(near & free)
        if not len(rows):
            raise errors.Refused(f"there is no room for {self._robot()} beside {thing.name}")
        return End(thing.name, tuple(zip(rows.tolist(), columns.tolist(), strict=True)))

    def _nearest(self, free: Mask, at: Point, most_m: float) -> Cell | None:
        rows, columns = np.nonzero(free)
        if not len(rows):
            return None
        frame = self.frame
        xs, ys = frame.x + (columns + 0.5) * frame.resolution, frame.y + (rows + 0.5) * frame.resolution
        away = np.hypot(xs - at[0], ys - at[1])
        best = int(away.argmin())
        return (int(rows[best]), int(columns[best])) if away[best] <= most_m else None

    def _why(self, at: Point) -> str:
        cell = self.frame.cell(at)
        if cell is None or (self.plan.places and self.rooms[cell] < 0):
            return "it is in no place of the map"
        if things := self.standing_at([cell]):
            return f"{_listed(things)} {'is' if len(things) == 1 else 'are'} in the way"
        return "a wall is too near"

    def standing_at(self, cells: Sequence[Cell]) -> list[str]:
        """The things, but doors, that are in the way of a robot somewhere in these cells."""
        where = self.frame.mask()
        for row, column in cells:
            where[row, column] = True
        where = self._wide(where)
        found = []
        for thing in self.plan.things:
            if not thing.door:
                mask = grids.things_mask(self.plan, self.frame, self.heights, [thing])
                if (mask & where).any():
                    found.append(thing.name)
        return found

    def _robot(self) -> str:
        return f"a robot {2.0 * self.radius_m:.2g} m wide"

    def way(self, cells: Sequence[Cell], free: Mask) -> tuple[list[Point], float]:
        """The corners of a way, and its length [m]."""
        corners = straightened(cells, free) if len(cells) > 1 else list(cells)
        points = [self.frame.middle(*cell) for cell in corners]
        return points, sum(math.dist(a, b) for a, b in pairwise(points))

    def places_on(self, cells: Iterable[Cell]) -> list[str]:
        """The places that a way leads through, in order."""
        found: list[str] = []
        for cell in cells:
            room = int(self.rooms[cell])
            if room >= 0 and (not found or found[-1] != self.plan.places[room].name):
                found.append(self.plan.places[room].name)
        return found

    def doors_on(self, cells: Sequence[Cell]) -> list[str]:
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


def find_way(plan: Plan, start: Point | str, end: Point | str, radius_m: float, heights: HeightRange) -> Way:
    """The shortest way between two ends, each a position or the name of a place or thing of the plan.

    Through closed doors only if there is no other, which the answer then says. Raises Refused where there is
    none even so, with what stands in the way.
    """
    ground = Ground(plan, radius_m, heights)
    tries: tuple[dict[str, bool], ...] = ({}, {"through_closed": True})
    no_room: errors.Refused | None = None
    for allowed in tries:
        free = ground.passable(**allowed)
        try:
            ends = [_end(ground, word, free) for word in (start, end)]
        except errors.Refused as error:
            no_room = error
            continue
        cells = shortest(free, ends[0].cells, ends[1].cells)
        if cells is not None:
            return _way(ground, ends, cells, free)
    reason = _why_none(ground, start, end)
    if no_room is not None and "forbidden" not in reason:
        raise no_room
    raise errors.Refused(reason)


def _end(ground: Ground, word: Point | str, free: Mask) -> End:
    if not isinstance(word, str):
        return ground.at_position(word, free)
    for place in ground.plan.places:
        if place.name == word:
            return ground.at_place(place, free)
    for thing in ground.plan.things:
        if thing.name == word:
            return ground.beside(thing, free)
    raise errors.Refused(f"{word} has no position or no size, so no way leads there")


def _way(ground: Ground, ends: Sequence[End], cells: list[Cell], free: Mask) -> Way:
    points, metres = ground.way(cells, free)
    places, doors = ground.places_on(cells), ground.doors_on(cells)
    shut = {door.name for door in ground.closed}
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
    notes = [*ground.plan.notes]
    if ground.frame.resolution > _RESOLUTION_M:
        notes.append(f"the map is large, so the way is found on cells of {ground.frame.resolution:g} m")
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


def _why_none(ground: Ground, start: Point | str, end: Point | str) -> str:
    """What is in the way: forbidden places, things, or walls."""
    said = [word if isinstance(word, str) else f"({word[0]:g}, {word[1]:g})" for word in (start, end)]
    none = f"there is no way from {said[0]} to {said[1]} for a robot {2.0 * ground.radius_m:.2g} m wide"
    for allowed in (
        {"through_forbidden": True},
        {"through_things": True},
        {"through_things": True, "through_forbidden": True},
    ):
        free = ground.passable(through_closed=True, **allowed)
        try:
            ends = [_end(ground, word, free) for word in (start, end)]
        except errors.Refused:
            continue
        cells = shortest(free, ends[0].cells, ends[1].cells)
        if cells is None:
            continue
        reasons = []
        if "through_forbidden" in allowed:
            names = [p.name for p in ground.plan.places if p.forbidden and _is_on(ground, p, cells)]
            reasons.append(f"it would lead through {_listed(names)}, which {_is_are(names)} forbidden")
        if "through_things" in allowed and (names := ground.standing_at(cells)):
            reasons.append(f"{_listed(names)} {_is_are(names)} in the way; without that there would be one")
        return f"{none}: {' and '.join(reasons)}"
    return f"{none}: there are walls all around, and no door or opening that is wide enough"


def _is_on(ground: Ground, place: PlannedPlace, cells: Sequence[Cell]) -> bool:
    mask = ground.frame.mask()
    ground.frame.add_rings(mask, place.rings)
    mask = grids.widened(mask, ground.radius_m, ground.frame.resolution)
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
