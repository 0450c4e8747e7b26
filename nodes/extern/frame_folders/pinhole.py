"""The intrinsics of a recorded camera [pixel], with the corner of the image at 0."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.projection import check_intrinsics

_SAME_SHAPE = 0.02


def from_pixel_centres(fx: float, fy: float, cx: float, cy: float) -> NDArray[np.float64]:
    """Return the matrix (3, 3) of intrinsics relative to the centre of the first pixel, as in OpenCV."""
    return np.array([[fx, 0.0, cx + 0.5], [0.0, fy, cy + 0.5], [0.0, 0.0, 1.0]])


def from_camera_info(info: Any, *, rectified: bool) -> NDArray[np.float64]:
    """Return the matrix (3, 3) of a `sensor_msgs/CameraInfo`; for a rectified image, from its projection."""
    k = np.asarray(info.k if hasattr(info, "k") else info.K, float)
    p = np.asarray(info.p if hasattr(info, "p") else info.P, float)
    if rectified and p[0] > 0 and p[5] > 0:
        return from_pixel_centres(p[0], p[5], p[2], p[6])
    return from_pixel_centres(k[0], k[4], k[2], k[5])


def scale_intrinsics(
    intrinsics: NDArray[np.float64], of: tuple[int, int], to: tuple[int, int]
) -> NDArray[np.float64]:
    """Scale intrinsics from images of (width, height) `of` to the size `to`.

    Raises ValueError for another aspect ratio, or invalid intrinsics.
    """
    width, height = to
    if min(of) < 1:
        of = to
    across, down = width / of[0], height / of[1]
    if abs(across / down - 1.0) > _SAME_SHAPE:
        raise ValueError(
            f"the intrinsics are for {of[0]} x {of[1]} pixels, the images have {width} x {height} pixels"
        )
    found = intrinsics * np.array([[across], [down], [1.0]])
    check_intrinsics(found, width, height)
    return np.asarray(found)
