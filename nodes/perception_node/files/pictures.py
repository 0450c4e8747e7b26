"""A frame as two pictures: colour, and depth with what the camera's lens does."""

from __future__ import annotations

from pathlib import Path

import msgspec
import numpy as np
from msgspec import Struct
from PIL import Image

from nodes.perception_node.cloud import Cloud
from nodes.perception_node.projection import cloud_of, fits

_DEPTH_MODES = ("I;16", "I;16B", "I", "F")
_MOST_PIXELS = 50_000_000


class Lens(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A pinhole camera [pixel], the middle of the first pixel at 0.

    `depth_scale` makes metres of a depth picture's numbers.
    `map_from_camera` is the (4, 4) pose of the camera row by row, where somebody knows it.
    """

    fx: float
    fy: float
    cx: float
    cy: float
    depth_scale: float = 0.001
    map_from_camera: tuple[float, ...] | None = None


def read_lens(path: Path) -> Lens:
    """The lens in a JSON file. Raises ValueError saying what is wrong, and OSError."""
    try:
        lens = msgspec.json.decode(path.read_bytes(), type=Lens)
    except msgspec.DecodeError as error:
        raise ValueError(f"no intrinsics: {error}") from None
    if not (lens.fx > 0 and lens.fy > 0 and lens.depth_scale > 0):
        raise ValueError("no intrinsics: fx, fy and depth_scale must be above 0")
    if lens.map_from_camera is not None and len(lens.map_from_camera) != 16:
        raise ValueError(f"map_from_camera must have 16 numbers, not {len(lens.map_from_camera)}")
    return lens


def is_depth(path: Path) -> bool:
    """Whether a picture is one of depth: 16 bits or more in a single channel. Raises ValueError, OSError."""
    with _opened(path) as image:
        return image.mode in _DEPTH_MODES


def read_pictures(depth: Path, color: Path | None, lens: Lens) -> Cloud:
    """The frame of a depth picture and one of colour. Raises ValueError saying what is wrong, and OSError."""
    with _opened(depth) as image:
        depth_m = np.asarray(image, dtype=np.float32) * np.float32(lens.depth_scale)
    colors = None
    if color is not None:
        with _opened(color) as image:
            colors = np.asarray(image.convert("RGB"))
        if colors.shape[:2] != depth_m.shape:
            (h, w), (height, width) = colors.shape[:2], depth_m.shape
            raise ValueError(f"colour is {w} x {h} pixels, depth {width} x {height}")
    intrinsics = np.array([[lens.fx, 0, lens.cx + 0.5], [0, lens.fy, lens.cy + 0.5], [0, 0, 1]])
    height, width = depth_m.shape
    if not fits(intrinsics, width, height):
        raise ValueError(
            f"a lens of fx {lens.fx:g} fy {lens.fy:g} cx {lens.cx:g} cy {lens.cy:g} does not fit a picture of"
            f" {width} x {height} pixels"
        )
    pose = None if lens.map_from_camera is None else np.reshape(lens.map_from_camera, (4, 4))
    return cloud_of(depth_m, colors, intrinsics, pose)


def _opened(path: Path) -> Image.Image:
    try:
        image = Image.open(path)
        if image.width * image.height > _MOST_PIXELS:
            raise ValueError(f"a picture of {image.width} x {image.height} pixels is too big")
        image.load()
    except (SyntaxError, Image.DecompressionBombError) as error:
        raise ValueError(f"no picture: {error}") from None
    except OSError as error:
        if error.errno is not None:
            raise
        raise ValueError("no picture, or a truncated one") from None
    return image
