"""Whether a narrow place is a door: a gap in a wall, rather than one between furniture and a wall."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from scipy import ndimage

from semmap.nodes.navigation.grid import Mask

_THIN_M: Final = 0.35
_THICK_M: Final = 0.55
"""Walls inside a building are thin; of those that are thicker, up to this, both ends must be seen."""
_DEEP_M: Final = 0.25
"""For so long a wall goes on behind its end, in line with the gap."""
_STUB_CELLS: Final = 2
"""So short are the stubs of wall beside a door at the end of a corridor."""
_GROWTH: Final = 1.5
_STUB_GROWTH: Final = 1.0
"""By how much a wall may get thicker on the way [cells]."""
_ASKEW: Final = 0.3
"""By which share of its length a wall may lead off the line."""
_ASIDE_CELLS: Final = 2.5
_HALF: Final = 0.5
"""Of a cell: the step by which a thickness is measured."""

Spot = tuple[float, float]
"""Row and column, or how far along each, in cells."""


class Jambs:
    """The ends of walls in a grid.

    Behind its end a wall goes on in line with the gap, thin and no thicker further in. The side of a room
    is long across that line, furniture is thicker than a wall, and the corner of either, which a gap may
    meet askew, gets thicker inwards. One such wall makes a door, since the other side may be flush with
    another wall, or have furniture beside it; two do if they are short, or thick.
    """

    def __init__(self, free: Mask, resolution: float) -> None:
        """`free` are the free cells; `resolution` is the side of a cell [m]."""
        self._taken = np.pad(~free, 1, constant_values=True)
        self._nearest = ndimage.distance_transform_edt(
            ~self._taken, return_distances=False, return_indices=True
        )
        self._thin, self._thick = _THIN_M / resolution, _THICK_M / resolution
        self._deep = max(_STUB_CELLS, math.ceil(_DEEP_M / resolution))

    def are_at(self, row: int, column: int) -> bool:
        """Whether there is a door at a free cell in the middle of a narrow place."""
        here = (float(row + 1), float(column + 1))
        one = self._nearest_to(here)
        away = _unit(one, here)
        other = self._nearest_to((here[0] + _ASIDE_CELLS * away[0], here[1] + _ASIDE_CELLS * away[1]))
        along = _unit(other, one)
        ends = (self._behind(one, along), self._behind(other, (-along[0], -along[1])))
        return (
            any(len(end) == self._deep and self._is_wall(end) for end in ends)
            or all(len(end) >= _STUB_CELLS and self._is_stub(end[:_STUB_CELLS]) for end in ends)
            or all(len(end) == self._deep for end in ends)
        )

    def _is_wall(self, thicknesses: list[float]) -> bool:
        """Whether something that is so thick, cell by cell from its end on, is a thin wall."""
        end, behind, *_ = thicknesses
        return max(thicknesses) <= min(self._thin, behind + _GROWTH) and behind <= end + _GROWTH + 1.0

    def _is_stub(self, thicknesses: list[float]) -> bool:
        """Whether it is a thin wall as far as that can be told of so few cells."""
        return max(thicknesses) <= min(self._thin, thicknesses[0] + _STUB_GROWTH)

    def _nearest_to(self, spot: Spot) -> Spot:
        row, column = self._clipped(spot)
        return float(self._nearest[0, row, column]), float(self._nearest[1, row, column])

    def _behind(self, end: Spot, along: Spot) -> list[float]:
        """How thick an obstacle is behind its end, cell by cell along a line, as far as it might be a wall.

        Its middle is followed, since what is nearest may be either corner of its end.
        """
        side = (-along[1], along[0])
        found: list[float] = []
        aside, began = 0.0, 0.0
        for depth in range(self._deep):
            shifts = (aside, aside + 1.0, aside - 1.0)
            spots = [tuple(end[i] + depth * along[i] + shift * side[i] for i in (0, 1)) for shift in shifts]
            k = next((k for k, (row, column) in enumerate(spots) if self._is_taken((row, column))), None)
            if k is None:
                break
            row, column = spots[k]
            there = self._reach((row, column), side)
            back = self._reach((row, column), (-side[0], -side[1]))
            aside = shifts[k] + (there - back) / 2.0
            if depth <= _STUB_CELLS:
                began = aside
            if 1.0 + there + back > self._thick or abs(aside - began) > _ASKEW * (depth - 1) + 0.5:
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
