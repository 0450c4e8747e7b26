"""Measures how well a placed model and the observed points agree."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from semmap.nodes.perception_node.fitting.model_surfaces import ModelSurface
from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.schemas import errors

_FACING = 0.25
"""Surfaces seen at a flatter angle (cosine) are ignored, since their depth is unreliable."""
_BLOCK_PX = 6.0
_NEAREST_M = 0.05


def verified_share(points: Numbers, model: ModelSurface, pose: Numbers, within_m: float) -> float:
    """Return the share of observed points (N, 3), map frame, on the model's surface, softly thresholded."""
    own = (points - pose[:3, 3]) @ pose[:3, :3]
    away, near = cKDTree(model.points).query(own)
    off = np.abs(((own - model.points[near]) * model.normals[near]).sum(axis=1))
    along = np.sqrt(np.maximum(away**2 - off**2, 0.0))
    off = np.hypot(off, np.maximum(along - spacing_m(model), 0.0))
    return float(np.exp(-((off / within_m) ** 2)).mean())


def spacing_m(model: ModelSurface) -> float:
    """Return the distance between a model's points [m]."""
    a, b, c = model.size_m
    return float(np.sqrt(2.0 * (a * b + b * c + c * a) / len(model.points)))


def visible_share(
    model: ModelSurface, pose: Numbers, clouds: Sequence[Cloud], within_m: float
) -> float | None:
    """Return the share of the model's camera-facing surface at which something was seen; None if unknown.

    Surface hidden by nearer things is ignored.
    """
    there, through = 0.0, 0.0
    points = model.points @ pose[:3, :3].T + pose[:3, 3]
    normals = model.normals @ pose[:3, :3].T
    for cloud in clouds:
        if cloud.intrinsics is None or not cloud.organised:
            continue
        camera = np.eye(4) if cloud.map_from_camera is None else cloud.map_from_camera
        own = (points - camera[:3, 3]) @ camera[:3, :3]
        facing = -((points - camera[:3, 3]) * normals).sum(axis=1) / np.linalg.norm(own, axis=1)
        seen = (own[:, 2] > _NEAREST_M) & (facing > _FACING)
        gap = _gaps(own[seen], own, cloud, within_m)
        there += float(np.exp(-((gap[np.abs(gap) < 3.0 * within_m] / within_m) ** 2)).sum())
        through += float((1.0 - np.exp(-((np.maximum(gap, 0.0) / within_m) ** 2))).sum())
    return there / (there + through) if there + through > 0.0 else None


def _gaps(points: Numbers, whole: Numbers, cloud: Cloud, within_m: float) -> NDArray[np.float64]:
    """Return how far behind visible model points (camera frame) a surface was measured [m]."""
    if cloud.intrinsics is None:
        raise errors.InternalError("the intrinsics of the camera are unknown")
    height, width = cloud.points_camera.shape[:2]
    whole = whole[whole[:, 2] > _NEAREST_M]
    if not len(points):
        return np.empty(0)
    block, pixels = _blocks(points, cloud.intrinsics)
    blocks, _ = _blocks(whole, cloud.intrinsics)
    low = blocks.min(axis=0) - 1
    shape = blocks.max(axis=0) - low + 2
    nearest = np.full(tuple(shape), np.inf)
    at = blocks - low
    np.minimum.at(nearest, (at[:, 0], at[:, 1]), whole[:, 2])
    at = block - low
    shown = points[:, 2] < nearest[at[:, 0], at[:, 1]] + 2.0 * within_m
    column, row = pixels[shown].astype(int).T
    inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    gap = cloud.points_camera[row[inside], column[inside], 2] - points[shown][inside, 2]
    return np.asarray(gap[np.isfinite(gap)], float)


def _blocks(points: Numbers, intrinsics: Numbers) -> tuple[NDArray[np.intp], Numbers]:
    pixels = points @ intrinsics.T
    pixels = pixels[:, :2] / pixels[:, 2:]
    return np.floor(pixels / _BLOCK_PX).astype(np.intp), pixels
