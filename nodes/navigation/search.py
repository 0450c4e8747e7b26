"""Shortest paths over the free cells of a grid: A* with eight neighbours, then shortcuts in line of sight."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from heapq import heappop, heappush
from typing import Final

import numpy as np

from semmap.nodes.navigation.grid import Mask

Cell = tuple[int, int]
"""Row and column."""

_STEPS: Final = tuple(
    (dy, dx, math.hypot(dy, dx)) for dy in (-1, 0, 1) for dx in (-1, 0, 1) if (dy, dx) != (0, 0)
)

_DIAGONALLY: Final = math.sqrt(2.0) - 1.0


def shortest_path(free: Mask, starts: Iterable[Cell], goals: Iterable[Cell]) -> list[Cell] | None:
    """Return the cells of a shortest path from a start to a goal; None if there is no path.

    A diagonal step requires both adjacent cells to be free. Among paths of equal length, the result is
    deterministic.
    """
    height, width = free.shape
    across = width + 2
    open_ = np.zeros((height + 2, across), dtype=bool)
    open_[1:-1, 1:-1] = free
    is_free = open_.ravel().tolist()
    ends = {(row + 1) * across + column + 1 for row, column in goals}
    ends = {end for end in ends if is_free[end]}
    if not ends:
        return None
    rows, columns = [end // across for end in ends], [end % across for end in ends]
    low, high, left, right = min(rows), max(rows), min(columns), max(columns)
    steps = [(dy * across + dx, dy * across, dx, cost) for dy, dx, cost in _STEPS]

    def rest(cell: int) -> float:
        """Return a lower bound of the distance to the goals: octile distance to their bounding rectangle."""
        row, column = divmod(cell, across)
        dy = max(low - row, row - high, 0)
        dx = max(left - column, column - right, 0)
        octile: float = max(dy, dx) + _DIAGONALLY * min(dy, dx)
        return octile

    costs: dict[int, float] = {}
    before: dict[int, int] = {}
    queue: list[tuple[float, int]] = []
    for row, column in starts:
        start = (row + 1) * across + column + 1
        if is_free[start] and start not in costs:
            costs[start] = 0.0
            heappush(queue, (rest(start), start))
    done: set[int] = set()
    while queue:
        _, cell = heappop(queue)
        if cell in done:
            continue
        done.add(cell)
        if cell in ends:
            return _back(cell, before, across)
        cost = costs[cell]
        for step, up, over, length in steps:
            other = cell + step
            if not is_free[other] or other in done:
                continue
            if up and over and not (is_free[cell + up] and is_free[cell + over]):
                continue
            further = cost + length
            if further < costs.get(other, math.inf):
                costs[other] = further
                before[other] = cell
                heappush(queue, (further + rest(other), other))
    return None


def _back(cell: int, before: dict[int, int], across: int) -> list[Cell]:
    found = [cell]
    while cell in before:
        cell = before[cell]
        found.append(cell)
    return [(c // across - 1, c % across - 1) for c in reversed(found)]


def without_detours(cells: Sequence[Cell], free: Mask) -> list[Cell]:
    """Return the corners of a path after connecting each to the farthest one in line of sight."""
    kept = [cells[0]]
    at = 0
    while at < len(cells) - 1:
        step, furthest = 1, at + 1
        while at + step < len(cells) and in_line_of_sight(cells[at], cells[at + step], free):
            furthest = at + step
            step *= 2
        low, high = furthest, min(len(cells) - 1, at + step)
        while low < high:
            middle = (low + high + 1) // 2
            if in_line_of_sight(cells[at], cells[middle], free):
                low = middle
            else:
                high = middle - 1
        at = low
        kept.append(cells[at])
    return kept


def in_line_of_sight(one: Cell, other: Cell, free: Mask) -> bool:
    """Return whether all cells on the line between the centres of two cells are free."""
    (y0, x0), (y1, x1) = one, other
    count = 2 * max(abs(y1 - y0), abs(x1 - x0)) + 1
    shares = np.linspace(0.0, 1.0, max(count * 2, 2))
    rows = np.rint(y0 + (y1 - y0) * shares).astype(np.int64)
    columns = np.rint(x0 + (x1 - x0) * shares).astype(np.int64)
    return bool(free[rows, columns].all())
