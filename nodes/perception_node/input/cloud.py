"""A point cloud from one depth camera."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]
Transform = NDArray[np.float64]

FEWEST_POINTS = 10
"""In fewer nothing can be found."""
NEAREST_M, FARTHEST_M = 0.01, 100.0
"""No depth camera measures as near, or as far."""
_THIN = 16
"""One point in so many tells what is near: 0.5 ms a picture instead of 4."""


@dataclass(frozen=True)
class Cloud:
    """Points of one frame. Organised as the picture's rows and columns, else in a single row.

    `points_camera`: (H, W, 3), camera frame (x right, y down, z forward) [m], NaN where nothing was seen.
    `colors`: (H, W, 3) rgb, or None. `map_from_camera`: (4, 4), or None where nobody knows.
    `intrinsics`: (3, 3) [pixel], or None for a cloud from a file.
    """

    points_camera: Floats
    colors: NDArray[np.uint8] | None = None
    map_from_camera: Transform | None = None
    intrinsics: Transform | None = None
    camera: str = ""
    stamp_ns: int = 0

    @property
    def organised(self) -> bool:
        """Whether neighbours in the array are neighbours in the picture."""
        return len(self.points_camera) > 1

    @property
    def near_m(self) -> float:
        """Depth beyond which nearly all was seen, a twentieth being nearer [m]; infinite if nothing was."""
        depth_m = self.points_camera.reshape(-1, 3)[::_THIN, 2]
        depth_m = depth_m[depth_m > 0]
        return float(np.quantile(depth_m, 0.05)) if len(depth_m) else np.inf

    @property
    def measured(self) -> int:
        """How many points were seen in front of the camera."""
        return int(np.count_nonzero(self.points_camera[..., 2] > 0))
