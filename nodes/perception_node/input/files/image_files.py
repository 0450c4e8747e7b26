"""A frame as two images, colour and depth, and the camera file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import Cloud, Transform
from semmap.nodes.perception_node.input.files import units
from semmap.nodes.perception_node.input.projection import cloud_of, fits, is_pose
from semmap.nodes.runtime.pictures import open_picture
from semmap.schemas import codec
from semmap.schemas.wording import sentence

_DEPTH_MODES = ("I;16", "I;16B", "I", "F")
_MM_M = 0.001


class PinholeCamera(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A pinhole camera [pixel], with the centre of the first pixel at 0.

    `depth_scale`: metres per unit of the depth image; by default integers are millimetres and floats metres.
    `width` and `height`: the image size, if given. `map_from_camera`: the (4, 4) pose of the camera, as
    sixteen numbers or four rows, if known.
    """

    fx: float
    fy: float
    cx: float
    cy: float
    width: int | None = None
    height: int | None = None
    depth_scale: float | None = None
    map_from_camera: tuple[Any, ...] | None = None

    @property
    def size(self) -> tuple[int, int] | None:
        """Return width and height of the image, if given."""
        return (self.width, self.height) if self.width and self.height else None


def read_camera(path: Path) -> PinholeCamera:
    """Read the camera in a JSON file. Raises ValueError and OSError."""
    try:
        camera = msgspec.json.decode(path.read_bytes(), type=codec.prepared(PinholeCamera))
    except msgspec.DecodeError as error:
        raise ValueError(f"invalid intrinsics: {sentence(error, PinholeCamera)}") from None
    if not (camera.fx > 0 and camera.fy > 0 and (camera.depth_scale is None or camera.depth_scale > 0)):
        raise ValueError("invalid intrinsics: fx, fy and depth_scale must be positive")
    pose_of(camera.map_from_camera)
    return camera


def pose_of(numbers: tuple[Any, ...] | None) -> Transform | None:
    """Return the (4, 4) pose of sixteen numbers or four rows. Raises ValueError if it is invalid."""
    if numbers is None:
        return None
    try:
        found = np.array(numbers, dtype=float)
    except (TypeError, ValueError):
        found = np.empty(0)
    if found.size != 16 or not is_pose(found.reshape(4, 4)):
        raise ValueError("map_from_camera is not a 4 x 4 pose matrix: rotation, position, last row 0 0 0 1")
    return found.reshape(4, 4)


def is_depth(path: Path) -> bool:
    """Return whether an image is of depth: 16 bits or more in one channel. Raises ValueError, OSError."""
    with open_picture(path) as image:
        return image.mode in _DEPTH_MODES


def read_pictures(depth: Path, color: Path | None, camera: PinholeCamera) -> Cloud:
    """Return the cloud of a depth and a colour image. Raises ValueError and OSError."""
    depth_m = _depth_m(depth, camera)
    colors = None
    if color is not None:
        with open_picture(color) as image:
            colors = np.asarray(image.convert("RGB"))
        if colors.shape[:2] != depth_m.shape:
            (h, w), (height, width) = colors.shape[:2], depth_m.shape
            raise ValueError(f"colour is {w} x {h} pixels, depth {width} x {height}")
    intrinsics = np.array([[camera.fx, 0, camera.cx + 0.5], [0, camera.fy, camera.cy + 0.5], [0, 0, 1]])
    height, width = depth_m.shape
    if (of := camera.size or (width, height)) != (width, height):
        raise ValueError(
            f"the intrinsics are for images of {of[0]} x {of[1]}; this one has {width} x {height} pixels"
        )
    if not fits(intrinsics, width, height):
        values = " ".join(f"{name} {getattr(camera, name):g}" for name in ("fx", "fy", "cx", "cy"))
        raise ValueError(f"the intrinsics {values} do not fit an image of {width} x {height} pixels")
    return cloud_of(depth_m, colors, intrinsics, pose_of(camera.map_from_camera))


def _depth_m(path: Path, camera: PinholeCamera) -> NDArray[np.float32]:
    """Return depth (H, W) [m]. Raises ValueError for values that seem to be in another unit, and OSError."""
    with open_picture(path) as image:
        numbers, is_float = np.asarray(image, dtype=np.float32), image.mode == "F"
    if camera.depth_scale is not None:
        return np.asarray(numbers * np.float32(camera.depth_scale), np.float32)
    scale_m = 1.0 if is_float else _MM_M
    if (doubt := units.doubt(numbers, scale_m)) is not None:
        raise ValueError(f'{doubt}; set "depth_scale": {doubt.scale_m:g} in the intrinsics')
    return np.asarray(numbers * np.float32(scale_m), np.float32)
