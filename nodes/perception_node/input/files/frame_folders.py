"""Folders of frames: in each a colour picture, a depth picture, and the camera that took them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import FARTHEST_M, FEWEST_POINTS, NEAREST_M, Cloud, Floats
from semmap.nodes.perception_node.input.files import units
from semmap.nodes.perception_node.input.files.image_files import opened, pose_of
from semmap.nodes.perception_node.input.projection import cloud_of, fits, thinned, thinning
from semmap.schemas import codec
from semmap.schemas.errors import BadFile
from semmap.schemas.wording import few, sentence

COLOUR, DEPTH, CAMERA = "rgb.png", "depth.png", "camera.json"
_FILES = (COLOUR, DEPTH, CAMERA)

_MM_M = 0.001


class FrameCamera(Struct, frozen=True, kw_only=True):
    """What `camera.json` says: a pinhole [pixel], the corner of the picture at 0, and maybe its pose.

    `width` and `height`: the pictures that it is for, where it says so. `depth_scale`: metres of 1 in the
    depth picture, where that is not in millimetres. `map_from_camera`: (4, 4), row by row, of the optical
    frame (x right, y down, z forward) [m].
    """

    fx: float
    fy: float
    cx: float
    cy: float
    width: int | None = None
    height: int | None = None
    depth_scale: float | None = None
    map_from_camera: tuple[Any, ...] | None = None


@dataclass(frozen=True)
class FileFrame:
    """A frame as it was read: its cloud, of every `step`-th pixel, and the pictures' own rows and columns."""

    cloud: Cloud
    step: int
    shape: tuple[int, int]


def frames_in(folder: Path) -> list[Path]:
    """The folders of a dataset's frames, in the order of their names; hidden ones are none.

    A folder that is a frame itself is the only one of a dataset. Raises BadFile when there are none.
    """
    if (folder / CAMERA).exists():
        return [folder]
    try:
        found = sorted(p for p in folder.iterdir() if p.is_dir() and not p.name.startswith("."))
    except NotADirectoryError:
        raise BadFile(
            f"{folder} is no folder; of a recording make one first: semmap frames {folder} DIR"
        ) from None
    except OSError as error:
        raise BadFile(f"{folder} cannot be read: {error.strerror}") from None
    if {path.name for path in found} >= {"rgb", "depth"}:
        raise BadFile(f"{folder} is a recording; first make it folders of frames: semmap frames {folder} DIR")
    if not found:
        raise BadFile(f"{folder} has no folders of frames; each holds {COLOUR}, {DEPTH} and {CAMERA}")
    return found


def read_frame(folder: Path) -> FileFrame:
    """The frame in a folder. Raises BadFile saying what is wrong with it."""
    missing = [name for name in _FILES if not (folder / name).exists()]
    if missing:
        raise BadFile(f"{folder.name} lacks {few(missing)}")
    of = CAMERA
    try:
        camera = _camera(folder / CAMERA)
        of = COLOUR
        with opened(folder / COLOUR) as image:
            rgb = np.asarray(image.convert("RGB"))
        of = DEPTH
        with opened(folder / DEPTH) as image:
            numbers = np.asarray(image) if image.mode in ("I;16", "I;16B", "I;16L", "I") else None
            is_float = image.mode == "F"
        if is_float:
            raise ValueError("its numbers are floats; it must have whole ones of 16 bits: metres times 1000")
        if numbers is None:
            raise ValueError("it must have 16 bits in a single channel: millimetres, 0 for nothing seen")
        if rgb.shape[:2] != numbers.shape:
            (height, width), (rows, columns) = rgb.shape[:2], numbers.shape
            raise ValueError(f"colour is {width} x {height} pixels, depth {columns} x {rows}")
        if not numbers.any():
            raise ValueError("it has no depth anywhere: all of its numbers are 0")
        if camera.depth_scale is None and (told := units.doubt(numbers, _MM_M)) is not None:
            raise ValueError(
                f'{told}; it must be in millimetres, or say "depth_scale": {told.scale_m:g} in {CAMERA}'
            )
        of = CAMERA
        scale_m = np.float32(camera.depth_scale or _MM_M)
        return _put_together(rgb, (numbers * scale_m).astype(np.float32), camera)
    except OSError as error:
        raise BadFile(f"{folder.name}/{of} cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise BadFile(f"{folder.name}/{of}: {error}") from None


def _camera(path: Path) -> FrameCamera:
    try:
        camera = msgspec.json.decode(path.read_bytes(), type=codec.prepared(FrameCamera))
    except msgspec.DecodeError as error:
        raise ValueError(sentence(error, FrameCamera)) from None
    if camera.depth_scale is not None and not camera.depth_scale > 0:
        raise ValueError("depth_scale must be positive")
    return camera


def _put_together(rgb: NDArray[np.uint8], depth_m: Floats, camera: FrameCamera) -> FileFrame:
    height, width = depth_m.shape
    intrinsics = np.array([[camera.fx, 0, camera.cx], [0, camera.fy, camera.cy], [0, 0, 1]])
    said = (camera.width or width, camera.height or height)
    if said != (width, height) or not fits(intrinsics, width, height):
        of = f"{said[0]} x {said[1]}" if said != (width, height) else "another size"
        raise ValueError(
            f"the intrinsics are those of pictures of {of}; these have {width} x {height} pixels"
        )
    step = thinning(width, height)
    depth_m, colours, intrinsics = thinned(depth_m, rgb, intrinsics, step)
    cloud = cloud_of(depth_m, colours, intrinsics, pose_of(camera.map_from_camera))
    if cloud.measured < FEWEST_POINTS:
        raise ValueError(f"{DEPTH} has no depth from {NEAREST_M:g} to {FARTHEST_M:g} m")
    return FileFrame(cloud, step, (height, width))
