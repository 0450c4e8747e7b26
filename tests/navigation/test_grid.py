import numpy as np
import pytest
from msgspec import structs

from semmap.nodes.navigation.grid import FREE, OCCUPIED, UNKNOWN, forbidden_mask, inflated, occupancy
from semmap.schemas.errors import Refused
from semmap.schemas.plans import Outline
from tests.navigation.made import DOOR, PLACES, box, place, plan, thing

HEIGHTS = (0.05, 1.5)


def at(grid, x, y):
    return int(grid.cells[grid.frame.cell((x, y))])


def test_walls_furniture_and_floor():
    table = thing("table1", box(1.0, 1.0, 2.0, 2.0, low=0.7, high=0.74), box(1.0, 1.0, 1.1, 1.1, high=0.7))
    grid = occupancy(plan(DOOR, table), 0.05, HEIGHTS)

    assert (at(grid, 3.0, 3.0), at(grid, 4.05, 3.0), at(grid, -0.4, 3.0)) == (FREE, OCCUPIED, UNKNOWN)
    assert at(grid, 1.5, 1.5) == OCCUPIED
    assert at(grid, 4.05, 1.45) == FREE
    low = occupancy(plan(DOOR, table), 0.05, (0.05, 0.5))
    assert (at(low, 1.5, 1.5), at(low, 1.05, 1.05)) == (FREE, OCCUPIED)
    assert at(occupancy(plan(DOOR, table), 0.05, HEIGHTS, furniture=False), 1.5, 1.5) == FREE


def test_a_door_that_is_closed_is_a_wall():
    assert at(occupancy(plan(structs.replace(DOOR, open=False)), 0.05, HEIGHTS), 4.05, 1.45) == OCCUPIED


def test_what_is_above_a_door_is_not_in_the_way_of_who_is_lower():
    assert at(occupancy(plan(DOOR), 0.05, (0.05, 2.3)), 4.05, 1.45) == OCCUPIED


def test_a_turned_box_covers_the_cells_that_it_touches_and_no_others():
    diamond = Outline(corners=((1.0, 0.0), (2.0, 1.0), (1.0, 2.0), (0.0, 1.0)), low=0.0, high=1.0)
    grid = occupancy(plan(structs.replace(thing("d", diamond)), walls=()), 0.1, HEIGHTS)
    area = (grid.cells == OCCUPIED).sum() * 0.01

    assert 2.0 <= area <= 2.5
    assert (at(grid, 0.15, 0.15), at(grid, 1.0, 1.0)) == (FREE, OCCUPIED)


def test_forbidden_places_as_a_mask():
    made = plan(places=(*PLACES, place("pit", 1.0, 1.0, 2.0, 3.0, forbidden=True)))
    grid = occupancy(made, 0.1, HEIGHTS)

    assert forbidden_mask(made, grid.frame).sum() == 200


def test_nothing_and_too_much_are_refused():
    with pytest.raises(Refused, match="no place with an extent"):
        occupancy(plan(places=(), walls=()), 0.05, HEIGHTS)
    with pytest.raises(Refused, match=r"too large .* a resolution of at least 0\.1"):
        occupancy(plan(places=(place("plain", 0, 0, 500, 500),), walls=()), 0.05, HEIGHTS)


def test_widening_is_by_a_disc():
    mask = np.random.default_rng(1).random((30, 40)) < 0.02
    rows, columns = np.nonzero(mask)
    y, x = np.mgrid[:30, :40]
    away = np.hypot(y[..., None] - rows, x[..., None] - columns).min(axis=2)

    for reach in (0.0, 1.0, 2.5, 5.2):
        assert (inflated(mask, reach * 0.05, 0.05) == (away <= reach + 1e-9)).all()
