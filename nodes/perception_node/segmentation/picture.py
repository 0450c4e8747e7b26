"""Clouds without order, seen as a camera at their origin would see them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from nodes.perception_node.cloud import Cloud

_WIDEST = 1280
_LOOKED_AT = 4000  # points whose neighbours tell how dense the cloud is
_AROUND = 4  # the nearest neighbours on a grid


def as_picture(cloud: Cloud) -> tuple[Cloud, NDArray[np.int64]]:
    """An organised cloud of the points of one that is not, and for each point (N,) the pixel it falls on.

    Points that fall on no pixel, and those that are not in front of the camera, have -1. Of several on one
    pixel the nearest is in the picture. Where the cloud was a picture once, its pixels are found again.
    """
    points = cloud.points_camera.reshape(-1, 3)
    pixel = np.full(len(points), -1, np.int64)
    index = np.flatnonzero(points[:, 2] > 0)  # NaN is not
    if not index.size:
        return replace(cloud, points_camera=np.full((2, 2, 3), np.nan, np.float32), colors=None), pixel
    rays = (points[index, :2] / points[index, 2:]).astype(np.float64)
    low, high = np.percentile(rays, (0.05, 99.95), axis=0)
    low, high = rays[(rays >= low).all(axis=1)].min(axis=0), np.maximum(high, low + 1e-6)
    pitch = max(_pitch(rays), float((high - low).max()) / _WIDEST)
    place = np.rint((rays - low) / pitch).astype(np.int64)
    width, height = (int(side) for side in np.rint((high - low) / pitch).astype(np.int64) + 1)
    width, height = max(width, 2), max(height, 2)
    inside = ((place >= 0) & (place < (width, height))).all(axis=1)
    index, place = index[inside], place[inside]
    pixel[index] = place[:, 1] * width + place[:, 0]
    farthest_first = index[np.argsort(-points[index, 2], kind="stable")]
    picture = np.full((height * width, 3), np.nan, np.float32)
    picture[pixel[farthest_first]] = points[farthest_first]  # of several the last is kept
    colors = None
    if cloud.colors is not None:
        colors = np.zeros((height, width, 3), np.uint8)
        colors.reshape(-1, 3)[pixel[farthest_first]] = cloud.colors.reshape(-1, 3)[farthest_first]
    return replace(cloud, points_camera=picture.reshape(height, width, 3), colors=colors), pixel


def _pitch(rays: NDArray[np.float64]) -> float:
    """How far rays (N, 2) are from one another: on a grid its pitch, else about as much room as each has."""
    far = np.abs(rays - np.median(rays, axis=0)).max(axis=1)
    middle = rays[far <= np.partition(far, min(len(far), _LOOKED_AT) - 1)[min(len(far), _LOOKED_AT) - 1]]
    if len(middle) <= _AROUND:
        return 1.0
    distances = KDTree(middle).query(middle, k=_AROUND + 1)[0]
    return max(float(np.median(distances[:, _AROUND])), 1e-6)
