"""Projection of a depth image to points."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import FARTHEST_M, NEAREST_M, Cloud, Transform

MOST_PIXELS = 640 * 480 * 3 // 2
"""In a larger image, only every second, third ... row and column is used."""
_STEEPEST = 5.0
"""A pinhole camera sees nothing farther from its axis than this tangent, which is 79 degrees."""
_NARROWEST = 100.0
"""Maximum focal length relative to the longer side: a view of 0.6 degrees."""
_ASPECT = 3.0
"""Maximum ratio of the focal lengths, which is that of the sides of a pixel."""
_USUAL_FOCAL = (0.2, 0.9, 3.0)
"""Least, typical and greatest focal length of uncropped depth images relative to the longer side."""
_USUAL_OFFSET = 0.2
"""Maximum offset of their principal point from the middle relative to the image size."""
_ALIKE = 0.1


def check_intrinsics(intrinsics: Transform, width: int, height: int, first_pixel: float = 0.5) -> str:
    """Return a doubt, with likely values, that intrinsics (3, 3) are of an image of this size; "" if none.

    A crop or a special lens may have unusual intrinsics, so they are only doubted. Raises ValueError if no
    pinhole camera has them. `intrinsics` have the image corner at 0; the texts have the values of their
    source, in which the centre of the first pixel is at `first_pixel`.
    """
    focal, middle, size = intrinsics[[0, 1], [0, 1]], intrinsics[:2, 2], np.array([width, height])
    side, corner = max(width, height), 0.5 - first_pixel
    (fx, fy), (cx, cy) = focal.tolist(), (middle - corner).tolist()
    values = f"the intrinsics fx {fx:g} fy {fy:g} cx {cx:g} cy {cy:g}"
    image = f"an image of {width} x {height} pixels"
    likely_focal = f"fx and fy are probably about {_USUAL_FOCAL[1] * side:.0f}"
    likely_middle = f"cx is probably about {width / 2 - corner:g}, cy about {height / 2 - corner:g}"
    is_pinhole = intrinsics[0, 1] == 0.0 == intrinsics[1, 0] and (intrinsics[2] == [0, 0, 1]).all()
    if not (np.isfinite(intrinsics).all() and is_pinhole and (focal > 0).all() and (size > 0).all()):
        raise ValueError(f"{values} do not fit {image}: they are not those of a pinhole camera without skew")
    if not 1 / _ASPECT < fx / fy < _ASPECT:
        raise ValueError(f"{values} do not fit {image}: fx and fy are too different; {likely_focal}")
    view = math.degrees(2 * math.atan2(width / 2, fx))
    if (size / 2 / focal > _STEEPEST).any() or (focal > _NARROWEST * side).any():
        raise ValueError(f"{values} do not fit {image}: its view would be {view:.1f} degrees; {likely_focal}")
    if (np.maximum(np.abs(middle), np.abs(size - middle)) / focal > _STEEPEST).any():
        raise ValueError(f"{values} do not fit {image}; {likely_middle}")
    if (np.abs(middle - size / 2) > _USUAL_OFFSET * size).any():
        across, down = (2 * middle / size).tolist()
        likely = likely_middle
        if across > 0 and abs(across - down) < _ALIKE * across:  # as of an image of another resolution
            likely = (
                f"and it was scaled from {across * width:.0f} x {down * height:.0f} pixels, fx is about"
                f" {fx / across:.4g}, fy {fy / down:.4g}, cx {width / 2 - corner:g}, cy"
                f" {height / 2 - corner:g}"
            )
        return (
            f"{values} have the principal point far from the middle of {image}; if it is not a crop, {likely}"
        )
    if ((focal < _USUAL_FOCAL[0] * side) | (focal > _USUAL_FOCAL[2] * side)).any():
        return f"{values} give {image} a view of {view:.0f} degrees; if the lens has another, {likely_focal}"
    return ""


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
