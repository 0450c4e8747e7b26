"""Estimates the vertical and the floor from an image of a room, if the camera's pose is unknown."""

from __future__ import annotations

import numpy as np

from semmap.nodes.perception_node.input.cloud import Transform
from semmap.nodes.perception_node.segmentation.planes import LEAST_SHARE, Plane, find_planes, thickness_m
from semmap.nodes.perception_node.segmentation.working_image import Floats

_UP = 0.2
_DOWN = 0.9
"""A floor's normal points up in the image, or at a camera that looks straight down."""
_STEEPEST = 0.5
"""The same of a floor that is little of the image, which no slope may be taken for."""
_MOST_BELOW = 0.025
"""Maximum share of points below a floor: reflections and errors."""
_FURNITURE_M = 0.15
"""A level plane this far above another is furniture; closer planes may be parts of a thing."""
_DEEP_M = 100.0


def room_pose(points: Floats) -> Transform | None:
    """Return the pose (4, 4) of a camera from points (3, h, w) of the visible floor, which is z = 0.

    Returns None for an image of a single surface, such as a table top, whose height is unknown. Cameras are
    assumed to be approximately upright.
    """
    level = level_plane(find_planes(points, None, np.random.default_rng(0))[0])
    if level is None or level.normal[1] >= -_UP:  # it may be a wall
        floor = _small_floor(points)
        if floor is not None:
            return standing_on(floor)
    if level is None:
        return None
    pose = standing_on(level)
    pose[2, 3] += _DEEP_M  # before all planes are known, none is the floor
    # a low table is above a larger support, like the top of a thing: the floor
    planes, _ = find_planes(points, pose, np.random.default_rng(0), keep_tops=True)
    heights = sorted(-plane.offset_m for plane in planes if plane.kind == "support")
    if not heights or heights[-1] - heights[0] < _FURNITURE_M:
        return None
    pose[2, 3] = heights[-1]
    return pose


def _small_floor(points: Floats) -> Plane | None:
    """Return the floor of an image (3, h, w) of which it is little: a level plane with nothing below it."""
    planes, _ = find_planes(points, None, np.random.default_rng(0), least_share=LEAST_SHARE)
    for plane in planes:
        height = plane.height_m(points) / thickness_m(points[2])
        if plane.normal[1] < -_STEEPEST and (height < -2).sum() < _MOST_BELOW * np.isfinite(height).sum():
            return plane
    return None


def level_plane(planes: tuple[Plane, ...]) -> Plane | None:
    """Return the largest plane that may be level, by its orientation to the camera; None if none may be."""
    level = [plane for plane in planes if plane.normal[1] < -_UP or plane.normal[2] < -_DOWN]
    return max(level, key=lambda plane: plane.points, default=None)


def doubt_vertical(pose: Transform) -> str:
    """Return the reason to doubt that z points up in the frame of an estimated pose (4, 4); "" if none."""
    _, down, forward = pose[2, :3].tolist()  # of the axis z, in the frame of the camera
    if down < -_UP:
        return ""
    if forward < -_DOWN:
        found = "z points at the camera, as if it looked straight down at a level surface"
    elif np.array_equal(pose, np.eye(4)):
        found = "no plane is visible, so poses are in the frame of the camera, and z points forward"
    else:
        found = "no level surface is visible, so z is perpendicular to the largest plane and may not point up"
    return f"{found}; if this is wrong, state the camera's pose (--pose or map_from_camera)"


def standing_on(plane: Plane) -> Transform:
    """Return a map frame whose floor is that plane, with the camera above its origin, looking along x."""
    pose, up = np.eye(4), plane.normal
    ahead = np.array([0.0, 0.0, 1.0]) - up * up[2]
    if np.linalg.norm(ahead) < 0.1:  # the camera looks straight down
        ahead = np.array([0.0, -1.0, 0.0]) - up * -up[1]
    ahead /= np.linalg.norm(ahead)
    pose[:3, :3] = np.stack([ahead, np.cross(up, ahead), up])
    pose[2, 3] = -plane.offset_m
    return pose
