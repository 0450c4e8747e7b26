"""A spatial index: which solids are in which cells of a grid on the floor plan."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence

from semmap.nodes.kb_node.relations.geometry.forms import Bounds
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring import crowds
from semmap.nodes.kb_node.relations.measuring.crowds import Crowd

CELL_M = 1.0
MOST_CELLS = 1024
"""What covers more is in no cell, but in a list that every question looks through."""

Cell = tuple[int, int]
_LARGE: Cell | None = None
"""Stands for the list of what covers too many cells."""


class Grid:
    """Solids by cell. A question costs as much as there is around the place that it asks about."""

    def __init__(self) -> None:
        self._cells: dict[Cell, dict[Solid, None]] = {}
        self._large: dict[Solid, None] = {}
        self.crowds: dict[Cell | None, Crowd] = {}
        """The cells where there may be more than count; None stands for what is in no cell."""
        self.shifted: dict[Solid, None] = {}
        """Whose place became a crowd or is none now, and who in a crowd counts, or does not any more."""

    def add(self, solid: Solid) -> None:
        """File a solid under the cells that its bounds cover."""
        cells = _cells(solid.bounds)
        if cells is None:
            self._large[solid] = None
            self._crowd(_LARGE, self._large, solid)
            return
        for cell in cells:
            there = self._cells.setdefault(cell, {})
            there[solid] = None
            if len(there) > crowds.MOST:
                self._crowd(cell, there, solid)

    def add_to(self, cell: Cell, solids: Sequence[Solid]) -> None:
        """File some under a cell that the bounds of each cover; `add` does so for all cells of one."""
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
                self._crowd(cell, there, solid)

    def _crowd(self, cell: Cell | None, there: dict[Solid, None], solid: Solid) -> None:
        """One more came where there are many."""
        crowd = self.crowds.get(cell)
        if crowd is not None:
            left_out = crowd.add(solid)
            if left_out is not None:
                self.shifted[left_out] = None
        elif len(there) > crowds.MOST:
            self.crowds[cell] = Crowd(there)
            self.shifted.update(there)

    def remove(self, solid: Solid) -> None:
        """Take it out; with the bounds that it was filed under."""
        if self._large.pop(solid, self) is None:
            self._thin_out(_LARGE, self._large, solid)
            return
        for cell in _cells(solid.bounds) or ():
            there = self._cells[cell]
            del there[solid]
            if not there:
                del self._cells[cell]
            if self.crowds:
                self._thin_out(cell, there, solid)

    def _thin_out(self, cell: Cell | None, there: dict[Solid, None], solid: Solid) -> None:
        """One went where there may be many."""
        crowd = self.crowds.get(cell)
        if crowd is not None:
            counts_now = crowd.remove(solid)
            if counts_now is not None:
                self.shifted[counts_now] = None
            if len(there) <= crowds.MOST:
                del self.crowds[cell]
                self.shifted.update(there)

    def around(self, bounds: Bounds, margin_m: float = 0.0, but: Solid | None = None) -> list[Solid]:
        """Whose bounds meet these, or are within a margin of them; `but` one."""
        x0, y0, x1, y1 = bounds
        x0, y0, x1, y1 = x0 - margin_m, y0 - margin_m, x1 + margin_m, y1 + margin_m
        return [
            solid
            for solid in self._filed(_cells((x0, y0, x1, y1)))
            if (its := solid.bounds)[0] <= x1
            and its[2] >= x0
            and its[1] <= y1
            and its[3] >= y0
            and solid is not but
        ]

    def counted_around(self, bounds: Bounds, margin_m: float = 0.0) -> list[Solid]:
        """Those of them who count in a cell that they share with these bounds."""
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
        """Once each who is filed under some cells, or is in none."""
        found = dict(self._large)
        for cell in cells:
            found.update(self._cells.get(cell, {}))
        return list(found)

    def find_counted_in(self, cells: Iterable[Cell], also: Iterable[Solid] = ()) -> list[Solid]:
        """Once each: `also`, and who counts in some cells, or is in none."""
        found = dict.fromkeys(also)
        for cell in (_LARGE, *cells):
            crowd = self.crowds.get(cell)
            if crowd is not None:
                found.update(crowd.counted)
            else:
                found.update(self._large if cell is None else self._cells.get(cell, {}))
        return list(found)

    def counts(self, solid: Solid) -> bool:
        """Whether it does anywhere."""
        if not self.crowds:
            return True
        own = (self.crowds.get(cell) for cell in _cells(solid.bounds) or (_LARGE,))
        return any(crowd is None or solid in crowd.counted for crowd in own)

    def is_crowded(self, solid: Solid) -> bool:
        """Whether it is in a crowd, which may have members that do not count."""
        return bool(self.crowds) and not self.crowds.keys().isdisjoint(_cells(solid.bounds) or (_LARGE,))

    def describe_crowds(self, names: Collection[str] | None = None) -> list[str]:
        """Where not all count, a sentence each, the most crowded first; with `names`, where one of these is.

        What is beside a cell that is told of is left out.
        """
        if not self.crowds:
            return []
        found = [
            (-len(crowd), (0, 0) if cell is None else cell, cell is None)
            for cell, crowd in self.crowds.items()
            if len(crowd) > crowds.MOST and (names is None or crowd.has_any(names))
        ]
        told: list[tuple[int, Cell, bool]] = []
        for count, cell, is_large in sorted(found):
            if not any(_adjoin(cell, other) and is_large == large for _, other, large in told):
                told.append((count, cell, is_large))
        return [crowds.describe_crowd(-count, None if large else cell, CELL_M) for count, cell, large in told]

    def _filed(self, cells: list[Cell] | None) -> Iterable[Solid]:
        """Once each who is filed under some cells; under all for None."""
        if cells is not None and len(cells) == 1 and not self._large:
            return self._cells.get(cells[0], ())
        found = self._large.copy()
        for cell in self._cells if cells is None else cells:
            if cell in self._cells:
                found.update(self._cells[cell])
        return found


def _adjoin(one: Cell, other: Cell) -> bool:
    return abs(one[0] - other[0]) <= 1 and abs(one[1] - other[1]) <= 1


def _cells(bounds: Bounds) -> list[Cell] | None:
    """The cells that some bounds cover; None for too many."""
    low_x, low_y, high_x, high_y = bounds
    x0, y0 = int(low_x // CELL_M), int(low_y // CELL_M)
    x1, y1 = int(high_x // CELL_M), int(high_y // CELL_M)
    if x0 == x1 and y0 == y1:
        return [(x0, y0)]
    if (x1 - x0 + 1) * (y1 - y0 + 1) > MOST_CELLS:
        return None
    return [(x, y) for x in range(x0, x1 + 1) for y in range(y0, y1 + 1)]
