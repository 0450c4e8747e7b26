"""Projection of a depth image to points."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import FARTHEST_M, NEAREST_M, Cloud, Transform

MOST_PIXELS = 640 * 480 * 3 // 2
"""In a larger image, only every second, third ... row and column is used."""
_OFF_MIDDLE = 0.2
"""Maximum offset of the principal point, as a share of the image size, to detect scaled intrinsics."""
_FOCAL = (0.1, 20.0)
"""Range of the focal length relative to the image size: a view of 3 to 157 degrees."""


def fits(intrinsics: Transform, width: int, height: int) -> bool:
    """Return whether intrinsics (3, 3) are plausible for an image of this size.

    They must be a pinhole without skew, with the principal point near the middle.
    """
    focal, middle, size = intrinsics[[0, 1], [0, 1]], intrinsics[:2, 2], np.array([width, height])
    return bool(
        np.isfinite(intrinsics).all()
        and (_FOCAL[0] * size < focal).all()
        and (focal < _FOCAL[1] * size).all()
        and (np.abs(middle - size / 2.0) <= _OFF_MIDDLE * size).all()
        and intrinsics[0, 1] == 0.0 == intrinsics[1, 0]
        and (intrinsics[2] == [0, 0, 1]).all()
    )


def is_pose(transform: Transform) -> bool:
    """Return whether a (4, 4) matrix is a rotation and a translation."""
    turn = transform[:3, :3]
    return bool(
        np.isfinite(transform).all()
        and np.allclose(turn @ turn.T, np.eye(3), atol=1e-3)
        and np.linalg.det(turn) > 0.0
        and np.allclose(transform[3], [0, 0, 0, 1], atol=1e-6)
    )


def thinning(width: int, height: int) -> int:
    """Return the step between used rows and columns of an image of this size."""
    return max(1, math.ceil(math.sqrt(width * height / MOST_PIXELS)))


def thinned(
    depth_m: NDArray[np.float32], rgb: NDArray[np.uint8], intrinsics: Transform, step: int
) -> tuple[NDArray[np.float32], NDArray[np.uint8], Transform]:
    """Return every `step`-th row and column of depth and colour, and the matching intrinsics (3, 3)."""
    if step == 1:
        return depth_m, rgb, intrinsics
    fewer = intrinsics.copy()
    fewer[:2, 2] -= 0.5
    fewer[:2] /= step
    fewer[:2, 2] += 0.5
    return np.ascontiguousarray(depth_m[::step, ::step]), np.ascontiguousarray(rgb[::step, ::step]), fewer


def cloud_of(
    depth_m: NDArray[np.float32],
    rgb: NDArray[np.uint8] | None,
    intrinsics: Transform,
    map_from_camera: Transform | None = None,
    *,
    camera: str = "",
    stamp_ns: int = 0,
) -> Cloud:
    """Return the points of a depth image (H, W) [m], 0 or NaN for no measurement.

    The centre of the first pixel is 0.5. Depth not between `NEAREST_M` and `FARTHEST_M` is invalid. Raises
    ValueError if depth, colours and intrinsics do not fit together.
    """
    height, width = depth_m.shape
    if rgb is not None and rgb.shape != (height, width, 3):
        raise ValueError(f"colours of shape {rgb.shape} do not fit a depth image of {depth_m.shape}")
    if intrinsics.shape != (3, 3) or not (
        np.isfinite(intrinsics).all() and intrinsics[0, 0] > 0 < intrinsics[1, 1]
    ):
        raise ValueError("intrinsics must be 3 x 3 numbers with positive focal lengths")
    right = ((np.arange(width) + 0.5 - intrinsics[0, 2]) / intrinsics[0, 0]).astype(np.float32)
    down = ((np.arange(height) + 0.5 - intrinsics[1, 2]) / intrinsics[1, 1]).astype(np.float32)
    seen = np.where((depth_m > NEAREST_M) & (depth_m < FARTHEST_M), depth_m, np.float32(np.nan))
    points = np.empty((height, width, 3), np.float32)
    points[..., 0], points[..., 1], points[..., 2] = seen * right, seen * down[:, None], seen
    return Cloud(points, rgb, map_from_camera, intrinsics, camera, stamp_ns)
