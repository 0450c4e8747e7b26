"""Where very many things are in one spot: which of them count as neighbours, so that work stays bounded."""

from __future__ import annotations

from bisect import bisect_left, insort
from collections.abc import Collection, Iterable
from typing import Final

from semmap.nodes.kb_node.relations.geometry.solids import Solid

MOST: Final = 100
"""Things in one cell of the grid that others look at; the rest bears, holds and is near nothing.

And only what is larger bears or holds one of the rest, so that in a heap of things of one size not every one
has to be compared with so many.
"""
_WHAT: Final = "on, inside or beside"


class Crowd:
    """What is in one cell. The largest things count, of equal ones the first by name; places all do.

    So a table or a drawer that is full counts, and who counts is a function of the map alone.
    """

    def __init__(self, solids: Iterable[Solid]) -> None:
        self._ranked: Final = sorted(_ranked(solid) for solid in solids if not solid.is_place)
        self._solids = {solid.name: solid for solid in solids}
        self.counted: Final[dict[Solid, None]] = {s: None for s in solids if s.is_place}
        self.counted.update((self._solids[name], None) for _, name in self._ranked[:MOST])

    def __len__(self) -> int:
        """How many things there are, whether they count or not."""
        return len(self._ranked)

    def has_any(self, names: Collection[str]) -> bool:
        """Whether one of these is there, whether it counts or not."""
        return not self._solids.keys().isdisjoint(names)

    def add(self, solid: Solid) -> Solid | None:
        """One more; who does not count any more because of it."""
        self._solids[solid.name] = solid
        if solid.is_place:
            self.counted[solid] = None
            return None
        insort(self._ranked, _ranked(solid))
        left_out = self._at(MOST)
        if left_out is solid or (left_out is not None and left_out not in self.counted):
            return None
        self.counted[solid] = None
        if left_out is not None:
            del self.counted[left_out]
        return left_out

    def remove(self, solid: Solid) -> Solid | None:
        """One less; who counts now because of it."""
        del self._solids[solid.name]
        was_counted = solid in self.counted
        if was_counted:
            del self.counted[solid]
        if solid.is_place:
            return None
        del self._ranked[bisect_left(self._ranked, _ranked(solid))]
        last = self._at(MOST - 1) if was_counted else None
        if last is not None:
            self.counted[last] = None
        return last

    def _at(self, rank: int) -> Solid | None:
        return self._solids[self._ranked[rank][1]] if rank < len(self._ranked) else None


def describe_crowd(things: int, cell: tuple[int, int] | None, cell_m: float) -> str:
    """What is to be said of so many in a cell; None is that of what is very large."""
    where = "too large for the spatial index"
    if cell is not None:
        x, y = ((place + 0.5) * cell_m for place in cell)
        where = f"within {cell_m:g} m of ({x:g}, {y:g})"
    return f"{things} things are {where}: what they are {_WHAT} is looked for among the {MOST} largest"


def _ranked(solid: Solid) -> tuple[float, str]:
    return -solid.volume, solid.name
