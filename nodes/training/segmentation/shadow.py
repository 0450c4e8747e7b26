"""The shadow of a Kinect's projector."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_FOCAL_BASELINE_PX_M, _NEAREST_M = 525.0 * 0.075, 0.3
_MARGIN_PX = 1.0


def shadowed(depth_m: NDArray[np.float32]) -> NDArray[np.bool_]:
    """(H, W) what a Kinect's projector does not light, because something nearer is in its way.

    A pixel's disparity says in which of the projector's columns it is. A row's columns rise from left to
    right, but for what is behind: it shares its column with something farther right.
    """
    disparity = _FOCAL_BASELINE_PX_M / np.maximum(depth_m, _NEAREST_M)
    column = np.where(depth_m > 0, np.arange(depth_m.shape[1]) - disparity, np.inf)
    lowest_right = np.minimum.accumulate(column[:, ::-1], axis=1)[:, ::-1]
    return (depth_m > 0) & (column > lowest_right + _MARGIN_PX)
