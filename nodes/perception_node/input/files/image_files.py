"""A frame as two images, colour and depth, and its camera."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.files.camera_files import PinholeCamera, pose_of
from semmap.nodes.perception_node.input.files.depth_files import read_depth, to_metres
from semmap.nodes.perception_node.input.projection import cloud_of
from semmap.nodes.runtime.pictures import open_picture


def read_colour(path: Path) -> NDArray[np.uint8]:
    """Return the colours (H, W, 3) of an image. Raises ValueError and OSError."""
    with open_picture(path) as image:
        return np.asarray(image.convert("RGB"))


def require_same_size(colour: NDArray[np.uint8], depth: NDArray[np.generic]) -> None:
    """Raise ValueError if the colour and the depth image have different sizes."""
    if colour.shape[:2] != depth.shape:
        (h, w), (height, width) = colour.shape[:2], depth.shape
        raise ValueError(f"colour is {w} x {h} pixels, depth {width} x {height}")


def read_pictures(depth: Path, color: Path | None, camera: PinholeCamera) -> Cloud:
    """Return the cloud of a depth and a colour image. Raises ValueError and OSError."""
    depth_m = to_metres(read_depth(depth), camera.depth_scale, "the intrinsics")
    colors = None if color is None else read_colour(color)
    if colors is not None:
        require_same_size(colors, depth_m)
    height, width = depth_m.shape
    note = camera.check(width, height)
    cloud = cloud_of(depth_m, colors, camera.intrinsics, pose_of(camera.map_from_camera))
    return replace(cloud, notes=(note,) if note else ())
