"""Boxes on a table, seen by a good depth camera."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from semmap.nodes.perception_node.input.cloud import Cloud

FOCAL_PX = 525.0
WIDTH, HEIGHT = 640, 480


class Seen(NamedTuple):
    """A cloud, and (H, W) the number of the box at each pixel, from 1; 0 is the table or nothing."""

    cloud: Cloud
    truth: np.ndarray


def camera_pose(eye=(0.0, -0.8, 0.6), target=(0.0, 0.0, 0.0)) -> np.ndarray:
    """Return map_from_camera (4, 4) of a camera at `eye` that looks at `target`."""
    forward = np.subtract(target, eye) / np.linalg.norm(np.subtract(target, eye))
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([right, np.cross(forward, right), forward])
    pose[:3, 3] = eye
    return pose


def boxes_on_table(*boxes, pose=None, posed=False, table=((-1, -1, -0.05), (1, 1, 0))) -> Seen:
    """Return a view of boxes (lowest, highest corner), map frame [m]; the table's top is z = 0."""
    pose = camera_pose() if pose is None else pose
    u, v = np.meshgrid(np.arange(WIDTH) - WIDTH / 2 + 0.5, np.arange(HEIGHT) - HEIGHT / 2 + 0.5)
    rays = np.stack([u / FOCAL_PX, v / FOCAL_PX, np.ones_like(u)], axis=-1)
    directions = rays @ pose[:3, :3].T
    depth, truth = np.full(u.shape, np.inf), np.zeros(u.shape, np.int32)
    for number, (low, high) in enumerate((table, *boxes)):
        with np.errstate(divide="ignore"):
            one = (np.array(low) - pose[:3, 3]) / directions
            two = (np.array(high) - pose[:3, 3]) / directions
        enters, leaves = np.minimum(one, two).max(axis=-1), np.maximum(one, two).min(axis=-1)
        hit = (enters < leaves) & (enters > 0) & (enters < depth)
        depth[hit], truth[hit] = enters[hit], number
    depth[np.isinf(depth)] = np.nan
    depth += np.random.default_rng(0).normal(0, 0.001, depth.shape) * depth**2
    points = (rays * depth[..., None]).astype(np.float32)
    intrinsics = np.array([[FOCAL_PX, 0, WIDTH / 2], [0, FOCAL_PX, HEIGHT / 2], [0, 0, 1]])
    return Seen(Cloud(points, None, pose if posed else None, intrinsics), truth)
