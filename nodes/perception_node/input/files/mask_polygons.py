"""Masks drawn as polygons, as in COCO datasets. Pure."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

_FARTHEST_PX = 1e6


def counts_of(polygons: Sequence[Any], height: int, width: int) -> list[int]:
    """Return the column-wise run lengths of the area of polygons `[x, y, x, y, ...]` [pixel].

    The image corner is at 0, and a pixel is inside if its centre is. Raises ValueError for invalid polygons.
    """
    mask = np.zeros((height, width), dtype=bool)
    for polygon in polygons:
        mask |= _filled(_corners(polygon), height, width)
    return counts_in(mask)


def counts_in(mask: NDArray[np.bool_]) -> list[int]:
    """Return the column-wise run lengths of a mask (H, W), the first of background."""
    column = np.concatenate([[False], mask.T.ravel(), [False]])
    changes = np.flatnonzero(column[1:] != column[:-1])
    return [int(run) for run in np.diff([0, *changes, mask.size])]


def _corners(polygon: Any) -> NDArray[np.float64]:
    """Return the corners (N, 2) of a polygon. Raises ValueError."""
    numbers = polygon if isinstance(polygon, list) else []
    if len(numbers) < 6 or len(numbers) % 2 or not all(isinstance(n, int | float) for n in numbers):
        raise ValueError("a mask's polygon needs x and y of at least three corners: [x, y, x, y, x, y]")
    if max(map(abs, numbers)) > _FARTHEST_PX:
        raise ValueError("a mask's polygon has a corner far outside the image")
    return np.array(numbers, dtype=float).reshape(-1, 2)


def _filled(corners: NDArray[np.float64], height: int, width: int) -> NDArray[np.bool_]:
    """Return the pixels (H, W) inside, by the even-odd rule on each row."""
    mask = np.zeros((height, width), dtype=bool)
    (x, y), (next_x, next_y) = corners.T, np.roll(corners, -1, axis=0).T
    for row in range(max(0, math.floor(y.min())), min(height, math.ceil(y.max()))):
        middle = row + 0.5
        cross = (y <= middle) != (next_y <= middle)
        along = (middle - y[cross]) / (next_y[cross] - y[cross])
        at = np.sort(x[cross] + along * (next_x[cross] - x[cross]))
        first = np.clip(np.ceil(at - 0.5), 0, width).astype(int).tolist()
        for begin, end in zip(first[::2], first[1::2], strict=True):
            mask[row, begin:end] = True
    return mask
