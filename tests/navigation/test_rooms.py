"""Rooms cut out of plans that are drawn: how many, and how well they fit."""

import math

import numpy as np
import pytest
from scipy import ndimage

from nodes.navigation.grid import FREE, OCCUPIED, UNKNOWN, Frame, OccupancyGrid
from nodes.navigation.loaded_plan import loaded_plan
from nodes.navigation.map_server import Described, pixels_of
from nodes.navigation.rooms import cut
from schemas.errors import BadFile
from schemas.polygons import read_wkt

SIDE = 0.05
ROOMS = {"big": (1.0, 1.0, 6.0, 5.0), "small": (6.1, 1.0, 10.0, 4.7), "hall": (1.0, 5.1, 10.0, 6.3)}
"""x and y of lower left and upper right corners [m]."""
DOORS = {
    ("big", "small"): (6.05, 2.5, 0.1, 0.9),
    ("big", "hall"): (3.0, 5.05, 0.9, 0.1),
    ("small", "hall"): (8.0, 4.55, 0.9, 1.2),
}
"""Middle and extents; the last leads through a wall that is 40 cm thick."""


def drawn(turn=0.0, noise=0.0, seed=0):
    """The plan with everything turned about its middle; noise: this share of the free cells is not."""
    height, width = 200, 260
    y, x = (np.mgrid[:height, :width] + 0.5) * SIDE
    cx, cy = 6.0, 4.5
    c, s = math.cos(-turn), math.sin(-turn)
    u, v = cx - 0.5 + c * (x - cx) - s * (y - cy), cy - 0.9 + s * (x - cx) + c * (y - cy)
    free = np.zeros((height, width), dtype=bool)
    truth = {}
    for name, (x0, y0, x1, y1) in ROOMS.items():
        truth[name] = (u > x0) & (u < x1) & (v > y0) & (v < y1)
        free |= truth[name]
    for dx, dy, wide, deep in DOORS.values():
        free |= (abs(u - dx) < wide / 2) & (abs(v - dy) < deep / 2)
    cells = np.full((height, width), UNKNOWN, dtype=np.int8)
    cells[ndimage.binary_dilation(free, np.ones((3, 3)), iterations=2)] = OCCUPIED
    cells[free] = FREE
    chance = np.random.default_rng(seed)
    cells[free & (chance.random(free.shape) < noise)] = OCCUPIED
    return OccupancyGrid(Frame(0.0, 0.0, SIDE, width, height), cells), truth


def mask_of(polygon, shape):
    y, x = (np.mgrid[: shape[0], : shape[1]] + 0.5) * SIDE
    found = np.zeros(shape, dtype=bool)
    for ring in polygon.rings:
        x0, y0 = ring[-1]
        for x1, y1 in ring:
            if y0 != y1:
                found ^= ((y0 > y) != (y1 > y)) & (x < x0 + (y - y0) * (x1 - x0) / (y1 - y0))
            x0, y0 = x1, y1
    return found


def fits(found, truth, shape):
    """The intersection over union of each room with what fits it best."""
    masks = [mask_of(room.polygon, shape) for room in found.rooms]
    return {
        name: max((mask & its).sum() / (mask | its).sum() for mask in masks) for name, its in truth.items()
    }


@pytest.mark.parametrize("turn", [0.0, 0.1, 0.35, math.pi / 4, 1.2])
@pytest.mark.parametrize("noise", [0.0, 0.005])
def test_rooms_are_found_however_the_plan_is_turned(turn, noise):
    grid, truth = drawn(turn, noise)
    found = cut(grid)

    assert len(found.rooms) == 3
    assert min(fits(found, truth, grid.cells.shape).values()) > 0.85
    assert sorted(door.rooms for door in found.doorways) == [(0, 1), (0, 2), (1, 2)]
    assert all(0.6 < door.width_m < 1.2 for door in found.doorways)


def test_doors_are_where_they_were_drawn():
    grid, _ = drawn()
    middles = [door.middle for door in cut(grid).doorways]
    shift = (6.0 - 5.5, 4.5 - 3.6)

    for x, y, _, _ in list(DOORS.values())[:2]:
        assert min(math.dist(middle, (x + shift[0], y + shift[1])) for middle in middles) < 0.15


def test_the_same_plan_makes_the_same_rooms():
    assert cut(drawn(0.35, 0.005)[0]) == cut(drawn(0.35, 0.005)[0])


def test_furniture_that_stands_about_belongs_to_its_room_and_makes_no_other():
    grid, truth = drawn()
    grid.cells[60:80, 60:80] = OCCUPIED
    found = cut(grid)

    assert len(found.rooms) == 3
    assert min(fits(found, truth, grid.cells.shape).values()) > 0.9


def test_a_plan_becomes_places_and_doors_where_its_origin_says():
    grid, _ = drawn()
    described = Described(image="x", resolution=SIDE, origin=(10.0, 20.0, math.pi / 2))
    made = loaded_plan(described, pixels_of(grid), "plan.yaml")
    rooms = [e for e in made.scene.entities if e.class_ == "Room"]
    doors = [e for e in made.scene.entities if e.class_ == "Door"]

    assert [room.name for room in rooms] == ["room1", "room2", "room3"]
    bounds = [read_wkt(room.extent).bounds for room in rooms]
    assert min(b[0] for b in bounds) == pytest.approx(10.0 - 7.2, abs=0.1)
    assert min(b[1] for b in bounds) == pytest.approx(20.0 + 1.5, abs=0.1)
    assert [len(door.set) for door in doors] == [2, 2, 2]
    assert made.lines[0].startswith("room1: ")
    assert made.lines[-1].startswith("doorway3: ")


def test_a_plan_without_rooms_is_refused():
    cells = np.full((50, 50), UNKNOWN, dtype=np.int8)
    cells[10:20, 10:20] = FREE
    pixels = pixels_of(OccupancyGrid(Frame(0.0, 0.0, SIDE, 50, 50), cells))
    with pytest.raises(BadFile, match="has no room in it"):
        loaded_plan(Described(image="x", resolution=SIDE), pixels, "plan.yaml")
