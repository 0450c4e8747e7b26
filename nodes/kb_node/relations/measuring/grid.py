"""A spatial index of solids in the cells of a grid on the floor plan."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence

from semmap.nodes.kb_node.relations.geometry.forms import Bounds
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring import crowds
from semmap.nodes.kb_node.relations.measuring.crowds import Crowd

CELL_M = 1.0
MOST_CELLS = 1024
"""Larger solids are in no cell, but in a list that every search reads."""

Cell = tuple[int, int]
_LARGE: Cell | None = None
"""The key of the list of large solids."""


class Grid:
    """Solids by cell. The cost of a search depends on the number of solids around the place."""

    def __init__(self) -> None:
        self._cells: dict[Cell, dict[Solid, None]] = {}
        self._large: dict[Solid, None] = {}
        self.crowds: dict[Cell | None, Crowd] = {}
        """The cells with more solids than are counted. The key None is the list of large solids."""
        self.shifted: dict[Solid, None] = {}
        """Solids that started or stopped being counted, or whose cell became or stopped being a crowd."""

    def add(self, solid: Solid) -> None:
        """Add a solid to the cells that its bounds cover."""
        cells = _cells(solid.bounds)
        if cells is None:
            self._large[solid] = None
            self._add_to_crowd(_LARGE, self._large, solid)
            return
        for cell in cells:
            there = self._cells.setdefault(cell, {})
            there[solid] = None
            if len(there) > crowds.MOST:
                self._add_to_crowd(cell, there, solid)

    def add_to(self, cell: Cell, solids: Sequence[Solid]) -> None:
        """Add solids to a cell that all of them cover. `add` does this for all cells of one solid."""
        there = self._cells.get(cell)
        if there is None:
            there = self._cells[cell] = {}
        if len(there) + len(solids) <= crowds.MOST:
            for solid in solids:
                there[solid] = None
            return
        for solid in solids:
            there[solid] = None
            if len(there) > crowds.MOST:
                self._add_to_crowd(cell, there, solid)

    def _add_to_crowd(self, cell: Cell | None, there: dict[Solid, None], solid: Solid) -> None:
        """Record a new solid in a cell that may be a crowd."""
        crowd = self.crowds.get(cell)
        if crowd is not None:
            left_out = crowd.add(solid)
            if left_out is not None:
                self.shifted[left_out] = None
        elif len(there) > crowds.MOST:
            self.crowds[cell] = Crowd(there)
            self.shifted.update(there)

    def remove(self, solid: Solid) -> None:
        """Remove a solid, which must have the bounds with which it was added."""
        if self._large.pop(solid, self) is None:
            self._remove_from_crowd(_LARGE, self._large, solid)
            return
        for cell in _cells(solid.bounds) or ():
            there = self._cells[cell]
            del there[solid]
            if not there:
                del self._cells[cell]
            if self.crowds:
                self._remove_from_crowd(cell, there, solid)

    def _remove_from_crowd(self, cell: Cell | None, there: dict[Solid, None], solid: Solid) -> None:
        """Record a removed solid in a cell that may be a crowd."""
        crowd = self.crowds.get(cell)
        if crowd is not None:
            counts_now = crowd.remove(solid)
            if counts_now is not None:
                self.shifted[counts_now] = None
            if len(there) <= crowds.MOST:
                del self.crowds[cell]
                self.shifted.update(there)

    def around(self, bounds: Bounds, margin_m: float = 0.0, but: Solid | None = None) -> list[Solid]:
        """Return the solids whose bounds meet `bounds` or are within a margin of them, except `but`."""
        x0, y0, x1, y1 = bounds
        x0, y0, x1, y1 = x0 - margin_m, y0 - margin_m, x1 + margin_m, y1 + margin_m
        return [
            solid
            for solid in self._find_solids(_cells((x0, y0, x1, y1)))
            if (its := solid.bounds)[0] <= x1
            and its[2] >= x0
            and its[1] <= y1
            and its[3] >= y0
            and solid is not but
        ]

    def counted_around(self, bounds: Bounds, margin_m: float = 0.0) -> list[Solid]:
        """Return those that are counted in a cell that they share with `bounds`."""
        if not self.crowds:
            return self.around(bounds, margin_m)
        x0, y0, x1, y1 = bounds
        x0, y0, x1, y1 = x0 - margin_m, y0 - margin_m, x1 + margin_m, y1 + margin_m
        large = self.crowds.get(_LARGE)
        found = dict(self._large if large is None else large.counted)
        cells = _cells((x0, y0, x1, y1))
        for cell in self._cells if cells is None else cells:
            crowd = self.crowds.get(cell)
            found.update(self._cells.get(cell, {}) if crowd is None else crowd.counted)
        return [
            solid
            for solid in found
            if (its := solid.bounds)[0] <= x1 and its[2] >= x0 and its[1] <= y1 and its[3] >= y0
        ]

    def find_in_cells(self, cells: Iterable[Cell]) -> list[Solid]:
        """Return the solids in these cells and the large ones, once each."""
        found = dict(self._large)
        for cell in cells:
            found.update(self._cells.get(cell, {}))
        return list(found)

    def find_counted_in(self, cells: Iterable[Cell], also: Iterable[Solid] = ()) -> list[Solid]:
        """Return `also`, and the counted solids in these cells and large ones, once each."""
        found = dict.fromkeys(also)
        for cell in (_LARGE, *cells):
            crowd = self.crowds.get(cell)
            if crowd is not None:
                found.update(crowd.counted)
            else:
                found.update(self._large if cell is None else self._cells.get(cell, {}))
        return list(found)

    def counts(self, solid: Solid) -> bool:
        """Return whether a solid is counted in any of its cells."""
        if not self.crowds:
            return True
        own = (self.crowds.get(cell) for cell in _cells(solid.bounds) or (_LARGE,))
        return any(crowd is None or solid in crowd.counted for crowd in own)

    def is_crowded(self, solid: Solid) -> bool:
        """Return whether a solid is in a crowd, which may have members that are not counted."""
        return bool(self.crowds) and not self.crowds.keys().isdisjoint(_cells(solid.bounds) or (_LARGE,))

    def describe_crowds(self, names: Collection[str] | None = None) -> list[str]:
        """Return a notice for each crowd, the largest first, or only for crowds with one of `names`.

        Crowds next to a reported one are left out.
        """
        if not self.crowds:
            return []
        found = [
            (-len(crowd), (0, 0) if cell is None else cell, cell is None)
            for cell, crowd in self.crowds.items()
            if len(crowd) > crowds.MOST and (names is None or crowd.has_any(names))
        ]
        reported: list[tuple[int, Cell, bool]] = []
        for count, cell, is_large in sorted(found):
            if not any(_are_adjacent(cell, other) and is_large == large for _, other, large in reported):
                reported.append((count, cell, is_large))
        return [
            crowds.describe_crowd(-count, None if large else cell, CELL_M) for count, cell, large in reported
        ]

    def _find_solids(self, cells: list[Cell] | None) -> Iterable[Solid]:
        """Yield the solids in these cells, once each, or all solids for None."""
        if cells is not None and len(cells) == 1 and not self._large:
            return self._cells.get(cells[0], ())
        found = self._large.copy()
        for cell in self._cells if cells is None else cells:
            if cell in self._cells:
                found.update(self._cells[cell])
        return found


def _are_adjacent(one: Cell, other: Cell) -> bool:
    return abs(one[0] - other[0]) <= 1 and abs(one[1] - other[1]) <= 1


def _cells(bounds: Bounds) -> list[Cell] | None:
    """Return the cells that bounds cover, or None if there are too many."""
    low_x, low_y, high_x, high_y = bounds
    x0, y0 = int(low_x // CELL_M), int(low_y // CELL_M)
    x1, y1 = int(high_x // CELL_M), int(high_y // CELL_M)
    if x0 == x1 and y0 == y1:
        return [(x0, y0)]
    if (x1 - x0 + 1) * (y1 - y0 + 1) > MOST_CELLS:
        return None
    return [(x, y) for x in range(x0, x1 + 1) for y in range(y0, y1 + 1)]
