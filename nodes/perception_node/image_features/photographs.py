"""Tells photographs from renderings."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_EVERY = 4
"""Every so many rows are compared."""
_EVEN = 0.6
"""Share of neighbours of one colour in a rendering. It was 0.9 or more in renderings, 0.35 or less in photographs."""


def is_photograph(colours: NDArray[np.uint8]) -> bool:
    """Return whether an image (H, W, 3) is from a real camera.

    The noise of a sensor makes neighbouring pixels differ, and surfaces of a renderer have even colours. Pixels
    without a measurement, which are black, and overexposed ones are not counted.
    """
    rows = colours[::_EVERY]
    pixels = rows[:, 1:]
    measured = ((pixels > 0) & (pixels < 255)).any(axis=-1)
    even = measured & (pixels == rows[:, :-1]).all(axis=-1)
    return bool(np.count_nonzero(even) < _EVEN * np.count_nonzero(measured))
