"""Converts unorganised clouds to images of a camera at their origin."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from semmap.nodes.perception_node.input.cloud import Cloud

_WIDEST = 1280
_MARGIN = 0.1  # of the extent without outliers
_LOOKED_AT = 2000  # points that are used to measure the density
_AROUND = 4  # the nearest neighbours on a grid
_BLOCK = 8  # spacings of the middle, along the sides of a block in which the density is measured
_SPARSE = 1.3  # times that spacing: the rest of the view is less dense than its middle
_COVERED = 0.8  # of the view has at least the density of the image
_SAME_SURFACE = np.float32(0.015)  # of the distance
_ENCLOSING = 4  # neighbours of a hole; a pixel beside a straight edge has three
_NEIGHBOURS = [(r, c) for r in (-1, 0, 1) for c in (-1, 0, 1) if r or c]


def as_image(cloud: Cloud) -> tuple[Cloud, NDArray[np.int64]]:
    """Return the cloud as an organised one, and for each point (N,) its pixel.

    Points outside the image or not in front of the camera have -1. A pixel has the mean of its points on the
    nearest surface. If the cloud was made from an image, its pixels are restored. Otherwise, a pixel without
    a point that is surrounded by a surface has the mean of its neighbours.
    """
    points = cloud.points_camera.reshape(-1, 3)
    pixel = np.full(len(points), -1, np.int64)
    index = np.flatnonzero(points[:, 2] > 0)  # NaN is not
    if not index.size:
        return Cloud(np.full((2, 2, 3), np.nan, np.float32)), pixel
    depth = points[index, 2]
    rays = points[index, :2] / depth[:, None]
    low, high = np.percentile(rays[:: max(1, len(rays) // _LOOKED_AT)], (0.2, 99.8), axis=0)
    pitch = max(_pitch(rays), float((high - low).max()) / _WIDEST)
    # counted from one of them, so that rays on a grid fall on whole numbers
    place = np.rint((rays - rays[0]) / np.float32(pitch)).astype(np.int64)
    margin = _MARGIN * (high - low) + pitch
    inside = ((rays >= low - margin) & (rays <= high + margin)).all(axis=1)
    index, depth, place = index[inside], depth[inside], place[inside]
    place -= place.min(axis=0)
    width, height = (max(2, int(side) + 1) for side in place.max(axis=0))
    target = place[:, 1] * width + place[:, 0]
    pixel[index] = target
    nearest = np.full(height * width, np.inf, np.float32)
    np.minimum.at(nearest, target, depth)
    seen = depth <= nearest[target] * (1 + _SAME_SURFACE)
    index, target = index[seen], target[seen]
    image = _means(points[index], target, np.isfinite(nearest)).reshape(height, width, 3)
    colors = None
    if cloud.colors is not None:
        shades = _means(cloud.colors.reshape(-1, 3)[index], target, np.isfinite(nearest))
        colors = np.nan_to_num(shades).astype(np.uint8).reshape(height, width, 3)
    fill_holes(image, colors)
    return replace(cloud, points_camera=image, colors=colors), pixel


def _means(values: NDArray[Any], pixel: NDArray[np.int64], filled: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Return the mean (P, 3) of the values (N, 3) of each pixel, NaN unless it is `filled` (P,)."""
    count = np.bincount(pixel, minlength=len(filled))
    sums = [np.bincount(pixel, axis, len(filled)) for axis in values.T]
    return np.where(filled[:, None], np.stack(sums, axis=-1) / np.maximum(count, 1)[:, None], np.nan).astype(
        np.float32
    )


def _pitch(rays: NDArray[np.float32]) -> float:
    """Return the spacing of rays (N, 2): the pitch of a grid, else the typical distance."""
    far = np.abs(rays - np.median(rays[:: max(1, len(rays) // _LOOKED_AT)], axis=0)).max(axis=1)
    enough = min(len(far), _LOOKED_AT) - 1
    middle = rays[far <= np.partition(far, enough)[enough]].astype(np.float64)
    if len(middle) <= _AROUND:
        return 1.0
    distances = KDTree(middle).query(middle, k=_AROUND + 1)[0]
    middle_pitch = max(float(np.median(distances[:, _AROUND])), 1e-6)
    return max(middle_pitch, _sparse_pitch(rays, _BLOCK * middle_pitch))


def _sparse_pitch(rays: NDArray[np.float32], side: float) -> float:
    """Return the spacing of rays (N, 2) in the sparse part of the view, 0 if there is none.

    Voxels are larger in the image the nearer they are, so the floor is denser than a table top. The density
    is measured in blocks with this side.
    """
    blocks = np.floor((rays - rays.min(axis=0)) / side).astype(np.int64)
    counts = np.unique(blocks[:, 0] * (blocks[:, 1].max() + 1) + blocks[:, 1], return_counts=True)[1]
    pitch = side / float(np.sqrt(np.quantile(counts, 1.0 - _COVERED)))
    return pitch if pitch > _SPARSE * side / _BLOCK else 0.0


def fill_holes(points: NDArray[np.float32], colors: NDArray[np.uint8] | None) -> None:
    """Give pixels without a point (H, W, 3), but with four neighbours on a surface, their mean."""
    height, width = points.shape[:2]
    padded = np.pad(points, ((1, 1), (1, 1), (0, 0)), constant_values=np.nan)
    rows, columns = np.nonzero(np.isnan(points[..., 2]))
    around = np.stack([padded[rows + 1 + r, columns + 1 + c] for r, c in _NEIGHBOURS])
    depth = np.where(np.isnan(around[..., 2]), np.float32(np.inf), around[..., 2])
    nearest = depth.min(axis=0, initial=np.inf)
    on = depth <= nearest * (1 + _SAME_SURFACE)
    enclosed = np.isfinite(nearest) & (on.sum(axis=0) >= _ENCLOSING)
    rows, columns, on, around = rows[enclosed], columns[enclosed], on[:, enclosed], around[:, enclosed]
    count = on.sum(axis=0)[:, None]
    points[rows, columns] = np.where(on[..., None], around, 0).sum(axis=0) / count
    if colors is not None:
        at = [(np.clip(rows + r, 0, height - 1), np.clip(columns + c, 0, width - 1)) for r, c in _NEIGHBOURS]
        shades = np.stack([colors[r, c] for r, c in at]).astype(np.float32)
        colors[rows, columns] = np.where(on[..., None], shades, 0).sum(axis=0) / count
