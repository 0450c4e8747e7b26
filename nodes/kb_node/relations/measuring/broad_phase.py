"""Which solids are beside which, for many at once: pairs of rows as arrays, from cells that are sorted.

The pairs are those that `Grid.counted_around` has for each of them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain
from typing import Final

import numpy as np

from semmap.nodes.kb_node.relations.geometry.form_columns import Bools, Floats, Ints
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring.grid import CELL_M, MOST_CELLS, Cell, Grid

_FURTHEST: Final = 2**31 - 1
"""Cells are numbered up to here; what is further away is not looked for."""


class Cells:
    """Which cells the bounds of many solids cover, as `Grid` files them."""

    def __init__(self, bounds: Floats, margin_m: float = 0.0) -> None:
        """`bounds`: (N, 4), which may be anything."""
        low = np.floor_divide(bounds[:, :2] - margin_m, CELL_M)
        high = np.floor_divide(bounds[:, 2:] + margin_m, CELL_M)
        extent = high - low + 1.0
        self.is_large: Final[Bools] = ~(extent.prod(axis=1) <= MOST_CELLS)
        """(N,) whether it covers too many to be filed under each."""
        self.is_filed: Final[Bools] = (
            ~self.is_large & (np.abs(low) < _FURTHEST).all(axis=1) & (np.abs(high) < _FURTHEST).all(axis=1)
        )
        edge = _FURTHEST - 2 * MOST_CELLS
        self.is_amid: Final[Bools] = (
            self.is_filed & (np.abs(low) < edge).all(axis=1) & (np.abs(high) < edge).all(axis=1)
        )
        """(N,) whether all that shares a cell with it is filed, unless that is large."""
        self.low: Final[Ints] = np.where(self.is_filed[:, None], low, 0.0).astype(np.int64)
        self._extent: Final[Ints] = np.where(self.is_filed[:, None], extent, 0.0).astype(np.int64)

    def entries(self, rows: Ints) -> tuple[Ints, Ints]:
        """The keys of the cells that some cover, and who covers each."""
        wide, deep = self._extent[rows].T
        who, turn = repeat_rows(wide * deep)
        deep = deep[who]
        x, y = (
            self.low[rows, 0][who] + turn // np.maximum(deep, 1),
            self.low[rows, 1][who] + turn % np.maximum(deep, 1),
        )
        return key(x, y), rows[who]


def key(x: Ints, y: Ints) -> Ints:
    """One number for a cell."""
    return (x << 32) + y


def repeat_rows(counts: Ints) -> tuple[Ints, Ints]:
    """Each row as often as `counts` says, and which time it is: [2, 1] to [0, 0, 1] and [0, 1, 0]."""
    who = np.repeat(np.arange(len(counts)), counts)
    return who, np.arange(len(who)) - np.repeat(np.cumsum(counts) - counts, counts)


def sort_unique(numbers: Ints) -> Ints:
    """In order, once each, as np.unique has them; that loads numpy.ma, which takes longer than most loads."""
    ordered = np.sort(numbers)
    return ordered[starts_run(ordered)]


def starts_run(numbers: Ints) -> Bools:
    """Whether each is another than the one before it, as the first one is."""
    found = np.ones(len(numbers), dtype=bool)
    found[1:] = numbers[1:] != numbers[:-1]
    return found


class BroadPhase:
    """Finds pairs among solids, of which the first few are asked for, and the others are what is around."""

    def __init__(self, grid: Grid, solids: Sequence[Solid], bounds: Floats, subjects: int) -> None:
        """`solids` are all of the grid that share a cell with one of the first `subjects` of them."""
        self._grid: Final = grid
        self._solids: Final = solids
        self._bounds: Final = np.asfortranarray(bounds)
        self._subjects: Final = subjects
        cells = Cells(bounds)
        self._low = cells.low
        keys, who = cells.entries(np.flatnonzero(cells.is_filed))
        order = np.argsort(keys, kind="stable")
        self._keys, self._who = keys[order], who[order]
        large = self._counted(None, np.flatnonzero(cells.is_large))
        self._large: Final = large
        if grid.crowds:
            self._leave_out()

    def _counted(self, cell: tuple[int, int] | None, rows: Ints) -> Ints:
        crowd = self._grid.crowds.get(cell)
        if crowd is None:
            return rows
        return np.array([row for row in rows.tolist() if self._solids[row] in crowd.counted], dtype=np.int64)

    def _leave_out(self) -> None:
        """Have only those in a crowd who count there."""
        kept, counts = np.ones(len(self._keys), dtype=bool), np.zeros(len(self._solids), dtype=bool)
        for cell in self._grid.crowds:
            if cell is not None:
                at = key(*np.array(cell)[:, None])
                (begin,), (end,) = np.searchsorted(self._keys, at), np.searchsorted(self._keys, at + 1)
                there = self._who[begin:end]
                counts[self._counted(cell, there)] = True
                kept[begin:end] = counts[there]
                counts[there] = False
        self._keys, self._who = self._keys[kept], self._who[kept]

    def pairs(self, margin_m: float) -> tuple[Ints, Ints, Bools]:
        """(M,) rows of subjects and of who counts beside each, once; and (S,) of whom not all is known."""
        cells = Cells(self._bounds[: self._subjects], margin_m)
        keys, subject = cells.entries(np.flatnonzero(cells.is_filed))
        begin = np.searchsorted(self._keys, keys)
        which, turn = repeat_rows(np.searchsorted(self._keys, keys, side="right") - begin)
        one, other = subject[which], self._who[begin[which] + turn]
        meets = self._meet(one, other, margin_m)
        one, other, keys = one[meets], other[meets], keys[which[meets]]
        if self._grid.crowds:  # then it may not count in the first cell that they share
            joined = sort_unique(one * len(self._solids) + other)
            one, other = np.divmod(joined, max(len(self._solids), 1))
        else:
            first = np.maximum(cells.low[one], self._low[other])
            is_first = key(first[:, 0], first[:, 1]) == keys
            one, other = one[is_first], other[is_first]
        if len(self._large):
            by, large = (
                np.repeat(np.arange(self._subjects), len(self._large)),
                np.tile(self._large, self._subjects),
            )
            meets = self._meet(by, large, margin_m)
            one, other = np.concatenate([one, by[meets]]), np.concatenate([other, large[meets]])
        return one, other, ~cells.is_amid

    def _meet(self, one: Ints, other: Ints, margin_m: float) -> Bools:
        """Whether bounds meet, or are within a margin."""
        low_x, low_y, high_x, high_y = self._bounds.T
        found: Bools = one != other
        for low, high in ((low_x, high_x), (low_y, high_y)):
            found &= low[other] <= (high + margin_m)[one]
            found &= high[other] >= (low - margin_m)[one]
        return found


def add_to_grid(grid: Grid, solids: Sequence[Solid]) -> None:
    """Add many to a grid."""
    cells = Cells(bounds_of(solids))
    for row in np.flatnonzero(~cells.is_filed).tolist():
        grid.add(solids[row])
    keys, who = cells.entries(np.flatnonzero(cells.is_filed))
    order = np.argsort(keys, kind="stable")
    keys, filed = keys[order], [solids[row] for row in who[order].tolist()]
    begins = np.flatnonzero(starts_run(keys))
    ends = np.append(begins, len(keys))[1:]
    for cell, begin, end in zip(_decoded(keys[begins]), begins.tolist(), ends.tolist(), strict=True):
        grid.add_to(cell, filed[begin:end])


def bounds_of(solids: Sequence[Solid]) -> Floats:
    """(N, 4) the bounds of solids [m]."""
    flat = chain.from_iterable(solid.bounds for solid in solids)
    return np.fromiter(flat, np.float64, 4 * len(solids)).reshape(-1, 4)


def find_cells(solids: Sequence[Solid], margin_m: float = 0.0) -> list[Cell]:
    """The cells that are covered by some of these, or are within a margin of one."""
    cells = Cells(bounds_of(solids), margin_m)
    keys, _ = cells.entries(np.flatnonzero(cells.is_filed))
    return list(_decoded(sort_unique(keys)))


def find_nearby(grid: Grid, solids: Sequence[Solid], margin_m: float) -> list[Solid] | None:
    """Who is filed where some solids are, or within a margin; None for everybody."""
    if Cells(bounds_of(solids), margin_m).is_large.any():
        return None
    return grid.find_in_cells(find_cells(solids, margin_m))


def sort_by_place(solids: Sequence[Solid]) -> list[Solid]:
    """In strips across the map, so that those who follow one another have the same around them."""
    low = np.floor_divide(bounds_of(solids)[:, :2], CELL_M)
    return [solids[row] for row in np.lexsort(low.T[::-1]).tolist()]


def _decoded(keys: Ints) -> Iterator[Cell]:
    """The cells of some keys."""
    x = keys >> 32
    y = keys - (x << 32)
    far = y > _FURTHEST
    return zip((x + far).tolist(), (y - (far.astype(np.int64) << 32)).tolist(), strict=True)
