"""Folders of frames: each with a colour image, a depth image, and a camera file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import FARTHEST_M, FEWEST_POINTS, NEAREST_M, Cloud, Floats
from semmap.nodes.perception_node.input.files.camera_files import pose_of, read_camera, require_fit
from semmap.nodes.perception_node.input.files.depth_files import read_depth, to_metres
from semmap.nodes.perception_node.input.projection import cloud_of, thinned, thinning
from semmap.nodes.runtime.pictures import open_picture
from semmap.schemas import codec
from semmap.schemas.errors import BadFile
from semmap.schemas.wording import few, sentence

COLOUR, DEPTH, CAMERA = "rgb.png", "depth.png", "camera.json"
_COLOURS = (COLOUR, "rgb.jpg", "rgb.jpeg")
_DEPTHS = (DEPTH, "depth.npy", "depth.npz", "depth.pgm", "depth.tiff", "depth.tif")


class FrameCamera(Struct, frozen=True, kw_only=True):
    """The content of `camera.json`: a pinhole [pixel] with the image corner at 0, and an optional pose.

    `width` and `height`: the image size, if given. `depth_scale`: metres per unit of the depth image; by
    default integers are millimetres and floats metres. `map_from_camera`: (4, 4), row by row, of the optical
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
    """A frame from files: the cloud of every `step`-th pixel, and the size of the image."""

    cloud: Cloud
    step: int
    shape: tuple[int, int]


def frames_in(folder: Path) -> list[Path]:
    """Return the folders of a dataset's frames by name, without hidden ones.

    A folder that is itself a frame is the only one of a dataset. Raises BadFile if there are none.
    """
    if (folder / CAMERA).exists():
        return [folder]
    try:
        found = sorted(p for p in folder.iterdir() if p.is_dir() and not p.name.startswith("."))
    except NotADirectoryError:
        raise BadFile(
            f"{folder} is not a folder; convert a recording with: semmap frames {folder} DIR"
        ) from None
    except OSError as error:
        raise BadFile(f"{folder} cannot be read: {error.strerror}") from None
    if {path.name for path in found} >= {"rgb", "depth"}:
        raise BadFile(f"{folder} is a recording; convert it with: semmap frames {folder} DIR")
    if not found:
        raise BadFile(f"{folder} has no folders of frames; each must contain {COLOUR}, {DEPTH} and {CAMERA}")
    return found


def read_frame(folder: Path) -> FileFrame:
    """Read the frame in a folder. Raises BadFile with the reason."""
    colour, depth, of = (
        next((name for name in names if (folder / name).exists()), "")
        for names in (_COLOURS, _DEPTHS, (CAMERA,))
    )
    if not (colour and depth and of):
        names = zip((colour, depth, of), (COLOUR, DEPTH, CAMERA), strict=True)
        raise BadFile(f"{folder.name} lacks {few([name for found, name in names if not found])}")
    try:
        camera = _camera(folder / CAMERA)
        of = colour
        with open_picture(folder / colour) as image:
            rgb = np.asarray(image.convert("RGB"))
        of = depth
        numbers = read_depth(folder / depth)
        if rgb.shape[:2] != numbers.shape:
            (height, width), (rows, columns) = rgb.shape[:2], numbers.shape
            raise ValueError(f"colour is {width} x {height} pixels, depth {columns} x {rows}")
        depth_m = to_metres(numbers, camera.depth_scale, CAMERA)
        of = CAMERA
        return _to_frame(rgb, depth_m, camera)
    except OSError as error:
        raise BadFile(f"{folder.name}/{of} cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise BadFile(f"{folder.name}/{of}: {error}") from None


def _camera(path: Path) -> FrameCamera:
    content = path.read_bytes()
    if b'"fx"' not in content or b'"ppx"' in content:
        other = read_camera(path)  # of another program, with the centre of the first pixel at 0
        return msgspec.convert(
            msgspec.structs.asdict(other) | {"cx": other.cx + 0.5, "cy": other.cy + 0.5}, FrameCamera
        )
    try:
        camera = msgspec.json.decode(content, type=codec.prepared(FrameCamera))
    except msgspec.DecodeError as error:
        raise ValueError(sentence(error, FrameCamera)) from None
    if camera.depth_scale is not None and not camera.depth_scale > 0:
        raise ValueError("depth_scale must be positive")
    return camera


def _to_frame(rgb: NDArray[np.uint8], depth_m: Floats, camera: FrameCamera) -> FileFrame:
    height, width = depth_m.shape
    intrinsics = np.array([[camera.fx, 0, camera.cx], [0, camera.fy, camera.cy], [0, 0, 1]])
    require_fit(intrinsics, width, height, (camera.width or width, camera.height or height))
    step = thinning(width, height)
    depth_m, colours, intrinsics = thinned(depth_m, rgb, intrinsics, step)
    cloud = cloud_of(depth_m, colours, intrinsics, pose_of(camera.map_from_camera))
    if cloud.measured < FEWEST_POINTS:
        raise ValueError(f"the depth image has no depth from {NEAREST_M:g} to {FARTHEST_M:g} m")
    return FileFrame(cloud, step, (height, width))
