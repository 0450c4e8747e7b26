"""Outliers of a set of points, which a view of the whole leaves out."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

_FAR: Final = 4.0
_FAR_M: Final = 3.0


def find_near(points_m: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return (N,) which of these points (N, 3) are not outliers.

    An outlier is farther from the median than four times the 80 % quantile of the distances, plus 3 m.
    """
    if not len(points_m):
        return np.zeros(0, dtype=bool)
    apart = np.linalg.norm(points_m - np.median(points_m, axis=0), axis=1)
    return np.asarray(apart <= _FAR * np.quantile(apart, 0.8, method="lower") + _FAR_M)
