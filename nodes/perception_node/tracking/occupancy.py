"""Occupancy of a box in the map by depth images: free, occupied, or out of sight.

Rays are cast through the box from each pixel that it covers, as in an occupancy grid.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import Cloud, Transform
from semmap.schemas import errors
from semmap.schemas.entities import Pose, Size

Occupancy = Literal["free", "occupied", "unknown"]
"""`free`: the camera looks through the box; `occupied`: something is there."""
OccupancyOf = Callable[[Pose, Size], Occupancy]
"""Returns the occupancy of the box of a size at a pose."""

_SHRINK = 0.8
"""Only the inner part of a box is checked, since neighbours may reach into an overestimated box."""
_MOST_RAYS = 2000
_FEWEST_RAYS = 12
_IN_FRONT_M = 0.02
_NEAREST_M = 0.05
_IN_VIEW, _UNHIDDEN, _FREE = 0.7, 0.5, 0.75
_THROUGH = 0.7
"""A ray that ends behind this share of its path through the box passed through."""
_LARGE_M, _THIN_M, _LARGE_FREE = 0.4, 0.1, 0.9
"""A large thing may consist of slats and legs, which most rays miss: it is gone if nearly all rays pass."""
_EDGE_M, _FOOT_M = 0.02, 0.05
"""Points this close to the sides of the box, or this low, may belong to its surroundings."""


def occupancy_in(clouds: Sequence[Cloud]) -> OccupancyOf:
    """Return the occupancy function of organised clouds of one moment (map frame)."""
    usable = [cloud for cloud in clouds if cloud.organised and cloud.intrinsics is not None]
    return partial(_occupancy, usable)


def _occupancy(clouds: Sequence[Cloud], pose: Pose, size_m: Size) -> Occupancy:
    found = {_occupancy_by(cloud, pose, size_m) for cloud in clouds}
    return "occupied" if "occupied" in found else "free" if "free" in found else "unknown"


def _occupancy_by(cloud: Cloud, pose: Pose, size_m: Size) -> Occupancy:
    if cloud.intrinsics is None:
        raise errors.InternalError("the intrinsics of the camera are unknown")
    camera_from_box = np.linalg.inv(_pose_of(cloud)) @ _map_from_box(pose, size_m)
    half = np.array([size_m[0] * _SHRINK, size_m[1] * _SHRINK, size_m[2]]) / 2.0
    rows, columns = _pixels(cloud, camera_from_box, half)
    if rows.size < _FEWEST_RAYS:
        return "unknown"
    depth = cloud.points_camera[rows, columns, 2].astype(float)
    enter, leave = _crossing(_rays(rows, columns, cloud.intrinsics), camera_from_box, half)
    length = leave - enter
    crossing = length > 0.3 * max(float(length.max(initial=0.0)), 1e-9)
    depth, enter, length = depth[crossing], enter[crossing], length[crossing]
    unhidden = depth > enter - _IN_FRONT_M  # NaN is hidden
    if depth.size < _FEWEST_RAYS or unhidden.mean() < _UNHIDDEN:
        return "unknown"
    through = (depth[unhidden] - enter[unhidden]) / length[unhidden] > _THROUGH
    if max(size_m) <= _LARGE_M or min(size_m) <= _THIN_M:
        return "free" if through.mean() >= _FREE else "occupied"
    points = cloud.points_camera[rows, columns][crossing][unhidden]
    through &= ~_inside(points, camera_from_box, np.array(size_m) / 2.0)
    return "free" if through.mean() >= _LARGE_FREE else "occupied"


def _inside(points: NDArray[np.float32], camera_from_box: Transform, half: Transform) -> NDArray[np.bool_]:
    """Return which points (N, 3) of the camera frame are in a box, with its far side."""
    own = (points - camera_from_box[:3, 3]) @ camera_from_box[:3, :3]
    within = (np.abs(own) < half - _EDGE_M).all(axis=1)
    return np.asarray(within & (own[:, 2] > _FOOT_M - half[2]))


def _pixels(
    cloud: Cloud, camera_from_box: Transform, half: Transform
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return rows and columns that the box covers, subsampled; none if the box is mostly out of view."""
    signs = np.stack(np.meshgrid([-1, 1], [-1, 1], [-1, 1]), axis=-1).reshape(-1, 3)
    corners = signs * half @ camera_from_box[:3, :3].T + camera_from_box[:3, 3]
    nothing = np.empty(0, np.intp)
    if corners[:, 2].min() < _NEAREST_M:
        return nothing, nothing
    if cloud.intrinsics is None:
        raise errors.InternalError("the intrinsics of the camera are unknown")
    pixels = corners @ cloud.intrinsics.T
    pixels = pixels[:, :2] / pixels[:, 2:]
    low, high = pixels.min(axis=0), pixels.max(axis=0)
    height, width = cloud.points_camera.shape[:2]
    first = np.maximum(np.floor(low), 0.0).astype(int)
    last = np.minimum(np.ceil(high), [width, height]).astype(int)
    seen = np.maximum(last - first, 0)
    if seen.prod() < _IN_VIEW * np.prod(high - low):
        return nothing, nothing
    step = max(1, int(np.sqrt(seen.prod() / _MOST_RAYS)))
    rows, columns = np.mgrid[first[1] : last[1] : step, first[0] : last[0] : step]
    return rows.ravel(), columns.ravel()


def _rays(rows: NDArray[np.intp], columns: NDArray[np.intp], intrinsics: Transform) -> Transform:
    """Return (N, 3) the ray of each pixel's centre at a depth of 1 m, camera frame."""
    middles = np.stack([columns + 0.5, rows + 0.5, np.ones(rows.size)], axis=-1)
    return np.asarray(middles @ np.linalg.inv(intrinsics).T)


def _crossing(
    rays: Transform, camera_from_box: Transform, half: Transform
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the depths [m] at which each ray enters and leaves the box (slab method).

    A ray misses the box if they are out of order.
    """
    rotation, middle = camera_from_box[:3, :3], camera_from_box[:3, 3]
    eye = -middle @ rotation
    directions = rays @ rotation
    directions = np.where(np.abs(directions) < 1e-9, 1e-9, directions)
    one, other = (-half - eye) / directions, (half - eye) / directions
    return np.minimum(one, other).max(axis=1), np.maximum(one, other).min(axis=1)


def _map_from_box(pose: Pose, size_m: Size) -> Transform:
    """Return the transform (4, 4) of the frame at the box's centre."""
    w, x, y, z = pose.orientation_wxyz
    transform = np.eye(4)
    transform[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    transform[:3, 3] = np.array(pose.position_m) + transform[:3, 2] * size_m[2] / 2.0
    return transform


def _pose_of(cloud: Cloud) -> Transform:
    return np.eye(4) if cloud.map_from_camera is None else cloud.map_from_camera
