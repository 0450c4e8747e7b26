"""Supports: level planes on which things may stand, and which of them is below a thing."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from semmap.nodes.perception_node.input.cloud import Floats
from semmap.nodes.perception_node.views.boxes import Numbers

_FLOOR_M = 0.06
"""What is no higher is the floor, which goes on where nobody sees it."""
_MARGIN_M = 0.4
"""A support may go on for this much where it is hidden."""
_BELOW = 0.5
"""A support is below a thing if it is below this share of the thing's outline, both taken as rectangles."""
_STRAY = 0.01
"""So many of its points may lie elsewhere, on either side."""
_SMALLER = 0.7
"""Nothing stands on what is smaller than this share of its own outline."""


class Support(NamedTuple):
    """A level plane, as far as it is seen: its height [m], and the rectangle around it along the map's axes.

    `low_m`, `high_m`: (x, y), map frame; without them it extends everywhere. `area_m2`: that of the rectangle
    around its largest piece.
    """

    height_m: float
    low_m: tuple[float, float] = (-np.inf, -np.inf)
    high_m: tuple[float, float] = (np.inf, np.inf)
    area_m2: float = np.inf

    def is_below(self, low: Numbers, high: Numbers) -> bool:
        """Whether it may bear a thing whose lowest and highest corner are `low` and `high` (3,) [m].

        Seats around a table are level with one another, but the table stands on none of them.
        """
        if self.height_m < _FLOOR_M:
            return True
        sides = np.maximum((high - low)[:2], 1e-3)
        ends, begins = np.asarray(self.high_m) + _MARGIN_M, np.asarray(self.low_m) - _MARGIN_M
        shared = np.minimum(high[:2], ends) - np.maximum(low[:2], begins)
        is_over = np.prod(np.clip(shared / sides, 0.0, 1.0)) >= _BELOW
        return bool(is_over and self.area_m2 >= _SMALLER * sides.prod())


def support_of(points: Floats, where: NDArray[np.bool_]) -> Support:
    """That of some points of a view (h, w, 3), map frame, a level plane."""
    pieces, _ = ndimage.label(where)
    own, piece = points[where], pieces[where]
    low, high = np.quantile(own[:, :2], [_STRAY, 1.0 - _STRAY], axis=0).tolist()
    largest = own[piece == np.bincount(piece).argmax()]
    area_m2 = float(np.ptp(largest[:, 0]) * np.ptp(largest[:, 1]))
    return Support(float(np.median(own[:, 2])), (low[0], low[1]), (high[0], high[1]), area_m2)


def height_below(
    supports: Iterable[Support], low: Numbers, high: Numbers, *, most_m: float, floor_m: float
) -> float:
    """How high the highest support is that is below a thing (corners as above); else `floor_m`.

    Supports that are as high as `most_m` do not count.
    """
    heights = (s.height_m for s in supports if s.height_m < most_m and s.is_below(low, high))
    return max(heights, default=floor_m)
