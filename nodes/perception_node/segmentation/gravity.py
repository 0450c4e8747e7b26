"""Which way is up, and where the floor is, in a picture of a room whose camera's pose nobody knows."""

from __future__ import annotations

import numpy as np

from semmap.nodes.perception_node.input.cloud import Transform
from semmap.nodes.perception_node.segmentation.planes import Plane, find_planes
from semmap.nodes.perception_node.segmentation.working_image import Floats

_UP = 0.2
_DOWN = 0.9
"""A floor's normal points up in the picture, or at a camera that looks straight down."""
_FURNITURE_M = 0.2
"""A level plane so far above another is furniture's; two that are nearer may be one thing on another."""
_DEEP_M = 100.0


def room_pose(points: Floats) -> Transform | None:
    """The (4, 4) pose of a camera that sees points (3, h, w) above the floor that it sees, which is z = 0.

    None for a picture of a single surface, such as a table top: its height says nothing. Cameras are held
    upright, more or less.
    """
    level = level_plane(find_planes(points, None, np.random.default_rng(0))[0])
    if level is None:
        return None
    pose = standing_on(level)
    pose[2, 3] += _DEEP_M  # no plane is the floor before all are known
    planes, _ = find_planes(points, pose, np.random.default_rng(0))
    heights = sorted(-plane.offset_m for plane in planes if plane.kind == "support")
    if not heights or heights[-1] - heights[0] < _FURNITURE_M:
        return None
    pose[2, 3] = heights[-1]
    return pose


def level_plane(planes: tuple[Plane, ...]) -> Plane | None:
    """The largest plane that may be level, by how it lies before the camera; None where none may be."""
    level = [plane for plane in planes if plane.normal[1] < -_UP or plane.normal[2] < -_DOWN]
    return max(level, key=lambda plane: plane.points, default=None)


def standing_on(plane: Plane) -> Transform:
    """A map frame whose floor is that plane, with the camera above its origin, looking along x."""
    pose, up = np.eye(4), plane.normal
    ahead = np.array([0.0, 0.0, 1.0]) - up * up[2]
    if np.linalg.norm(ahead) < 0.1:  # the camera looks straight down
        ahead = np.array([0.0, -1.0, 0.0]) - up * -up[1]
    ahead /= np.linalg.norm(ahead)
    pose[:3, :3] = np.stack([ahead, np.cross(up, ahead), up])
    pose[2, 3] = -plane.offset_m
    return pose
