"""Image folders in the TUM format: rgb.txt, depth.txt and, optionally, groundtruth.txt."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.extern.frame_folders.frames import RecordedFrame, Recording, require_plausible_unit
from semmap.nodes.extern.frame_folders.pairs import pairs
from semmap.nodes.extern.frame_folders.pinhole import from_pixel_centres, scale_intrinsics
from semmap.nodes.extern.frame_folders.poses import Trajectory
from semmap.nodes.perception_node.input.files.camera_files import load_camera
from semmap.nodes.perception_node.input.files.depth_files import read_depth
from semmap.nodes.perception_node.input.files.image_files import read_colour
from semmap.schemas import errors
from semmap.schemas.errors import BadFile, BadRequest, SemmapError

_COLOUR, _DEPTH, _POSES = "rgb", "depth", "groundtruth.txt"
_SCALE_M: Final = 1.0 / 5000.0
"""The depth unit of the TUM format: 5000 per metre."""
_CALIBRATED: Final = {
    "1": (517.3, 516.5, 318.6, 255.3),
    "2": (520.9, 521.0, 325.1, 249.7),
    "3": (535.4, 539.2, 320.1, 247.6),
}
"""The cameras of the TUM datasets, `freiburg1` to 3: fx, fy, cx, cy."""
_SIZE: Final = (640, 480)
_PICTURES: Final = (".png", ".jpg", ".jpeg", ".tif", ".tiff")

Listed = list[tuple[int, Path]]
"""Images with their stamps [ns]."""


def read(folder: Path, *, within_s: float, every_s: float, intrinsics: Path | None) -> Recording:
    """Return the frames of a folder. Raises BadFile and BadRequest if there are none."""
    colours, depths = (_listed(folder, kind) for kind in (_COLOUR, _DEPTH))
    pinhole, scale_m, note = _camera(folder, intrinsics)
    found = pairs([at for at, _ in colours], [at for at, _ in depths], within_s, every_s)
    if not found.taken:
        raise BadFile(
            f"{folder}: no colour and depth images are within {within_s:g} s of each other; use a larger"
            " --within"
        )
    poses = _poses(folder / _POSES)
    notes = [*found.notes, note]
    if poses is None:
        notes.append(f"no camera poses: there is no file {_POSES}")

    def frames() -> Iterator[RecordedFrame | SemmapError]:
        for colour, depth in found.taken:
            (stamp_ns, of), (_, of_depth) = colours[colour], depths[depth]
            try:
                rgb, depth_m = _colour(of), _depth_m(of_depth, scale_m)
                if rgb.shape[:2] != depth_m.shape:
                    raise BadFile(
                        f"{of.name} is {rgb.shape[1]} x {rgb.shape[0]} pixels,"
                        f" {of_depth.name} {depth_m.shape[1]} x {depth_m.shape[0]}"
                    )
                require_plausible_unit(depth_m, scale_m)
                pose = None if poses is None else poses.at(stamp_ns)
                size = (depth_m.shape[1], depth_m.shape[0])
                yield RecordedFrame(stamp_ns, rgb, depth_m, pinhole(size), pose)
            except SemmapError as error:
                yield error

    return Recording(len(found.taken), frames(), notes)


def _listed(folder: Path, kind: str) -> Listed:
    """Return the images listed in `rgb.txt` or `depth.txt`, or else those in the folder of that name."""
    index = folder / f"{kind}.txt"
    try:
        if index.exists():
            rows = [row.split() for row in index.read_text("utf-8-sig", "replace").splitlines()]
            found = [
                (_stamp_ns(row[0], index), folder / row[1])
                for row in rows
                if len(row) > 1 and not row[0].startswith("#")
            ]
        else:
            pictures = sorted(path for path in (folder / kind).iterdir() if path.suffix in _PICTURES)
            found = [(_stamp_ns(path.stem, folder / kind), path) for path in pictures]
    except OSError:
        raise BadFile(
            f"{folder} has no {kind}.txt and no folder {kind}; a recording is a .bag, .db3 or .mcap file, a"
            " rosbag2 folder, or a folder with rgb, depth, rgb.txt and depth.txt"
        ) from None
    if not found:
        raise BadFile(f"{folder}: no {kind} images found")
    return found


def _stamp_ns(text: str, of: Path) -> int:
    """Return the stamp of an image from a text in seconds. Raises BadFile."""
    if not re.fullmatch(r"\d+(\.\d+)?", text):
        raise BadFile(f"{of}: '{text}' is not a time in seconds, such as 1305031102.1753")
    seconds, _, rest = text.partition(".")
    return int(seconds) * 1_000_000_000 + int(rest[:9].ljust(9, "0"))


def _camera(
    folder: Path, intrinsics: Path | None
) -> tuple[Callable[[tuple[int, int]], NDArray[np.float64]], float, str]:
    """Return a function from (width, height) to intrinsics, the depth unit [m], and a note."""
    dataset = re.search(r"freiburg([123])", folder.resolve().name)
    if intrinsics is None and dataset is None:
        raise BadRequest(
            f"{folder}: unknown camera; add --intrinsics FILE.json with fx, fy, cx, cy and, unless 5000 is"
            " 1 m in the depth images, depth_scale"
        )
    if intrinsics is not None:
        camera = load_camera(intrinsics)
        matrix, scale_m = camera.intrinsics, camera.depth_scale or _SCALE_M
        whence, of_size = str(intrinsics), camera.size
    else:
        if dataset is None:
            raise errors.InternalError("the calibration of the camera is unknown")
        matrix, scale_m, whence = (
            from_pixel_centres(*_CALIBRATED[dataset[1]]),
            _SCALE_M,
            f"TUM's freiburg{dataset[1]}",
        )
        of_size = _SIZE

    def of(size: tuple[int, int]) -> NDArray[np.float64]:
        try:
            return scale_intrinsics(matrix, of_size or size, size)
        except ValueError as error:
            raise BadFile(f"{whence}: {error}") from None

    return of, scale_m, f"camera of {whence}, 1 m is {1 / scale_m:g} in depth images"


def _poses(path: Path) -> Trajectory | None:
    """Read lines of `time x y z qx qy qz qw`; return None without such a file. Raises BadFile."""
    if not path.exists():
        return None
    found = Trajectory()
    for number, row in enumerate(path.read_text("utf-8-sig", "replace").splitlines(), 1):
        words = row.split()
        if not words or words[0].startswith("#"):
            continue
        try:
            x, y, z, qx, qy, qz, qw = map(float, words[1:])
        except ValueError:
            raise BadFile(f"{path}: line {number} is not a pose: time x y z qx qy qz qw") from None
        found.add(_stamp_ns(words[0], path), (x, y, z), (qw, qx, qy, qz))
    return found


def _colour(path: Path) -> NDArray[np.uint8]:
    try:
        return read_colour(path)
    except OSError as error:
        raise BadFile(f"{path} cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise BadFile(f"{path}: {error}") from None


def _depth_m(path: Path, scale_m: float) -> NDArray[np.float32]:
    """Return the depth (H, W) [m] of an image; floats are in metres."""
    try:
        numbers = read_depth(path)
        return np.asarray(numbers * np.float32(1.0 if numbers.dtype.kind == "f" else scale_m), np.float32)
    except OSError as error:
        raise BadFile(f"{path} cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise BadFile(f"{path}: {error}") from None
