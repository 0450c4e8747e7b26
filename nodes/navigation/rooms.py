"""Segmentation of an occupancy grid into rooms: free space is cut where it is as narrow as a door.

Each free cell has a clearance, its distance to the nearest obstacle. Cells are added from the widest on, so
each room starts at its middle. Where two rooms meet, the free space is a neck with the clearance of the
meeting cell. A neck separates two rooms if it is as narrow as a door, clearly narrower than both sides, and a
gap in a wall (`jambs.py`); otherwise the rooms are merged. The order is fixed, so the result is
deterministic.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from semmap.nodes.geometry.polygons import Point
from semmap.nodes.navigation.grid import FREE, UNKNOWN, Mask, OccupancyGrid
from semmap.nodes.navigation.jambs import Jambs
from semmap.nodes.navigation.outlines import outline_of
from semmap.schemas.polygons import Polygon

Labels = NDArray[np.int32]

WIDEST_DOOR_M: Final = 1.3
LEAST_ROOM_M2: Final = 2.0
_NARROWED: Final = 0.9
_BEYOND_M: Final = 0.7
"""A neck has less than the share `_NARROWED` of the maximum clearance within this distance, on both sides."""
_SPECK_M: Final = 0.12
"""Obstacles smaller than this are noise."""
_LARGEST_ISLAND_M: Final = 3.0
_THICKEST_WALL_M: Final = 0.35
_LEAST_DOOR_M: Final = 0.4


@dataclass(frozen=True)
class Room:
    """A room: its polygon and its area [m^2], in the grid's frame."""

    polygon: Polygon
    area_m2: float


@dataclass(frozen=True)
class Doorway:
    """A passage between two rooms, given by index: its middle, its width [m] and its yaw [rad].

    The yaw is the direction through the passage.
    """

    rooms: tuple[int, int]
    middle: Point
    width_m: float
    yaw_rad: float


@dataclass(frozen=True)
class RoomSegmentation:
    """The rooms of a plan, ordered by their middles from the lower left, and their doorways."""

    rooms: tuple[Room, ...]
    doorways: tuple[Doorway, ...]


def segment_rooms(
    grid: OccupancyGrid, *, widest_door_m: float = WIDEST_DOOR_M, least_room_m2: float = LEAST_ROOM_M2
) -> RoomSegmentation:
    """Return the rooms of a grid, and the passages between them.

    A passage is at most `widest_door_m` wide. An area smaller than `least_room_m2` is merged with a
    neighbour, or ignored if it has none.
    """
    resolution = grid.frame.resolution
    free = _without_specks(grid.cells, resolution)
    if not free.any():
        return RoomSegmentation((), ())
    free |= _islands(free, resolution)
    clearance = ndimage.distance_transform_edt(np.pad(free, 1))[1:-1, 1:-1] * resolution
    labels = _basins(clearance, widest_door_m / 2.0, resolution, Jambs(free, resolution))
    labels = _without_small(labels, clearance, int(least_room_m2 / resolution**2))
    return _described(labels, free, grid)


def _without_specks(cells: NDArray[np.int8], resolution: float) -> Mask:
    """Return the free cells, including obstacles that are too small."""
    free: Mask = cells == FREE
    most = max(1, round((_SPECK_M / resolution) ** 2))
    numbered, count = ndimage.label(~free)
    sizes = np.bincount(numbered.ravel(), minlength=count + 1)
    small = sizes <= most
    small[0] = False
    filled: Mask = free | small[numbered]
    numbered, count = ndimage.label(filled)
    sizes = np.bincount(numbered.ravel(), minlength=count + 1)
    stray = sizes <= most
    stray[0] = True
    kept: Mask = ~stray[numbered]
    return kept


def _islands(free: Mask, resolution: float) -> Mask:
    """Return free-standing obstacles that are thicker than a wall: furniture, which makes no necks."""
    numbered, count = ndimage.label(~free, np.ones((3, 3)))
    if not count:
        return np.zeros_like(free)
    depth = ndimage.distance_transform_edt(~free)
    thick = ndimage.maximum(depth, numbered, np.arange(1, count + 1)) * resolution > _THICKEST_WALL_M / 2.0
    found: Mask = np.zeros_like(free)
    for k, (rows, columns) in enumerate(ndimage.find_objects(numbered), start=1):
        deep, wide = rows.stop - rows.start, columns.stop - columns.start
        at_the_edge = 0 in (rows.start, columns.start) or (
            rows.stop == free.shape[0] or columns.stop == free.shape[1]
        )
        if thick[k - 1] and not at_the_edge and max(deep, wide) * resolution <= _LARGEST_ISLAND_M:
            found[rows, columns] |= numbered[rows, columns] == k
    return found


def _basins(clearance: NDArray[np.float64], most_m: float, resolution: float, jambs: Jambs) -> Labels:
    """Return the basin of each free cell, from 1; 0 for cells that are not free."""
    height, width = clearance.shape
    across = width + 2
    padded = np.zeros((height + 2, across))
    padded[1:-1, 1:-1] = clearance
    flat = np.round(padded.ravel(), 6)
    cells = np.flatnonzero(flat > 0.0)
    order = cells[np.lexsort((cells, -flat[cells]))].tolist()
    values = flat.tolist()
    label = [0] * len(values)
    parent = [0]
    peak = [0.0]
    steps = (-across, -1, 1, across, -across - 1, -across + 1, across - 1, across + 1)

    def root(k: int) -> int:
        while parent[k] != k:
            parent[k] = parent[parent[k]]
            k = parent[k]
        return k

    apart: set[tuple[int, int]] = set()
    reach = max(1, round(_BEYOND_M / resolution))
    disc = [
        dy * across + dx
        for dy in range(-reach, reach + 1)
        for dx in range(-reach, reach + 1)
        if dy * dy + dx * dx <= reach * reach
    ]

    def is_neck(cell: int, value: float, pair: tuple[int, int]) -> bool:
        """Return whether both sides are clearly wider nearby, and a wall ends at the cell."""
        most = dict.fromkeys(pair, 0.0)
        for step in disc:
            there = cell + step
            if 0 <= there < len(label) and label[there] and (k := root(label[there])) in most:
                most[k] = max(most[k], values[there])
        if value >= _NARROWED * min(most.values()):
            return False
        return jambs.are_at(cell // across - 1, cell % across - 1)

    for cell in order:
        value = values[cell]
        around: list[int] = []
        widest, own = 0.0, 0
        for step in steps:
            its = label[cell + step]
            if its:
                if values[cell + step] > widest:
                    widest, own = values[cell + step], its
                found = root(its)
                if found not in around:
                    around.append(found)
        if not around:
            parent.append(len(parent))
            peak.append(value)
            label[cell] = len(parent) - 1
            continue
        label[cell] = own
        if len(around) > 1:
            around.sort(key=lambda k: (-peak[k], k))
            first = around[0]
            for other in around[1:]:
                pair = (first, other)
                if pair not in apart and (other, first) not in apart:
                    if value <= most_m and is_neck(cell, value, pair):
                        apart.add(pair)
                    else:
                        parent[other] = first
                        apart = {(first if a == other else a, first if b == other else b) for a, b in apart}
    names: dict[int, int] = {}
    found_labels = [names.setdefault(root(k), len(names) + 1) if k else 0 for k in label]
    return np.array(found_labels, dtype=np.int32).reshape(height + 2, across)[1:-1, 1:-1]


def _without_small(labels: Labels, clearance: NDArray[np.float64], least: int) -> Labels:
    """Merge areas too small for a room with the neighbour that has the widest opening to them."""
    labels = labels.copy()
    while True:
        sizes = np.bincount(labels.ravel())
        sizes[0] = np.iinfo(sizes.dtype).max
        small = [int(k) for k in np.argsort(sizes, kind="stable") if 0 < sizes[k] < least]
        if not small:
            return labels
        one = small[0]
        beside = ndimage.binary_dilation(labels == one, np.ones((3, 3))) & (labels != one) & (labels != 0)
        others = labels[beside]
        if not len(others):
            labels[labels == one] = 0
            continue
        widest = [(float(clearance[beside & (labels == k)].max()), -k) for k in np.unique(others).tolist()]
        labels[labels == one] = -max(widest)[1]


def _described(labels: Labels, free: Mask, grid: OccupancyGrid) -> RoomSegmentation:
    resolution = grid.frame.resolution
    found: list[tuple[tuple[float, float], int, Room]] = []
    for k in [int(k) for k in np.unique(labels) if k]:
        mask = labels == k
        polygon = outline_of(_filled(mask, grid), resolution)
        if polygon is None:
            continue
        rows, columns = np.nonzero(mask)
        middle = (round(float(rows.mean()) * resolution, 1), round(float(columns.mean()) * resolution, 1))
        found.append((middle, k, Room(polygon, polygon.area_m2)))
    found.sort(key=lambda entry: (entry[0], entry[1]))
    place = {k: number for number, (_, k, _) in enumerate(found)}
    return RoomSegmentation(tuple(room for _, _, room in found), tuple(_doorways(labels, place, resolution)))


def _filled(mask: Mask, grid: OccupancyGrid) -> Mask:
    """Return a room with the obstacles that it encloses, without other rooms and large unknown areas."""
    filled: Mask = ndimage.binary_fill_holes(mask)
    holes, count = ndimage.label(filled & ~mask)
    for k in range(1, count + 1):
        hole = holes == k
        other_rooms = (grid.cells[hole] == FREE).mean()
        unknown = (grid.cells[hole] == UNKNOWN).mean()
        if other_rooms > 0.5 or (unknown > 0.5 and hole.sum() * grid.frame.resolution**2 > LEAST_ROOM_M2):
            filled &= ~hole
    return filled


def _doorways(labels: Labels, place: dict[int, int], resolution: float) -> list[Doorway]:
    """Return where two rooms meet: connected cells of one that are adjacent to the other."""
    touching: dict[tuple[int, int], list[tuple[float, float]]] = {}
    for dy, dx in ((0, 1), (1, 0), (1, 1), (1, -1)):
        one = labels[: labels.shape[0] - dy, max(0, -dx) : labels.shape[1] - max(0, dx)]
        other = labels[dy:, max(0, dx) : labels.shape[1] - max(0, -dx)]
        meet = (one != other) & (one > 0) & (other > 0)
        for row, column in zip(*(axis.tolist() for axis in np.nonzero(meet)), strict=True):
            a, b = int(one[row, column]), int(other[row, column])
            if a in place and b in place:
                pair = (min(place[a], place[b]), max(place[a], place[b]))
                at = (row + dy / 2.0 + 0.5, column + max(0, -dx) + dx / 2.0 + 0.5)
                touching.setdefault(pair, []).append(at)
    found: list[Doorway] = []
    for pair, spots in sorted(touching.items()):
        for group in _groups(spots):
            points = np.array(group)[:, ::-1] * resolution  # x, y
            middle = points.mean(axis=0)
            _, _, axes = np.linalg.svd(points - middle, full_matrices=False)
            along = axes[0] if len(points) > 1 else np.array([1.0, 0.0])
            reach = (points - middle) @ along
            width = float(reach.max() - reach.min()) + resolution
            if width < _LEAST_DOOR_M:
                continue
            centre = middle + along * (reach.max() + reach.min()) / 2.0
            yaw = math.atan2(along[0], -along[1])  # across the border
            yaw = (yaw + math.pi / 2.0) % math.pi - math.pi / 2.0
            at = (round(float(centre[0]), 3), round(float(centre[1]), 3))
            found.append(Doorway(pair, at, round(width, 2), round(yaw, 4) + 0.0))
    return found


def _groups(spots: list[tuple[float, float]]) -> list[list[tuple[float, float]]]:
    """Group spots that are within two cells of one another."""
    left = sorted(set(spots))
    groups: list[list[tuple[float, float]]] = []
    while left:
        group, left = [left[0]], left[1:]
        k = 0
        while k < len(group):
            near = [s for s in left if math.dist(s, group[k]) <= 2.0]
            group += near
            left = [s for s in left if s not in near]
            k += 1
        groups.append(group)
    return groups
