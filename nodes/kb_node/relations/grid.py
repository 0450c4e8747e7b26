"""A spatial index: which solids are in which cells of a grid on the floor plan."""

from __future__ import annotations

from collections.abc import Iterable

from nodes.kb_node.relations.forms import Bounds
from nodes.kb_node.relations.solids import Solid

CELL_M = 1.0
MOST_CELLS = 1024
"""What covers more is in no cell, but in a list that every question looks through."""


class Grid:
    """Solids by cell. A question costs as much as there is around the place that it asks about."""

    def __init__(self) -> None:
        self._cells: dict[tuple[int, int], dict[Solid, None]] = {}
        self._large: dict[Solid, None] = {}

    def add(self, solid: Solid) -> None:
        """File a solid under the cells that its bounds cover."""
        cells = _cells(solid.bounds)
        if cells is None:
            self._large[solid] = None
            return
        for cell in cells:
            self._cells.setdefault(cell, {})[solid] = None

    def remove(self, solid: Solid) -> None:
        """Take it out; with the bounds that it was filed under."""
        if self._large.pop(solid, self) is None:
            return
        for cell in _cells(solid.bounds) or ():
            there = self._cells[cell]
            del there[solid]
            if not there:
                del self._cells[cell]

    def around(self, bounds: Bounds, margin_m: float = 0.0) -> list[Solid]:
        """Whose bounds meet these, or are within a margin of them."""
        x0, y0, x1, y1 = bounds
        x0, y0, x1, y1 = x0 - margin_m, y0 - margin_m, x1 + margin_m, y1 + margin_m
        return [
            solid
            for solid in self._filed(_cells((x0, y0, x1, y1)))
            if (its := solid.bounds)[0] <= x1 and its[2] >= x0 and its[1] <= y1 and its[3] >= y0
        ]

    def _filed(self, cells: list[tuple[int, int]] | None) -> Iterable[Solid]:
        """Once each who is filed under some cells; under all for None."""
        if cells is not None and len(cells) == 1 and not self._large:
            return self._cells.get(cells[0], ())
        found = dict(self._large)
        for cell in self._cells if cells is None else cells:
            found.update(self._cells.get(cell, {}))
        return found


def _cells(bounds: Bounds) -> list[tuple[int, int]] | None:
    """The cells that some bounds cover; None for too many."""
    low_x, low_y, high_x, high_y = bounds
    x0, y0 = int(low_x // CELL_M), int(low_y // CELL_M)
    x1, y1 = int(high_x // CELL_M), int(high_y // CELL_M)
    if x0 == x1 and y0 == y1:
        return [(x0, y0)]
    if (x1 - x0 + 1) * (y1 - y0 + 1) > MOST_CELLS:
        return None
    return [(x, y) for x in range(x0, x1 + 1) for y in range(y0, y1 + 1)]
