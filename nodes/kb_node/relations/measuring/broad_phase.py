"""Neighbour search for many solids at once: pairs of rows as arrays, from sorted grid cells.

The pairs are the same as those of `Grid.counted_around` for each solid.
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
"""The greatest cell number. Solids further away are not searched here."""


class Cells:
    """The grid cells that the bounds of many solids cover, in the same way as `Grid`."""

    def __init__(self, bounds: Floats, margin_m: float = 0.0) -> None:
        """Compute the cells of (N, 4) bounds, which may have any values."""
        low = np.floor_divide(bounds[:, :2] - margin_m, CELL_M)
        high = np.floor_divide(bounds[:, 2:] + margin_m, CELL_M)
        extent = high - low + 1.0
        self.is_large: Final[Bools] = ~(extent.prod(axis=1) <= MOST_CELLS)
        """(N,) whether it covers too many cells to be listed in each."""
        self.is_filed: Final[Bools] = (
            ~self.is_large & (np.abs(low) < _FURTHEST).all(axis=1) & (np.abs(high) < _FURTHEST).all(axis=1)
        )
        edge = _FURTHEST - 2 * MOST_CELLS
        self.is_amid: Final[Bools] = (
            self.is_filed & (np.abs(low) < edge).all(axis=1) & (np.abs(high) < edge).all(axis=1)
        )
        """(N,) whether all solids that share a cell with it are listed, except large ones."""
        self.low: Final[Ints] = np.where(self.is_filed[:, None], low, 0.0).astype(np.int64)
        self._extent: Final[Ints] = np.where(self.is_filed[:, None], extent, 0.0).astype(np.int64)

    def entries(self, rows: Ints) -> tuple[Ints, Ints]:
        """Return the keys of the covered cells, and the row that covers each."""
        wide, deep = self._extent[rows].T
        owner, turn = repeat_rows(wide * deep)
        deep = deep[owner]
        x, y = (
            self.low[rows, 0][owner] + turn // np.maximum(deep, 1),
            self.low[rows, 1][owner] + turn % np.maximum(deep, 1),
        )
        return cell_key(x, y), rows[owner]


def cell_key(x: Ints, y: Ints) -> Ints:
    """Return one number for a cell."""
    return (x << 32) + y


def repeat_rows(counts: Ints) -> tuple[Ints, Ints]:
    """Repeat each row `counts` times and number the repetitions: [2, 1] gives [0, 0, 1] and [0, 1, 0]."""
    owner = np.repeat(np.arange(len(counts)), counts)
    return owner, np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)


def sort_unique(numbers: Ints) -> Ints:
    """Return the sorted distinct numbers, without the import of numpy.ma that np.unique costs."""
    ordered = np.sort(numbers)
    return ordered[starts_run(ordered)]


def starts_run(numbers: Ints) -> Bools:
    """Return whether each number differs from the one before. The first one does."""
    found = np.ones(len(numbers), dtype=bool)
    found[1:] = numbers[1:] != numbers[:-1]
    return found


class BroadPhase:
    """Search for pairs between the first few solids (subjects) and all solids around them."""

    def __init__(self, grid: Grid, solids: Sequence[Solid], bounds: Floats, subjects: int) -> None:
        """Prepare the search.

        `solids` are all solids of the grid that share a cell with one of the first `subjects` of them.
        """
        self._grid: Final = grid
        self._solids: Final = solids
        self._bounds: Final = np.asfortranarray(bounds)
        self._subjects: Final = subjects
        cells = Cells(bounds)
        self._low = cells.low
        keys, owner = cells.entries(np.flatnonzero(cells.is_filed))
        order = np.argsort(keys, kind="stable")
        self._keys, self._owner = keys[order], owner[order]
        large = self._counted(None, np.flatnonzero(cells.is_large))
        self._large: Final = large
        if grid.crowds:
            self._drop_uncounted()

    def _counted(self, cell: tuple[int, int] | None, rows: Ints) -> Ints:
        crowd = self._grid.crowds.get(cell)
        if crowd is None:
            return rows
        return np.array([row for row in rows.tolist() if self._solids[row] in crowd.counted], dtype=np.int64)

    def _drop_uncounted(self) -> None:
        """Keep only those members of a crowd that are counted."""
        kept, counts = np.ones(len(self._keys), dtype=bool), np.zeros(len(self._solids), dtype=bool)
        for cell in self._grid.crowds:
            if cell is not None:
                at = cell_key(*np.array(cell)[:, None])
                (begin,), (end,) = np.searchsorted(self._keys, at), np.searchsorted(self._keys, at + 1)
                there = self._owner[begin:end]
                counts[self._counted(cell, there)] = True
                kept[begin:end] = counts[there]
                counts[there] = False
        self._keys, self._owner = self._keys[kept], self._owner[kept]

    def pairs(self, margin_m: float) -> tuple[Ints, Ints, Bools]:
        """Return (M,) rows of subjects and of their neighbours, and (S,) which are incomplete."""
        cells = Cells(self._bounds[: self._subjects], margin_m)
        keys, subject = cells.entries(np.flatnonzero(cells.is_filed))
        begin = np.searchsorted(self._keys, keys)
        which, turn = repeat_rows(np.searchsorted(self._keys, keys, side="right") - begin)
        one, other = subject[which], self._owner[begin[which] + turn]
        meets = self._meet(one, other, margin_m)
        one, other, keys = one[meets], other[meets], keys[which[meets]]
        if self._grid.crowds:  # it may not be counted in the first cell that they share
            joined = sort_unique(one * len(self._solids) + other)
            one, other = np.divmod(joined, max(len(self._solids), 1))
        else:
            first = np.maximum(cells.low[one], self._low[other])
            is_first = cell_key(first[:, 0], first[:, 1]) == keys
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
        """Return whether bounds meet or are within a margin."""
        low_x, low_y, high_x, high_y = self._bounds.T
        found: Bools = one != other
        for low, high in ((low_x, high_x), (low_y, high_y)):
            found &= low[other] <= (high + margin_m)[one]
            found &= high[other] >= (low - margin_m)[one]
        return found


def add_to_grid(grid: Grid, solids: Sequence[Solid]) -> None:
    """Add many solids to a grid."""
    cells = Cells(bounds_of(solids))
    for row in np.flatnonzero(~cells.is_filed).tolist():
        grid.add(solids[row])
    keys, owner = cells.entries(np.flatnonzero(cells.is_filed))
    order = np.argsort(keys, kind="stable")
    keys, filed = keys[order], [solids[row] for row in owner[order].tolist()]
    begins = np.flatnonzero(starts_run(keys))
    ends = np.append(begins, len(keys))[1:]
    for cell, begin, end in zip(_decoded(keys[begins]), begins.tolist(), ends.tolist(), strict=True):
        grid.add_to(cell, filed[begin:end])


def bounds_of(solids: Sequence[Solid]) -> Floats:
    """Return the (N, 4) bounds of solids [m]."""
    flat = chain.from_iterable(solid.bounds for solid in solids)
    return np.fromiter(flat, np.float64, 4 * len(solids)).reshape(-1, 4)


def find_cells(solids: Sequence[Solid], margin_m: float = 0.0) -> list[Cell]:
    """Return the cells covered by the solids, or within a margin of one."""
    cells = Cells(bounds_of(solids), margin_m)
    keys, _ = cells.entries(np.flatnonzero(cells.is_filed))
    return list(_decoded(sort_unique(keys)))


def find_nearby(grid: Grid, solids: Sequence[Solid], margin_m: float) -> list[Solid] | None:
    """Return the solids in the cells of others or within a margin, or None for all."""
    if Cells(bounds_of(solids), margin_m).is_large.any():
        return None
    return grid.find_in_cells(find_cells(solids, margin_m))


def sort_by_place(solids: Sequence[Solid]) -> list[Solid]:
    """Sort solids in strips across the map, so that successive ones have the same neighbours."""
    low = np.floor_divide(bounds_of(solids)[:, :2], CELL_M)
    return [solids[row] for row in np.lexsort(low.T[::-1]).tolist()]


def _decoded(keys: Ints) -> Iterator[Cell]:
    """Yield the cells of keys."""
    x = keys >> 32
    y = keys - (x << 32)
    far = y > _FURTHEST
    return zip((x + far).tolist(), (y - (far.astype(np.int64) << 32)).tolist(), strict=True)
