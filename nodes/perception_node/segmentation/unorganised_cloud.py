"""Clouds without order, seen as a camera at their origin would see them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from semmap.nodes.perception_node.input.cloud import Cloud

_WIDEST = 1280
_MARGIN = 0.1  # of the extent, beyond what all but a few points take
_LOOKED_AT = 2000  # points whose neighbours tell how dense the cloud is
_AROUND = 4  # the nearest neighbours on a grid


def as_image(cloud: Cloud) -> tuple[Cloud, NDArray[np.int64]]:
    """The points of a cloud without order as an organised one, and for each (N,) the pixel it falls on.

    Points that fall on no pixel, and those that are not in front of the camera, have -1. Of several on one
    pixel the nearest is in the picture. Where the cloud was a picture once, its pixels are found again.
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
    picture = np.full((height, width, 3), np.nan, np.float32)
    picture.reshape(-1, 3)[target[seen]] = points[index[seen]]
    colors = None
    if cloud.colors is not None:
        colors = np.zeros((height, width, 3), np.uint8)
        colors.reshape(-1, 3)[target[seen]] = cloud.colors.reshape(-1, 3)[index[seen]]
    return replace(cloud, points_camera=picture, colors=colors), pixel


def _pitch(rays: NDArray[np.float32]) -> float:
    """How far rays (N, 2) are from one another: on a grid its pitch, else about as much room as each has."""
    far = np.abs(rays - np.median(rays[:: max(1, len(rays) // _LOOKED_AT)], axis=0)).max(axis=1)
    enough = min(len(far), _LOOKED_AT) - 1
    middle = rays[far <= np.partition(far, enough)[enough]].astype(np.float64)
    if len(middle) <= _AROUND:
        return 1.0
    distances = KDTree(middle).query(middle, k=_AROUND + 1)[0]
    return max(float(np.median(distances[:, _AROUND])), 1e-6)
