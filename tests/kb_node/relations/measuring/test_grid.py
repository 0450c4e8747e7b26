"""The spatial index of solids, and the search for pairs of many solids."""

from __future__ import annotations

import random

import numpy as np
import pytest

from semmap.nodes.kb_node.relations.geometry.solids import solid_of
from semmap.nodes.kb_node.relations.measuring import crowds
from semmap.nodes.kb_node.relations.measuring.broad_phase import (
    BroadPhase,
    Cells,
    add_to_grid,
    bounds_of,
    find_cells,
    find_nearby,
    repeat_rows,
    sort_by_place,
    sort_unique,
)
from semmap.nodes.kb_node.relations.measuring.grid import Grid
from tests.kb_node.relations.entities import thing


def solid(name, x, y, side=0.2, *, place=False):
    return solid_of(thing(name, (x, y, 0.0), "box", size=(side, side, 0.2), place=place))


def grid_of(*solids):
    grid = Grid()
    for one in solids:
        grid.add(one)
    return grid


def names(solids):
    return sorted(one.name for one in solids)


NEAR, BESIDE, FAR = solid("near", 0.5, 0.5), solid("beside", 0.9, 0.5, 0.4), solid("far", 5.5, -5.5)
FLOOR = solid("floor", 0.0, 0.0, 100.0)


def test_solids_are_found_whose_bounds_meet_or_touch():
    grid = grid_of(NEAR, BESIDE, FAR)
    assert names(grid.around((0.0, 0.0, 0.4, 1.0))) == ["near"]
    assert names(grid.around((0.6, 0.0, 0.7, 1.0))) == ["beside", "near"]
    assert names(grid.around((0.0, 0.0, 0.3, 1.0))) == []
    assert names(grid.around((0.4, 0.6, 0.5, 0.7))) == ["near"]
    assert names(grid.around((0.4, 0.2, 0.5, 0.4))) == ["near"]
    assert names(grid.around((0.4, 0.7, 0.5, 0.8))) == []
    assert names(grid.around((5.0, -6.0, 6.0, -5.0))) == ["far"]


def test_a_margin_widens_the_search_on_all_sides():
    grid = grid_of(NEAR, BESIDE, FAR)
    for bounds in ((0.0, 0.5, 0.1, 0.5), (1.3, 0.5, 1.4, 0.5), (0.5, 0.0, 0.5, 0.1), (0.5, 0.9, 0.5, 1.0)):
        assert "near" not in names(grid.around(bounds, 0.1))
    assert names(grid.around((0.0, 0.5, 0.1, 0.5), 0.31)) == ["near"]
    assert names(grid.around((0.5, 0.9, 0.5, 1.0), 0.31)) == ["beside", "near"]
    assert names(grid.around((4.0, -4.0, 5.0, -3.5), 1.5)) == ["far"]


def test_a_solid_is_not_a_neighbour_of_itself():
    grid = grid_of(NEAR, BESIDE)
    assert names(grid.around(NEAR.bounds, but=NEAR)) == []
    assert names(grid.around(NEAR.bounds, 0.2, but=NEAR)) == ["beside"]


def test_a_very_large_solid_is_found_everywhere_and_a_very_large_search_finds_all():
    grid = grid_of(NEAR, FLOOR)
    assert names(grid.around((30.0, 30.0, 31.0, 31.0))) == ["floor"]
    assert names(grid.around((60.0, 60.0, 61.0, 61.0))) == []
    grid.add(FAR)
    assert names(grid.around((-99.0, -99.0, 99.0, 99.0))) == ["far", "floor", "near"]
    assert names(grid.find_in_cells([(0, 0)])) == ["floor", "near"]


def test_a_removed_solid_is_found_no_more():
    grid = grid_of(NEAR, BESIDE, FLOOR)
    grid.remove(BESIDE)
    assert names(grid.around((0.0, 0.0, 2.0, 2.0))) == ["floor", "near"]
    grid.remove(FLOOR)
    assert names(grid.around((0.0, 0.0, 2.0, 2.0))) == ["near"]
    grid.remove(NEAR)
    assert grid.around((-99.0, -99.0, 99.0, 99.0)) == []
    assert grid.find_in_cells([(0, 0)]) == []


@pytest.fixture
def few(monkeypatch):
    """Make three objects of a cell a crowd, of which the two largest are counted."""
    monkeypatch.setattr(crowds, "MOST", 2)


@pytest.mark.usefixtures("few")
def test_in_a_crowd_the_largest_are_counted_and_all_are_found():
    small, middle, large = (
        solid(name, 0.5, 0.5, side) for name, side in zip("abc", (0.1, 0.2, 0.3), strict=True)
    )
    grid = grid_of(small, middle)
    assert not grid.is_crowded(small)
    assert grid.shifted == {}
    grid.add(large)
    assert names(grid.shifted) == ["a", "b", "c"]
    assert names(grid.around(small.bounds)) == ["a", "b", "c"]
    assert names(grid.counted_around(small.bounds)) == ["b", "c"]
    assert [grid.counts(one) for one in (small, middle, large)] == [False, True, True]
    assert grid.is_crowded(small)
    assert names(grid.find_counted_in([(0, 0)])) == ["b", "c"]
    assert names(grid.find_counted_in([(0, 0)], also=[small])) == ["a", "b", "c"]
    assert not grid.is_crowded(FAR)
    assert grid.counts(FAR)


@pytest.mark.usefixtures("few")
def test_another_object_is_counted_when_a_counted_one_is_removed():
    solids = [solid(name, 0.5, 0.5, side) for name, side in zip("abcd", (0.1, 0.2, 0.3, 0.4), strict=True)]
    grid = grid_of(*solids)
    grid.shifted.clear()
    grid.remove(solids[3])
    assert names(grid.shifted) == ["b"]
    assert names(grid.counted_around(solids[0].bounds)) == ["b", "c"]
    grid.shifted.clear()
    grid.remove(solids[2])
    assert names(grid.shifted) == ["a", "b"]
    assert not grid.crowds
    assert names(grid.counted_around(solids[0].bounds)) == ["a", "b"]


@pytest.mark.usefixtures("few")
def test_an_object_that_reaches_out_of_a_crowd_is_counted_in_the_other_cell():
    crowd = [solid(name, 0.5, 0.5, 0.3) for name in "abc"]
    reaching = solid("z", 1.0, 0.5, 0.1)
    grid = grid_of(*crowd, reaching)
    assert grid.counts(reaching)
    assert "z" not in names(grid.counted_around((0.4, 0.4, 0.95, 0.6)))
    assert "z" in names(grid.counted_around((0.4, 0.4, 1.05, 0.6)))


@pytest.mark.usefixtures("few")
def test_adjacent_crowds_are_described_once_the_largest_first():
    grid = grid_of(
        *(solid(f"a{n}", 0.5, 0.5) for n in range(3)),
        *(solid(f"b{n}", 1.5, 0.5) for n in range(4)),
        *(solid(f"c{n}", 3.5, 3.5) for n in range(3)),
        *(solid(f"d{n}", 7.5, 7.5, 80.0) for n in range(5)),
    )
    large, first, second = grid.describe_crowds()
    assert "5" in large
    assert "4" in first
    assert "3" in second
    assert grid.describe_crowds({"a1"}) != [] != grid.describe_crowds({"c2"})
    assert grid.describe_crowds({"e1"}) == []
    assert grid_of(NEAR).describe_crowds() == []


def scattered(count=60, seed=1):
    rng = random.Random(seed)
    return [
        solid(f"s{n}", rng.uniform(-4, 4), rng.uniform(-4, 4), rng.choice((0.1, 0.4, 1.7, 9.0, 60.0)))
        for n in range(count)
    ]


@pytest.mark.parametrize("most", [crowds.MOST, 3])
@pytest.mark.parametrize("margin_m", [0.0, 0.3])
def test_pairs_of_many_are_those_of_each(monkeypatch, most, margin_m):
    monkeypatch.setattr(crowds, "MOST", most)
    solids = scattered()
    grid = Grid()
    add_to_grid(grid, solids)
    assert sorted(grid.crowds, key=str) == sorted(grid_of(*solids).crowds, key=str)
    search = BroadPhase(grid, solids, bounds_of(solids), subjects=20)
    one, other, incomplete = search.pairs(margin_m)
    complete = np.flatnonzero(~incomplete).tolist()
    assert complete == [row for row in range(20) if solids[row].form.size[0] < 50.0]
    found = zip(one.tolist(), other.tolist(), strict=True)
    assert sorted(pair for pair in found if pair[0] in complete) == sorted(
        (row, solids.index(near))
        for row in complete
        for near in grid.counted_around(solids[row].bounds, margin_m)
        if near is not solids[row]
    )


def test_the_cells_of_solids():
    assert set(find_cells([NEAR])) == {(0, 0)}
    assert set(find_cells([FAR])) == {(5, -6)}
    assert set(find_cells([BESIDE])) == {(0, 0), (1, 0)}
    assert set(find_cells([NEAR], 0.5)) == {(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1)}
    assert find_cells([]) == []


def test_far_and_unbounded_solids_are_not_searched_in_cells():
    found = Cells(np.array([[0, 0, 1, 1], [3e9, 0, 3e9, 1], [0, 0, 1e30, 1], [2147482000, 0, 2147482001, 0]]))
    assert found.is_filed.tolist() == [True, False, False, True]
    assert found.is_large.tolist() == [False, False, True, False]
    assert found.is_amid.tolist() == [True, False, False, False]


def test_solids_in_the_cells_of_others():
    grid = grid_of(NEAR, BESIDE, FAR)
    assert names(find_nearby(grid, [NEAR], 0.0)) == ["beside", "near"]
    assert names(find_nearby(grid, [FAR], 0.0)) == ["far"]
    assert find_nearby(grid, [FLOOR], 0.0) is None


def test_solids_are_sorted_by_strips():
    solids = [solid("b", 1.5, 0.5), solid("c", 1.5, 3.5), solid("a", 0.5, 7.5), solid("d", 2.5, -3.5)]
    assert [one.name for one in sort_by_place(solids)] == ["a", "b", "c", "d"]


def test_rows_are_repeated_and_numbers_made_unique():
    owner, turn = repeat_rows(np.array([2, 0, 1]))
    assert (owner.tolist(), turn.tolist()) == ([0, 0, 2], [0, 1, 0])
    assert sort_unique(np.array([3, 1, 3, 2, 1])).tolist() == [1, 2, 3]
    assert sort_unique(np.array([], dtype=np.int64)).tolist() == []
