"""Folders of frames: each with a colour image, a depth image, and a camera file."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import FARTHEST_M, FEWEST_POINTS, NEAREST_M, Cloud, Floats
from semmap.nodes.perception_node.input.files.camera_files import (
    CAMERA,
    DEPTHS,
    PinholeCamera,
    pose_of,
    read_camera,
)
from semmap.nodes.perception_node.input.files.depth_files import read_depth, to_metres
from semmap.nodes.perception_node.input.files.image_files import read_colour, require_same_size
from semmap.nodes.perception_node.input.projection import cloud_of, thinned, thinning
from semmap.schemas.errors import BadFile
from semmap.schemas.wording import few

COLOUR, DEPTH = "rgb.png", DEPTHS[0]
_COLOURS = (COLOUR, "rgb.jpg", "rgb.jpeg")


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
        for names in (_COLOURS, DEPTHS, (CAMERA,))
    )
    if not (colour and depth and of):
        names = zip((colour, depth, of), (COLOUR, DEPTH, CAMERA), strict=True)
        raise BadFile(f"{folder.name} lacks {few([name for found, name in names if not found])}")
    try:
        camera = read_camera(folder / CAMERA)
        of = colour
        rgb = read_colour(folder / colour)
        of = depth
        numbers = read_depth(folder / depth)
        require_same_size(rgb, numbers)
        depth_m = to_metres(numbers, camera.depth_scale, CAMERA)
        of = CAMERA
        return _to_frame(rgb, depth_m, camera)
    except OSError as error:
        raise BadFile(f"{folder.name}/{of} cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise BadFile(f"{folder.name}/{of}: {error}") from None


def _to_frame(rgb: NDArray[np.uint8], depth_m: Floats, camera: PinholeCamera) -> FileFrame:
    height, width = depth_m.shape
    note = camera.check(width, height)
    step = thinning(width, height)
    depth_m, colours, intrinsics = thinned(depth_m, rgb, camera.intrinsics, step)
    cloud = cloud_of(depth_m, colours, intrinsics, pose_of(camera.map_from_camera))
    if cloud.measured < FEWEST_POINTS:
        raise ValueError(f"the depth image has no depth from {NEAREST_M:g} to {FARTHEST_M:g} m")
    notes = (f"{CAMERA}: {note}",) if note else ()
    return FileFrame(replace(cloud, notes=notes), step, (height, width))
