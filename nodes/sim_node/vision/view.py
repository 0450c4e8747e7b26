"""Camera poses and projections.

The camera frame is the optical one: x to the right, y down, z forward. Pixel (u, v) of a point is `intrinsics
@ point_camera` divided by its z, with the centre of the first pixel at 0.5.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from semmap.nodes.geometry.outliers import find_near
from semmap.nodes.sim_node.bodies import Floats, pose_of
from semmap.schemas.entities import Pose
from semmap.schemas.errors import BadRequest

OPTICAL = np.diag([1.0, -1.0, -1.0])  # MuJoCo's cameras look along -z with y up

_UPRIGHT = 1e-6


@dataclass(frozen=True)
class View:
    """A pinhole camera: `intrinsics` (3, 3) [pixel], `map_from_camera` (4, 4) [m]."""

    width: int
    height: int
    intrinsics: Floats
    map_from_camera: Floats

    @property
    def fovy_rad(self) -> float:
        """Return the vertical field of view."""
        return float(2.0 * np.arctan(self.height / 2.0 / self.intrinsics[1, 1]))


def camera_view(model: mujoco.MjModel, data: mujoco.MjData, camera: str, width: int, height: int) -> View:
    """Return the view of a camera of the world file. Raises BadRequest for an unknown camera."""
    number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_CAMERA, camera)
    if number < 0:
        names = ", ".join(camera_names(model)) or "none"
        raise BadRequest(f"unknown camera '{camera}'; the world has: {names}")
    pose = np.eye(4)
    pose[:3, :3] = data.cam_xmat[number].reshape(3, 3) @ OPTICAL
    pose[:3, 3] = data.cam_xpos[number]
    return View(width, height, pinhole(width, height, float(np.radians(model.cam_fovy[number]))), pose)


def optical_pose(data: mujoco.MjData, number: int) -> Pose:
    """Return the pose of a camera's optical frame in the map frame."""
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, (data.cam_xmat[number].reshape(3, 3) @ OPTICAL).ravel())
    return pose_of(np.concatenate([data.cam_xpos[number], quaternion]))


def camera_names(model: mujoco.MjModel) -> tuple[str, ...]:
    """Return the names of the world's cameras."""
    return tuple(model.camera(number).name for number in range(model.ncam))


def look_at(eye_m: Floats, target_m: Floats, width: int, height: int, fovy_rad: float) -> View:
    """Return a view from `eye_m` (3,) towards `target_m` (3,), with the map's z axis up in the image.

    For a vertical view, the map's x axis is to the right.
    """
    forward = (target_m - eye_m) / np.linalg.norm(target_m - eye_m)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    length = np.linalg.norm(right)
    right = right / length if length > _UPRIGHT else np.array([1.0, 0.0, 0.0])
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([right, np.cross(forward, right), forward])
    pose[:3, 3] = eye_m
    return View(width, height, pinhole(width, height, fovy_rad), pose)


def bulk(low_m: Floats, high_m: Floats) -> tuple[Floats, Floats]:
    """Return lowest and highest corner, each (3,) [m], of the box around all boxes (N, 3) but outliers."""
    if not len(low_m):
        return np.array([-1.0, -1.0, 0.0]), np.array([1.0, 1.0, 1.0])
    near = find_near((low_m + high_m) / 2.0)
    return low_m[near].min(axis=0), high_m[near].max(axis=0)


FROM_ABOVE = (0.0, -0.15, 1.0)
"""Nearly straight down, so that walls hide nothing."""
FROM_ALOFT = (0.40, -0.46, 0.80)
FROM_THE_FRONT = (0.68, -0.44, 0.58)


def overview(
    low_m: Floats,
    high_m: Floats,
    width: int,
    height: int,
    back: tuple[float, float, float] = FROM_ALOFT,
    fovy_rad: float = float(np.radians(36.0)),
) -> View:
    """Return a view from the direction `back` in which the box between two corners (3,) just fits.

    The front of things is +x.
    """
    middle = (low_m + high_m) / 2.0
    outward = np.asarray(back) / np.linalg.norm(back)
    aimed = look_at(middle + outward, middle, width, height, fovy_rad)
    corners = np.stack(np.meshgrid(*zip(low_m, high_m, strict=True)), axis=-1).reshape(-1, 3) - middle
    x, y, z = (corners @ aimed.map_from_camera[:3, :3]).T
    tangent = np.tan(fovy_rad / 2.0)
    distance = max(
        float(np.max(np.abs(y) / tangent - z)), float(np.max(np.abs(x) / tangent * height / width - z))
    )
    return look_at(middle + 1.04 * distance * outward, middle, width, height, fovy_rad)


def pinhole(width: int, height: int, fovy_rad: float) -> Floats:
    """Return intrinsics (3, 3) with square pixels and a centred principal point."""
    focal = height / 2.0 / np.tan(fovy_rad / 2.0)
    return np.array([[focal, 0.0, width / 2.0], [0.0, focal, height / 2.0], [0.0, 0.0, 1.0]])


def pixel_rays(view: View) -> Floats:
    """Return (H * W, 3) the point at depth 1 m on each pixel's ray, in the camera frame."""
    u, v = np.meshgrid(np.arange(view.width) + 0.5, np.arange(view.height) + 0.5)
    k = view.intrinsics
    return np.stack([(u - k[0, 2]) / k[0, 0], (v - k[1, 2]) / k[1, 1], np.ones_like(u)], axis=-1).reshape(
        -1, 3
    )
