"""Occupancy grids: square cells over the floor, rows by increasing y; arrays are (height, width)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.geometry.polygons import Point
from semmap.nodes.geometry.regions import Region
from semmap.schemas import errors
from semmap.schemas.plans import HeightRange, Plan, PlannedPlace, PlannedThing

Cells = NDArray[np.int8]
Mask = NDArray[np.bool_]

UNKNOWN: Final = -1
FREE: Final = 0
OCCUPIED: Final = 100
MOST_CELLS: Final = 16_000_000
_MARGIN_M: Final = 0.5
_DOORWAY_M: Final = 0.4
"""Maximum thickness of a wall that a door leads through."""
_OWN_SHARE: Final = 0.4
"""Minimum share of its cells that belong to no other place."""
_TOUCH: Final = 1e-6
"""Tolerance for outlines that only touch a cell [m]."""


@dataclass(frozen=True)
class Frame:
    """The position of a grid: the lower left corner of its first cell, and the side of a cell [m]."""

    x: float
    y: float
    resolution: float
    width: int
    height: int

    def mask(self) -> Mask:
        """Return an empty mask of this grid."""
        return np.zeros((self.height, self.width), dtype=bool)

    def cell(self, point: Point) -> tuple[int, int] | None:
        """Return row and column of the cell that contains a point; None outside the grid."""
        row = math.floor((point[1] - self.y) / self.resolution)
        column = math.floor((point[0] - self.x) / self.resolution)
        inside = 0 <= row < self.height and 0 <= column < self.width
        return (row, column) if inside else None

    def middle(self, row: int, column: int) -> Point:
        """Return the centre of a cell."""
        return self.x + (column + 0.5) * self.resolution, self.y + (row + 0.5) * self.resolution

    def add_convex(self, mask: Mask, corners: Sequence[Point], *, reach_m: float | None = None) -> None:
        """Mark the cells that overlap a convex outline with counterclockwise corners.

        With `reach_m`, marks the cells whose centres lie in the outline or a margin of this width around its
        sides.
        """
        beyond = 0.0 if reach_m is None else max(reach_m, 0.0)
        xs, ys = zip(*corners, strict=True)
        left = max(0, math.floor((min(xs) - beyond - self.x) / self.resolution))
        right = min(self.width, math.ceil((max(xs) + beyond - self.x) / self.resolution))
        low = max(0, math.floor((min(ys) - beyond - self.y) / self.resolution))
        high = min(self.height, math.ceil((max(ys) + beyond - self.y) / self.resolution))
        if left >= right or low >= high:
            return
        x = self.x + (np.arange(left, right) + 0.5) * self.resolution
        y = self.y + (np.arange(low, high) + 0.5) * self.resolution
        inside = np.ones((high - low, right - left), dtype=bool)
        half = self.resolution / 2.0
        if reach_m is None:
            inside &= (np.minimum(x + half, max(xs)) - np.maximum(x - half, min(xs)) > _TOUCH)[None, :]
            inside &= (np.minimum(y + half, max(ys)) - np.maximum(y - half, min(ys)) > _TOUCH)[:, None]
        ax, ay = corners[-1]
        for bx, by in corners:
            ex, ey = bx - ax, by - ay
            length = math.hypot(ex, ey)
            if length > 0.0:
                nx, ny = -ey / length, ex / length  # inwards
                most = half * (abs(nx) + abs(ny)) - _TOUCH if reach_m is None else reach_m + _TOUCH
                inside &= (nx * (x - ax))[None, :] + (ny * (y - ay))[:, None] > -most
            ax, ay = bx, by
        mask[low:high, left:right] |= inside

    def add_rings(self, mask: Mask, rings: Sequence[Sequence[Point]]) -> None:
        """Mark the cells whose centres lie in a polygon."""
        for piece in Region(rings).pieces:
            self.add_convex(mask, piece.corners, reach_m=0.0)


@dataclass(frozen=True)
class OccupancyGrid:
    """The occupancy of the floor: `cells` are `FREE`, `OCCUPIED` or `UNKNOWN`."""

    frame: Frame
    cells: Cells


def frame_around(plan: Plan, resolution: float, most_cells: int = MOST_CELLS) -> Frame:
    """Return a grid that covers a plan with a margin; its origin is a multiple of the resolution.

    Raises Refused for an empty plan, and for a grid of too many cells.
    """
    points = [
        point
        for outlines in (
            (ring for place in plan.places for ring in place.rings),
            (wall.corners for wall in plan.walls),
            (thing.footprint for thing in plan.things if not plan.places or thing.door),
        )
        for outline in outlines
        for point in outline
    ]
    if not points:
        raise errors.Refused("the map has no place with an extent and no thing with a size")
    xs, ys = zip(*points, strict=True)
    x0, y0 = (math.floor((min(v) - _MARGIN_M) / resolution) * resolution for v in (xs, ys))
    width = math.ceil((max(xs) + _MARGIN_M - x0) / resolution)
    height = math.ceil((max(ys) + _MARGIN_M - y0) / resolution)
    if width * height > most_cells:
        coarse = resolution * math.sqrt(width * height / most_cells)
        raise errors.Refused(
            f"a grid of {width} x {height} cells is too large (maximum {most_cells:,} cells);"
            f" use a resolution of at least {math.ceil(coarse * 100) / 100:g} m"
        )
    return Frame(round(x0, 9), round(y0, 9), resolution, width, height)


def floor_mask(plan: Plan, frame: Frame) -> Mask:
    """Return where there is floor: in places and doorways, or everywhere if there are no places."""
    floor = frame.mask()
    for place in plan.places:
        frame.add_rings(floor, place.rings)
    if not plan.places:
        floor[:] = True
    for door in plan.things:
        if door.door:
            frame.add_convex(floor, doorway(door), reach_m=0.0)
    return floor


def doorway(door: PlannedThing) -> Sequence[Point]:
    """Return the outline that a door leads through: its footprint, stretched across its wall."""
    if len(door.footprint) != 4:
        return door.footprint
    a, b, c, d = door.footprint
    if math.dist(a, b) > math.dist(b, c):
        a, b, c, d = b, c, d, a  # now a to b leads through the wall
    thick = math.dist(a, b)
    if not 0.0 < thick < _DOORWAY_M:
        return door.footprint
    grow = (_DOORWAY_M / thick - 1.0) / 2.0
    dx, dy = (b[0] - a[0]) * grow, (b[1] - a[1]) * grow
    return ((a[0] - dx, a[1] - dy), (b[0] + dx, b[1] + dy), (c[0] + dx, c[1] + dy), (d[0] - dx, d[1] - dy))


def floor_level(plan: Plan) -> float:
    """Return the height of the floor of the plan: that of the lowest place [m]."""
    return min((place.floor for place in plan.places), default=0.0)


def wall_mask(plan: Plan, frame: Frame, heights: HeightRange) -> Mask:
    """Return where walls of world and map are, between these heights above the floor."""
    mask = frame.mask()
    low, high = (floor_level(plan) + h for h in heights)
    for wall in plan.walls:
        if wall.low < high and wall.high > low:
            frame.add_convex(mask, wall.corners)
    return mask


def things_mask(plan: Plan, frame: Frame, heights: HeightRange, things: Iterable[PlannedThing]) -> Mask:
    """Return where things are, between these heights above the floor."""
    mask = frame.mask()
    low, high = (floor_level(plan) + h for h in heights)
    for thing in things:
        for part in thing.parts:
            if part.low < high and part.high > low:
                frame.add_convex(mask, part.corners)
    return mask


def obstacle_things(plan: Plan) -> list[PlannedThing]:
    """Return the things that may be obstacles: all but doors that are not known to be closed."""
    return [thing for thing in plan.things if not thing.door or thing.open is False]


def occupancy(
    plan: Plan, resolution: float, heights: HeightRange, *, furniture: bool = True
) -> OccupancyGrid:
    """Return the occupancy grid of a plan: walls and, with `furniture`, things at their poses.

    Parts at `heights` above the floor [m] are obstacles. Raises Refused, see `frame_around`.
    """
    frame = frame_around(plan, resolution)
    cells = np.full((frame.height, frame.width), UNKNOWN, dtype=np.int8)
    cells[floor_mask(plan, frame)] = FREE
    cells[wall_mask(plan, frame, heights)] = OCCUPIED
    in_way = obstacle_things(plan) if furniture else [t for t in plan.things if t.class_ in _BUILT]
    cells[things_mask(plan, frame, heights, in_way)] = OCCUPIED
    return OccupancyGrid(frame, cells)


_BUILT: Final = frozenset(("Wall", "Window", "Stairs"))
"""The classes of things that are parts of the building."""


def forbidden_mask(plan: Plan, frame: Frame) -> Mask:
    """Return the keep-out zones for robots."""
    mask = frame.mask()
    for place in plan.places:
        if place.forbidden:
            frame.add_rings(mask, place.rings)
    return mask


def rooms_by_cell(plan: Plan, frame: Frame) -> NDArray[np.int32]:
    """Return for each cell (height, width) its place: the smallest that is not part of a room; -1 for none.

    A place that consists mostly of other places, as a flat does of its rooms, is ignored.
    """
    found = np.full((frame.height, frame.width), -1, dtype=np.int32)
    sizes: dict[int, int] = {}
    order = [k for k, place in enumerate(plan.places) if not place.part]
    for k in sorted(order, key=lambda k: -_area(plan.places[k])):
        mask = frame.mask()
        frame.add_rings(mask, plan.places[k].rings)
        found[mask] = k
        sizes[k] = int(mask.sum())
    own = np.bincount(found[found >= 0], minlength=len(plan.places))
    whole = [k for k, size in sizes.items() if own[k] < _OWN_SHARE * size]
    found[np.isin(found, whole)] = -1
    return found


def _area(place: PlannedPlace) -> float:
    return Region(place.rings).area


def inflated(mask: Mask, reach_m: float, resolution: float) -> Mask:
    """Return a mask inflated by `reach_m`, measured between the centres of cells."""
    reach = reach_m / resolution
    rows = math.floor(reach)
    if rows < 1:
        return mask.copy()
    height, width = mask.shape
    found = np.zeros_like(mask)
    for dy in range(-rows, rows + 1):
        across = math.floor(math.sqrt(reach * reach - dy * dy) + 1e-9)
        sums = np.zeros((height, width + 2 * across + 2), dtype=np.int32)
        sums[:, across + 1 : across + 1 + width] = mask
        sums = sums.cumsum(axis=1)
        spread = sums[:, 2 * across + 1 : 2 * across + 1 + width] - sums[:, :width]
        rows_to = slice(max(0, dy), min(height, height + dy))
        rows_from = slice(max(0, -dy), min(height, height - dy))
        found[rows_to] |= spread[rows_from] > 0
    return found
