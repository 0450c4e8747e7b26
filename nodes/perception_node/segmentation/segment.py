"""Segments a cloud into planes and objects."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.segmentation.merge_model import shipped
from semmap.nodes.perception_node.segmentation.merging import Judge, merge
from semmap.nodes.perception_node.segmentation.normals import normals
from semmap.nodes.perception_node.segmentation.patches import patches
from semmap.nodes.perception_node.segmentation.planes import Plane, find_planes
from semmap.nodes.perception_node.segmentation.statistics import Statistics, Upright, statistics
from semmap.nodes.perception_node.segmentation.thin_things import thin_things
from semmap.nodes.perception_node.segmentation.unorganised_cloud import as_image
from semmap.nodes.perception_node.segmentation.working_image import (
    Floats,
    Grid,
    Labels,
    Mask,
    grid_of,
    spread,
)

LOWEST_M, HIGHEST_M = 0.009, 0.5
"""Range of heights above a support for things that stand on it."""


@dataclass(frozen=True)
class Segmentation:
    """The segmentation of a cloud.

    `labels`: (H, W) the object of each point, from 1 without gaps, 0 for background. `planes`: the dominant
    planes. `plane_labels`: (H, W) the plane of each point, 0 for none. `same`: (N, N) the probability that
    objects n + 1 and m + 1 are one, 0 if they were not compared.
    """

    labels: NDArray[np.int32]
    planes: tuple[Plane, ...]
    plane_labels: NDArray[np.int32]
    same: NDArray[np.float32]


@dataclass(frozen=True)
class Parts:
    """An over-segmented image.

    `of_plane`, `of_patch`: (h, w) the plane and the patch of each cell, 0 for none.
    """

    grid: Grid
    planes: tuple[Plane, ...]
    of_plane: Labels
    of_patch: Labels
    statistics: Statistics


def segment(cloud: Cloud, learnt: Judge | None = None) -> Segmentation:
    """Return the planes and objects of a cloud. `learnt` is the merge model, by default the shipped one."""
    if not (cloud.points_camera[..., 2] > 0).any():  # NaN is not
        nothing = np.zeros(cloud.points_camera.shape[:2], np.int32)
        return Segmentation(nothing, (), nothing, np.zeros((0, 0), np.float32))
    if not cloud.organised:
        image, pixel = as_image(cloud)
        seen = segment(image, learnt)
        labels, plane_labels = (
            np.append(of.ravel(), np.int32(0))[pixel][None, :] for of in (seen.labels, seen.plane_labels)
        )
        return Segmentation(labels, seen.planes, plane_labels, seen.same)
    parts = split_into_patches(cloud)
    merged = merge(parts.statistics, learnt or shipped())
    objects = np.append(np.int32(0), merged.number)[parts.of_patch]
    both = spread(parts.grid, np.where(objects > 0, objects, -parts.of_plane))
    return Segmentation(np.maximum(both, 0), parts.planes, np.maximum(-both, 0), merged.same)


def split_into_patches(cloud: Cloud) -> Parts:
    """Return the planes of an organised cloud, and small patches of the rest."""
    grid = grid_of(cloud)
    rng = np.random.default_rng(0)  # deterministic
    planes, of_plane = find_planes(grid.points, cloud.map_from_camera, rng)
    thin = thin_things(grid.points, planes, of_plane)
    of_plane[thin > 0] = 0
    where = _candidates(grid.points, planes, of_plane, known=cloud.map_from_camera is not None)
    window = _window(where | (thin > 0))  # thin things may be lower than all candidates
    points = grid.points[:, *window]
    surface = normals(points, where[window])
    of_patch = np.zeros_like(of_plane)
    thick = patches(points, surface, where[window] & (thin[window] == 0))
    of_patch[window] = np.where(thin[window] > 0, thin[window] + thick.max(), thick)
    shades = grid.shades(of_patch > 0)[:, *window]
    known = statistics(of_patch[window], points, surface, shades, _upright(planes))
    return Parts(grid, planes, of_plane, of_patch, known)


def _window(where: Mask) -> tuple[slice, slice]:
    """Return the bounding window of `where`."""
    row, column = (np.flatnonzero(where.any(axis=axis)) for axis in (1, 0))
    if not row.size:
        return slice(0, 1), slice(0, 1)
    return slice(row[0], row[-1] + 1), slice(column[0], column[-1] + 1)


def _candidates(
    points: Floats, planes: tuple[Plane, ...], of_plane: NDArray[np.int32], *, known: bool
) -> Mask:
    """Return cells of objects: on no plane, and above a support if the vertical is unknown."""
    where: Mask = np.isfinite(points[2]) & (of_plane == 0)
    if planes and not known:
        height = planes[0].height_m(points)
        where &= (height > LOWEST_M) & (height < HIGHEST_M)
    return where


def _upright(planes: tuple[Plane, ...]) -> Upright:
    """Return the vertical of the largest support; without one, that of the camera."""
    carrying = [plane for plane in planes if plane.kind in ("floor", "support")]
    if not carrying:
        return Upright(np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]), np.zeros(0))
    up = max(carrying, key=lambda plane: plane.points).normal
    level = np.linalg.svd(up[None, :])[2][1:]
    return Upright(np.vstack([level, up]), np.sort([plane.offset_m for plane in carrying]))
