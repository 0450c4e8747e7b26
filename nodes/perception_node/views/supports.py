"""Supports: level planes on which things may stand, and the one below a thing."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from semmap.nodes.perception_node.input.cloud import Floats
from semmap.nodes.perception_node.views.boxes import Numbers

_FLOOR_M = 0.06
"""A lower support is the floor, which extends everywhere."""
_MARGIN_M = 0.4
"""A support may extend by this much where it is hidden."""
_BELOW = 0.5
"""A support is below a thing if it covers this share of the outline, both as rectangles."""
_STRAY = 0.01
"""Share of outliers on either side."""
_SMALLER = 0.7
"""Nothing stands on a support smaller than this share of its outline."""


class Support(NamedTuple):
    """The visible part of a level plane: its height [m], and the bounding rectangle along the map's axes.

    `low_m`, `high_m`: (x, y), map frame; by default unlimited. `area_m2`: the area of the rectangle around
    its largest piece.
    """

    height_m: float
    low_m: tuple[float, float] = (-np.inf, -np.inf)
    high_m: tuple[float, float] = (np.inf, np.inf)
    area_m2: float = np.inf

    def is_below(self, low: Numbers, high: Numbers) -> bool:
        """Return whether it may support a thing with the corners `low` and `high` (3,) [m].

        Seats around a table are level with each other, but the table does not stand on them.
        """
        if self.height_m < _FLOOR_M:
            return True
        sides = np.maximum((high - low)[:2], 1e-3)
        ends, begins = np.asarray(self.high_m) + _MARGIN_M, np.asarray(self.low_m) - _MARGIN_M
        shared = np.minimum(high[:2], ends) - np.maximum(low[:2], begins)
        is_over = np.prod(np.clip(shared / sides, 0.0, 1.0)) >= _BELOW
        return bool(is_over and self.area_m2 >= _SMALLER * sides.prod())


def support_of(points: Floats, where: NDArray[np.bool_]) -> Support:
    """Return the support of a level plane, given points of a view (h, w, 3), map frame."""
    pieces, _ = ndimage.label(where)
    own, piece = points[where], pieces[where]
    low, high = np.quantile(own[:, :2], [_STRAY, 1.0 - _STRAY], axis=0).tolist()
    largest = own[piece == np.bincount(piece).argmax()]
    area_m2 = float(np.ptp(largest[:, 0]) * np.ptp(largest[:, 1]))
    return Support(float(np.median(own[:, 2])), (low[0], low[1]), (high[0], high[1]), area_m2)


def height_below(
    supports: Iterable[Support], low: Numbers, high: Numbers, *, most_m: float, floor_m: float
) -> float:
    """Return the height of the highest support below a thing (corners as above); else `floor_m`.

    Supports as high as `most_m` are ignored.
    """
    heights = (s.height_m for s in supports if s.height_m < most_m and s.is_below(low, high))
    return max(heights, default=floor_m)
