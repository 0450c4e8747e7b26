"""A point cloud of one depth camera."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]
Transform = NDArray[np.float64]

FEWEST_POINTS = 10
"""Minimum number of points of a usable cloud."""
NEAREST_M, FARTHEST_M = 0.01, 100.0
"""Depth beyond these limits is invalid."""
_THIN = 16
"""Every so many points are used to compute `near_m`, which saves time."""


@dataclass(frozen=True)
class Cloud:
    """The points of one frame, organised in the rows and columns of the image or in a single row.

    `points_camera`: (H, W, 3), camera frame (x right, y down, z forward) [m], NaN for no measurement.
    `colors`: (H, W, 3) rgb, or None. `map_from_camera`: (4, 4), or None if unknown. `intrinsics`: (3, 3)
    [pixel], or None for a cloud from a file. `notes`: doubts about its source, for the user.
    """

    points_camera: Floats
    colors: NDArray[np.uint8] | None = None
    map_from_camera: Transform | None = None
    intrinsics: Transform | None = None
    camera: str = ""
    stamp_ns: int = 0
    notes: tuple[str, ...] = ()

    @property
    def organised(self) -> bool:
        """Return whether neighbours in the array are neighbours in the image."""
        return len(self.points_camera) > 1

    @property
    def near_m(self) -> float:
        """Return the 5 % quantile of the depth [m]; infinite for an empty cloud."""
        depth_m = self.points_camera.reshape(-1, 3)[::_THIN, 2]
        depth_m = depth_m[depth_m > 0]
        return float(np.quantile(depth_m, 0.05)) if len(depth_m) else np.inf

    @property
    def measured(self) -> int:
        """Return the number of points in front of the camera."""
        return int(np.count_nonzero(self.points_camera[..., 2] > 0))
