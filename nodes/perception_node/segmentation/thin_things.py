"""Thin things on a plane, which rise above it by less than its noise, but more than that of a mean.

A thing that is thinner than a camera's noise is part of the plane at first. The mean of several cells is more
precise, so a plate or a wrench is visible from two metres as an island above the surrounding plane. The plane
itself may be warped, as is usual for depth cameras.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import ndimage

from semmap.nodes.perception_node.segmentation.planes import Plane, thickness_m
from semmap.nodes.perception_node.segmentation.working_image import Floats, Labels, Mask

_SMOOTHED = 3  # cells across that a mean is taken of
_BLOCK = 10  # cells across of a block; the plane around is the mean of three by three of them
_LEAST_M, _LEAST_AT_1_M = 0.004, 0.002  # the second grows with the square of the distance
_SKIRT = 0.5  # of the least height: so far down an island goes on
_FEWEST_CELLS = 15
_LARGEST_M = 0.5
_HIGHER = 0.1
"""With a larger share of clearly higher adjacent cells, an island is the foot of something tall."""


def thin_things(points: Floats, planes: Sequence[Plane], of_plane: Labels) -> Labels:
    """Return (h, w) numbers from 1 of thin things on the level planes of an image (3, h, w), 0 for none.

    `of_plane`: (h, w) the plane of each cell, 0 for none.
    """
    found = np.zeros_like(of_plane)
    for number, plane in enumerate(planes, 1):
        if plane.kind not in ("floor", "support"):
            continue
        for island in _islands(points, plane, of_plane, number):
            found[island & (found == 0)] = found.max() + 1
    return found


def _islands(points: Floats, plane: Plane, of_plane: Labels, number: int) -> list[Mask]:
    on = of_plane == number
    window = _window(on)
    z, height = points[2][window], plane.height_m(points[:, *window])
    on, free = on[window], of_plane[window] == 0
    band = thickness_m(z)
    low = on | (free & (height > 0) & (height < 2 * band))
    tall = free & (height >= 2 * band)
    least = np.maximum(_LEAST_M, _LEAST_AT_1_M * z * z)
    mean = _means(height, low, _SMOOTHED)
    over = np.where(low, mean - _around(height, low & (mean < least)), np.float32(-1.0))
    parts, count = ndimage.label(over > _SKIRT * least)
    if not count:
        return []
    seeds = np.bincount(parts[over > least], minlength=count + 1)
    cells = np.bincount(parts.ravel(), minlength=count + 1)
    on_plane = np.bincount(parts[on], minlength=count + 1)
    beside = np.bincount(ndimage.grey_dilation(parts, size=3)[tall], minlength=count + 1)
    thin = (
        (seeds >= _FEWEST_CELLS) & (2 * seeds >= cells) & (2 * on_plane >= cells) & (beside < _HIGHER * cells)
    )
    thin[0] = False
    found = []
    for part in np.flatnonzero(thin):
        island = parts == part
        extent = np.ptp(points[:, *window][:, island], axis=1)
        if np.linalg.norm(extent) < _LARGEST_M:
            whole = np.zeros(of_plane.shape, bool)
            whole[window] = ndimage.binary_fill_holes(island) & low
            found.append(whole)
    return found


def _means(values: Floats, where: Mask, across: int) -> Floats:
    """Return (h, w) means of the cells in `where` in a window of this width, 0 for an empty window."""
    total = ndimage.uniform_filter(np.where(where, values, np.float32(0)), across, mode="constant")
    share = ndimage.uniform_filter(where.astype(np.float32), across, mode="constant")
    return np.asarray(total / np.maximum(share, np.float32(0.5 / across**2)))


def _around(heights: Floats, where: Mask) -> Floats:
    """Return (h, w) the height of the plane around each cell, from the cells in `where`."""
    rows, columns = heights.shape
    room = (0, -rows % _BLOCK), (0, -columns % _BLOCK)
    blocks = [
        np.pad(values, room).reshape(-(-rows // _BLOCK), _BLOCK, -1, _BLOCK).sum(axis=(1, 3))
        for values in (np.where(where, heights, np.float32(0)), where.astype(np.float32))
    ]
    total, count = (ndimage.uniform_filter(of, 3, mode="constant") for of in blocks)
    level = np.asarray(total / np.maximum(count, np.float32(0.1)))
    return level.repeat(_BLOCK, axis=0)[:rows].repeat(_BLOCK, axis=1)[:, :columns]


def _window(where: Mask) -> tuple[slice, slice]:
    row, column = (np.flatnonzero(where.any(axis=axis)) for axis in (1, 0))
    if not row.size:
        return slice(0, 1), slice(0, 1)
    return slice(row[0], row[-1] + 1), slice(column[0], column[-1] + 1)
