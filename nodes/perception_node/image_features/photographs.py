"""Distinguishes photographs from renderings."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_EVERY = 16
"""Every so many rows are compared."""
_EVEN = 0.7
"""Least share of equal neighbours in a rendering. Renderings had 0.80 to 0.99, photographs 0.01 to 0.31, and
up to 0.58 as JPEG of quality 50."""


def is_photograph(colours: NDArray[np.uint8]) -> bool:
    """Return whether an image (H, W, 3) is from a real camera.

    The noise of a sensor makes neighbouring pixels differ, and surfaces of a renderer have even colours.
    Pixels without a measurement, which are black, and overexposed ones are not counted.
    """
    rows = colours[::_EVERY]
    pixels = rows[:, 1:]
    measured = ((pixels > 0) & (pixels < 255)).any(axis=-1)
    even = measured & (pixels == rows[:, :-1]).all(axis=-1)
    return bool(np.count_nonzero(even) < _EVEN * np.count_nonzero(measured))
