"""From a depth picture to points."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import FARTHEST_M, NEAREST_M, Cloud, Transform

MOST_PIXELS = 640 * 480 * 3 // 2
"""Of a picture with more, every second, third ... row and column is used."""
_OFF_MIDDLE = 0.2
"""Of a picture's width and height; twice or half as large a picture's middle is a half or a quarter off."""
_FOCAL = (0.1, 20.0)
"""A focal length is this many times as long as its picture is wide and high: a view of 3 to 157 degrees."""


def fits(intrinsics: Transform, width: int, height: int) -> bool:
    """Whether intrinsics (3, 3) may be those of a picture of this size, and not of one twice as large.

    They are of a pinhole without skew, and its optical axis meets the middle of the picture, or nearly so.
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
    """Whether (4, 4) numbers are a rotation and a translation."""
    turn = transform[:3, :3]
    return bool(
        np.isfinite(transform).all()
        and np.allclose(turn @ turn.T, np.eye(3), atol=1e-3)
        and np.linalg.det(turn) > 0.0
        and np.allclose(transform[3], [0, 0, 0, 1], atol=1e-6)
    )


def thinning(width: int, height: int) -> int:
    """Every how many-th row and column of a picture of this size is used."""
    return max(1, math.ceil(math.sqrt(width * height / MOST_PIXELS)))


def thinned(
    depth_m: NDArray[np.float32], rgb: NDArray[np.uint8], intrinsics: Transform, step: int
) -> tuple[NDArray[np.float32], NDArray[np.uint8], Transform]:
    """Every `step`-th row and column of a depth and a colour picture, and the intrinsics (3, 3) of that."""
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
    """The points that a depth picture (H, W) [m] sees, 0 or NaN for nothing; the first pixel's middle is 0.5.

    What is as near as `NEAREST_M` or as far as `FARTHEST_M` was not measured either.

    Raises ValueError where picture, colours and intrinsics do not fit together.
    """
    height, width = depth_m.shape
    if rgb is not None and rgb.shape != (height, width, 3):
        raise ValueError(f"colours of shape {rgb.shape} do not go with a depth picture of {depth_m.shape}")
    if intrinsics.shape != (3, 3) or not (
        np.isfinite(intrinsics).all() and intrinsics[0, 0] > 0 < intrinsics[1, 1]
    ):
        raise ValueError("intrinsics are three rows of three numbers with positive focal lengths")
    right = ((np.arange(width) + 0.5 - intrinsics[0, 2]) / intrinsics[0, 0]).astype(np.float32)
    down = ((np.arange(height) + 0.5 - intrinsics[1, 2]) / intrinsics[1, 1]).astype(np.float32)
    seen = np.where((depth_m > NEAREST_M) & (depth_m < FARTHEST_M), depth_m, np.float32(np.nan))
    points = np.empty((height, width, 3), np.float32)
    points[..., 0], points[..., 1], points[..., 2] = seen * right, seen * down[:, None], seen
    return Cloud(points, rgb, map_from_camera, intrinsics, camera, stamp_ns)
