"""A frame as two images, colour and depth, and the camera file."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.files.camera_files import PinholeCamera, pose_of, require_fit
from semmap.nodes.perception_node.input.files.depth_files import read_depth, to_metres
from semmap.nodes.perception_node.input.projection import cloud_of
from semmap.nodes.runtime.pictures import open_picture


def read_pictures(depth: Path, color: Path | None, camera: PinholeCamera) -> Cloud:
    """Return the cloud of a depth and a colour image. Raises ValueError and OSError."""
    depth_m = to_metres(read_depth(depth), camera.depth_scale, "the intrinsics")
    colors = None
    if color is not None:
        with open_picture(color) as image:
            colors = np.asarray(image.convert("RGB"))
        if colors.shape[:2] != depth_m.shape:
            (h, w), (height, width) = colors.shape[:2], depth_m.shape
            raise ValueError(f"colour is {w} x {h} pixels, depth {width} x {height}")
    intrinsics = np.array([[camera.fx, 0, camera.cx + 0.5], [0, camera.fy, camera.cy + 0.5], [0, 0, 1]])
    height, width = depth_m.shape
    require_fit(intrinsics, width, height, camera.size, offset_px=0.5)
    return cloud_of(depth_m, colors, intrinsics, pose_of(camera.map_from_camera))
