"""The frame of a recording, and its folder."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from semmap.nodes.perception_node.input.files import units
from semmap.schemas.errors import BadFile, BadRequest, SemmapError

_MM = 1000.0
_FARTHEST_MM = 65_535
_DIGITS = 9
"""The decimals of the seconds in a folder name, so that names are in the order of time."""


@dataclass(frozen=True)
class RecordedFrame:
    """A frame of a camera, with depth aligned to colour.

    `rgb`: (H, W, 3). `depth_m`: (H, W) along the optical axis [m], 0 for no measurement. `intrinsics`: (3, 3)
    [pixel], with the corner of the image at 0. `map_from_camera`: (4, 4) of the optical frame [m], if known.
    """

    stamp_ns: int
    rgb: NDArray[np.uint8]
    depth_m: NDArray[np.float32]
    intrinsics: NDArray[np.float64]
    map_from_camera: NDArray[np.float64] | None = None

    @property
    def name(self) -> str:
        """The name of its folder: the time of the frame [s]."""
        seconds, rest = divmod(self.stamp_ns, 1_000_000_000)
        return f"{seconds:010d}.{rest:0{_DIGITS}d}"


@dataclass(frozen=True)
class Recording:
    """The frames of a recording, or the errors of frames; `notes` are messages for the user."""

    count: int
    frames: Iterator[RecordedFrame | SemmapError]
    notes: Sequence[str] = ()


def require_plausible_unit(depth_m: NDArray[np.float32], scale_m: float) -> None:
    """Raise BadFile if depth (H, W) [m] seems to be in another unit than `scale_m` metres."""
    doubt = units.doubt(depth_m / scale_m, scale_m)
    if doubt is not None:
        raise BadFile(
            f'{doubt}: add --intrinsics FILE.json with fx, fy, cx, cy and "depth_scale": {doubt.scale_m:g}'
        )


def require_empty(folder: Path) -> None:
    """Raise BadRequest for a folder that is not empty, and BadFile for a path that cannot be a folder."""
    try:
        if folder.exists() and any(folder.iterdir()):
            raise BadRequest(f"{folder} is not empty; name a new folder for the frames")
    except OSError as error:
        raise BadFile(f"{folder} cannot be a folder of frames: {error.strerror}") from None


def make(folder: Path) -> None:
    """Create a folder for frames. Raises BadFile."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BadFile(f"{folder} cannot be created: {error.strerror}") from None


def write(frame: RecordedFrame, dataset: Path) -> None:
    """Write the folder of a frame into `dataset`, completely or not at all. Raises BadFile."""
    height, width = frame.depth_m.shape
    depth_mm = np.round(np.nan_to_num(frame.depth_m, posinf=0.0, neginf=0.0) * _MM)
    depth_mm[(depth_mm < 0) | (depth_mm > _FARTHEST_MM)] = 0
    (fx, _, cx), (_, fy, cy), _ = frame.intrinsics.tolist()
    camera = {"fx": fx, "fy": fy, "cx": cx, "cy": cy, "width": width, "height": height, "first_pixel": 0.5}
    if frame.map_from_camera is not None:
        camera["map_from_camera"] = frame.map_from_camera.tolist()
    unfinished = dataset / f".{frame.name}"
    try:
        unfinished.mkdir()
        Image.fromarray(frame.rgb).save(unfinished / "rgb.png", compress_level=1)
        Image.fromarray(depth_mm.astype(np.uint16)).save(unfinished / "depth.png", compress_level=1)
        (unfinished / "camera.json").write_text(json.dumps(camera))
        unfinished.rename(dataset / frame.name)
    except OSError as error:
        shutil.rmtree(unfinished, ignore_errors=True)
        raise BadFile(f"{dataset / frame.name} cannot be written: {error.strerror}") from None
