"""Crowds: limits on the neighbours considered where very many objects are in one spot."""

from __future__ import annotations

from bisect import bisect_left, insort
from collections.abc import Collection, Iterable
from typing import Final

from semmap.nodes.kb_node.relations.geometry.solids import Solid

MOST: Final = 100
"""The most objects in one grid cell that are considered as neighbours. Others support and contain nothing.

Objects that are not counted are compared with larger ones only, so that a heap of equal objects stays
cheap.
"""
_WHAT: Final = "(on, inside, beside)"


class Crowd:
    """The objects in one cell, of which the largest are counted.

    Of equal ones the first by name is counted, and places always are. So a full table or drawer is counted,
    and the result depends on the map alone.
    """

    def __init__(self, solids: Iterable[Solid]) -> None:
        self._ranked: Final = sorted(_ranked(solid) for solid in solids if not solid.is_place)
        self._solids = {solid.name: solid for solid in solids}
        self.counted: Final[dict[Solid, None]] = {s: None for s in solids if s.is_place}
        self.counted.update((self._solids[name], None) for _, name in self._ranked[:MOST])

    def __len__(self) -> int:
        """Return the number of objects, counted or not."""
        return len(self._ranked)

    def has_any(self, names: Collection[str]) -> bool:
        """Return whether one of these names is present, counted or not."""
        return not self._solids.keys().isdisjoint(names)

    def add(self, solid: Solid) -> Solid | None:
        """Add a solid and return the one that is no longer counted because of it."""
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
        """Remove a solid and return the one that is now counted because of it."""
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


def describe_crowd(count: int, cell: tuple[int, int] | None, cell_m: float) -> str:
    """Return the notice for a crowd in a cell. None is the list of very large objects."""
    where = "too large for the spatial index"
    if cell is not None:
        x, y = ((place + 0.5) * cell_m for place in cell)
        where = f"within {cell_m:g} m of ({x:g}, {y:g})"
    return f"{count} objects are {where}; relations {_WHAT} are computed only with the {MOST} largest"


def _ranked(solid: Solid) -> tuple[float, str]:
    return -solid.volume, solid.name
