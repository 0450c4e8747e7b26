"""Detects whether a narrow passage is a door: a gap in a wall, not between furniture and a wall."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from scipy import ndimage

from semmap.nodes.navigation.grid import Mask

_THIN_M: Final = 0.35
_THICK_M: Final = 0.55
"""Inside walls are thin. For thicker walls, up to this, both ends must be visible."""
_DEEP_M: Final = 0.25
"""A wall continues for at least this length behind its end, in line with the gap."""
_STUB_CELLS: Final = 2
"""Length of the stubs of wall beside a door at the end of a corridor."""
_GROWTH: Final = 1.5
_STUB_GROWTH: Final = 1.0
"""Maximum increase of a wall's thickness along its length [cells]."""
_ASKEW: Final = 0.3
"""Maximum deviation of a wall from the line, as a share of its length."""
_OFFSET_CELLS: Final = 2.5
_HALF: Final = 0.5
"""Step, in cells, by which a thickness is measured."""

Spot = tuple[float, float]
"""Row and column, or an offset along each, in cells."""


class Jambs:
    """The ends of walls in a grid.

    Behind its end, a wall continues in line with the gap, thin and with constant thickness. The side of a
    room extends across that line, furniture is thicker than a wall, and a corner of either gets thicker
    inwards. One such wall makes a door, since the other side may be flush with another wall or have furniture
    beside it. If the walls are short or thick, both sides must be walls.
    """

    def __init__(self, free: Mask, resolution: float) -> None:
        """Prepare the grid. `free` are the free cells; `resolution` is the side of a cell [m]."""
        self._taken = np.pad(~free, 1, constant_values=True)
        self._nearest = ndimage.distance_transform_edt(
            ~self._taken, return_distances=False, return_indices=True
        )
        self._thin, self._thick = _THIN_M / resolution, _THICK_M / resolution
        self._deep = max(_STUB_CELLS, math.ceil(_DEEP_M / resolution))

    def are_at(self, row: int, column: int) -> bool:
        """Return whether there is a door at a free cell in the middle of a narrow passage."""
        here = (float(row + 1), float(column + 1))
        one = self._nearest_to(here)
        away = _unit(one, here)
        other = self._nearest_to((here[0] + _OFFSET_CELLS * away[0], here[1] + _OFFSET_CELLS * away[1]))
        along = _unit(other, one)
        ends = (self._behind(one, along), self._behind(other, (-along[0], -along[1])))
        return (
            any(len(end) == self._deep and self._is_wall(end) for end in ends)
            or all(len(end) >= _STUB_CELLS and self._is_stub(end[:_STUB_CELLS]) for end in ends)
            or all(len(end) == self._deep for end in ends)
        )

    def _is_wall(self, thicknesses: list[float]) -> bool:
        """Return whether an obstacle with these thicknesses, cell by cell from its end, is a thin wall."""
        end, behind, *_ = thicknesses
        return max(thicknesses) <= min(self._thin, behind + _GROWTH) and behind <= end + _GROWTH + 1.0

    def _is_stub(self, thicknesses: list[float]) -> bool:
        """Return whether it is a thin wall, as far as few cells show."""
        return max(thicknesses) <= min(self._thin, thicknesses[0] + _STUB_GROWTH)

    def _nearest_to(self, spot: Spot) -> Spot:
        row, column = self._clipped(spot)
        return float(self._nearest[0, row, column]), float(self._nearest[1, row, column])

    def _behind(self, end: Spot, along: Spot) -> list[float]:
        """Return the thickness of an obstacle behind its end, cell by cell, as far as it may be a wall.

        The centre line is followed, since the nearest point may be either corner of the end.
        """
        side = (-along[1], along[0])
        found: list[float] = []
        offset, began = 0.0, 0.0
        for depth in range(self._deep):
            shifts = (offset, offset + 1.0, offset - 1.0)
            spots = [tuple(end[i] + depth * along[i] + shift * side[i] for i in (0, 1)) for shift in shifts]
            k = next((k for k, (row, column) in enumerate(spots) if self._is_taken((row, column))), None)
            if k is None:
                break
            row, column = spots[k]
            there = self._reach((row, column), side)
            back = self._reach((row, column), (-side[0], -side[1]))
            offset = shifts[k] + (there - back) / 2.0
            if depth <= _STUB_CELLS:
                began = offset
            if 1.0 + there + back > self._thick or abs(offset - began) > _ASKEW * (depth - 1) + 0.5:
                break
            found.append(1.0 + there + back)
        return found

    def _reach(self, spot: Spot, side: Spot) -> float:
        reach = 0.0
        while reach <= self._thick:
            step = reach + _HALF
            if not self._is_taken((spot[0] + step * side[0], spot[1] + step * side[1])):
                break
            reach = step
        return reach

    def _is_taken(self, spot: Spot) -> bool:
        return bool(self._taken[self._clipped(spot)])

    def _clipped(self, spot: Spot) -> tuple[int, int]:
        height, width = self._taken.shape
        return min(max(round(spot[0]), 0), height - 1), min(max(round(spot[1]), 0), width - 1)


def _unit(start: Spot, end: Spot) -> Spot:
    down, right = end[0] - start[0], end[1] - start[1]
    length = math.hypot(down, right) or 1.0
    return down / length, right / length
