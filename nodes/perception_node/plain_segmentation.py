"""Segments of a view that stand free on horizontal supports: the plainest thing that works."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

_BIN_M = 0.01
_SUPPORT_SHARE = 0.06
_LEAST_POINTS = 40
_STEP = 0.02


def supports_of(points_map: NDArray[np.float32]) -> list[float]:
    """Heights [m] of the horizontal planes that a view (H, W, 3) shows much of, the lowest first."""
    d = 3
    across = points_map[d:-d, 2 * d :] - points_map[d:-d, : -2 * d]
    down = points_map[2 * d :, d:-d] - points_map[: -2 * d, d:-d]
    normal = np.cross(across, down)
    with np.errstate(invalid="ignore", divide="ignore"):
        level = np.abs(normal[..., 2]) > 0.95 * np.linalg.norm(normal, axis=-1)
    level &= np.isfinite(points_map[d:-d, d:-d, 2])
    heights = points_map[d:-d, d:-d, 2][level]
    if not len(heights):
        return []
    counts, edges = np.histogram(
        heights, np.arange(heights.min() - 2 * _BIN_M, heights.max() + 3 * _BIN_M, _BIN_M)
    )
    thick = np.convolve(counts, [1, 1, 1], "same")
    peak = (thick == ndimage.maximum_filter1d(thick, 9)) & (thick > _SUPPORT_SHARE * points_map[..., 2].size)
    return [
        float(np.median(heights[np.abs(heights - at) < 2 * _BIN_M])) for at in edges[:-1][peak] + _BIN_M / 2
    ]


def label_segments(
    points_map: NDArray[np.float32], depth_m: NDArray[np.float32], supports_m: list[float]
) -> NDArray[np.int32]:
    """(H, W): a number from 1 for each thing that sticks out of a support, 0 for all else."""
    supports = np.array(supports_m or [0.0])
    height = points_map[..., 2]
    margin = 0.008 + 0.004 * depth_m**2
    with np.errstate(invalid="ignore"):
        near = np.abs(height[..., None] - supports).min(axis=-1)
        out = (near > margin) & (height > supports[0] + margin)
    labels = np.zeros(out.shape, np.int32)
    layers = np.digitize(np.nan_to_num(height), supports)
    count = 0
    for layer in np.unique(layers[out]):
        part, found = _components(out & (layers == layer), depth_m)
        labels[part > 0] = part[part > 0] + count
        count += found
    sizes = np.bincount(labels.ravel(), minlength=count + 1)
    keep = sizes >= _LEAST_POINTS
    keep[0] = False
    renumbered = np.where(keep, np.cumsum(keep), 0).astype(np.int32)
    return np.asarray(renumbered[labels])


def _components(mask: NDArray[np.bool_], depth_m: NDArray[np.float32]) -> tuple[NDArray[np.int32], int]:
    """Connected pixels without a step in depth between them, on a grid of twice the size for the links."""
    rows, columns = mask.shape
    fine = np.zeros((2 * rows - 1, 2 * columns - 1), bool)
    fine[::2, ::2] = mask
    with np.errstate(invalid="ignore"):
        fine[::2, 1::2] = (
            mask[:, 1:] & mask[:, :-1] & (np.abs(np.diff(depth_m, axis=1)) < _STEP * depth_m[:, 1:])
        )
        fine[1::2, ::2] = mask[1:] & mask[:-1] & (np.abs(np.diff(depth_m, axis=0)) < _STEP * depth_m[1:])
    labels, count = ndimage.label(fine)
    return labels[::2, ::2], int(count)
