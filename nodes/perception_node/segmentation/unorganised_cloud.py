"""Converts unorganised clouds to images of a camera at their origin."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from semmap.nodes.perception_node.input.cloud import Cloud

_WIDEST = 1280
_MARGIN = 0.1  # of the extent without outliers
_LOOKED_AT = 2000  # points that are used to measure the density
_AROUND = 4  # the nearest neighbours on a grid


def as_image(cloud: Cloud) -> tuple[Cloud, NDArray[np.int64]]:
    """Return the cloud as an organised one, and for each point (N,) its pixel.

    Points outside the image or not in front of the camera have -1. The nearest point of a pixel is in the
    image. If the cloud was made from an image, its pixels are restored.
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
    seen = depth <= nearest[target]
    image = np.full((height, width, 3), np.nan, np.float32)
    image.reshape(-1, 3)[target[seen]] = points[index[seen]]
    colors = None
    if cloud.colors is not None:
        colors = np.zeros((height, width, 3), np.uint8)
        colors.reshape(-1, 3)[target[seen]] = cloud.colors.reshape(-1, 3)[index[seen]]
    return replace(cloud, points_camera=image, colors=colors), pixel


def _pitch(rays: NDArray[np.float32]) -> float:
    """Return the spacing of rays (N, 2): the pitch of a grid, else the typical distance."""
    far = np.abs(rays - np.median(rays[:: max(1, len(rays) // _LOOKED_AT)], axis=0)).max(axis=1)
    enough = min(len(far), _LOOKED_AT) - 1
    middle = rays[far <= np.partition(far, enough)[enough]].astype(np.float64)
    if len(middle) <= _AROUND:
        return 1.0
    distances = KDTree(middle).query(middle, k=_AROUND + 1)[0]
    return max(float(np.median(distances[:, _AROUND])), 1e-6)
