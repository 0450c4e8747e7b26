"""Cameras in files: JSON of several programs, `camera_info` files of ROS, and matrices."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from msgspec import Struct

from semmap.nodes.perception_node.input.cloud import Transform
from semmap.nodes.perception_node.input.projection import check_intrinsics, is_pose
from semmap.schemas import codec
from semmap.schemas.errors import BadFile
from semmap.schemas.wording import sentence

CAMERA = "camera.json"
DEPTHS = ("depth.png", "depth.npy", "depth.npz", "depth.pgm", "depth.tiff", "depth.tif", "depth.exr")
"""The files of a frame in its folder: its camera, and one of these depth images."""
_WANTED = "expected fx, fy, cx and cy, a matrix K, Open3D's intrinsic_matrix, or a camera_info file of ROS"
_MATRICES = ("intrinsic_matrix", "K", "k", "camera_matrix")
_PROJECTIONS = ("P", "p", "projection_matrix")
_DISTORTIONS = ("D", "d", "distortion_coefficients")
_SIZES = (("width", "image_width"), ("height", "image_height"))
_OPTIONAL = ("depth_scale", "map_from_camera", "first_pixel")
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_OWN = ("fx", "fy", "cx", "cy", "width", "height", *_OPTIONAL)


class PinholeCamera(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A pinhole camera [pixel] with the values of its file.

    `first_pixel`: the coordinate of the centre of the first pixel: 0, or 0.5 if the image corner is at 0.
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
    first_pixel: float = 0.0

    @property
    def size(self) -> tuple[int, int] | None:
        """Return width and height of the image, if given."""
        return (self.width, self.height) if self.width and self.height else None

    @property
    def intrinsics(self) -> Transform:
        """Return the matrix (3, 3) with the image corner at 0, as in `Cloud`."""
        corner = 0.5 - self.first_pixel
        return np.array([[self.fx, 0.0, self.cx + corner], [0.0, self.fy, self.cy + corner], [0.0, 0.0, 1.0]])

    def check(self, width: int, height: int) -> str:
        """Return a doubt that this is the camera of an image of this size; see `check_intrinsics`.

        Raises ValueError if it cannot be.
        """
        declared = self.width or width, self.height or height
        if declared != (width, height):
            raise ValueError(
                f"the intrinsics are for images of {declared[0]} x {declared[1]}; this one has {width} x"
                f" {height} pixels"
            )
        return check_intrinsics(self.intrinsics, width, height, self.first_pixel)


def load_camera(path: Path) -> PinholeCamera:
    """Read the camera in a file, as `read_camera`. Raises BadFile."""
    try:
        return read_camera(path)
    except OSError as error:
        raise BadFile(f"{path} cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise BadFile(f"{path}: {error}") from None


def read_camera(path: Path) -> PinholeCamera:
    """Read the camera in a file. Raises ValueError and OSError.

    The file is JSON with fx, fy, cx and cy (or RealSense's ppx and ppy), JSON of Open3D, a `camera_info` of
    ROS in YAML or JSON, or the nine numbers of a matrix as text. The centre of the first pixel is at 0. In
    the own format, `first_pixel` may be another coordinate, and it is 0.5 by default in the `camera.json` of
    a frame's folder, from wherever the file is read. Keys that this format does not have are ignored there.
    """
    own = path.name == CAMERA and any((path.parent / name).exists() for name in DEPTHS)
    try:
        text = codec.decode_text(path.read_bytes())
        if re.fullmatch(rf"(?:[\s\[\](),;]|{_NUMBER})*", text) and re.search(r"\d", text):
            camera = _of_entries({"K": _numbers(text)})
        elif text.lstrip().startswith(("{", "[")):
            camera = _of_json(text, of_frame=own)
        else:
            camera = _of_entries(_yaml_entries(text))
    except UnicodeDecodeError:
        raise ValueError(f"invalid intrinsics: not text; {_WANTED}") from None
    except msgspec.DecodeError as error:
        raise ValueError(f"invalid intrinsics: {sentence(error, PinholeCamera)}") from None
    if not (camera.fx > 0 and camera.fy > 0 and (camera.depth_scale is None or camera.depth_scale > 0)):
        raise ValueError("invalid intrinsics: fx, fy and depth_scale must be positive")
    if not 0 <= camera.first_pixel <= 1:
        raise ValueError("invalid intrinsics: first_pixel must be 0, or 0.5 if the image corner is at 0")
    pose_of(camera.map_from_camera)
    return camera


def pose_of(numbers: tuple[Any, ...] | None, name: str = "map_from_camera") -> Transform | None:
    """Return the (4, 4) pose of sixteen numbers or four rows. Raises ValueError if it is invalid."""
    if numbers is None:
        return None
    try:
        found = np.array(numbers, dtype=float)
    except (TypeError, ValueError):
        found = np.empty(0)
    if found.size != 16 or not is_pose(found.reshape(4, 4)):
        raise ValueError(f"{name} is not a 4 x 4 pose matrix: rotation, position, last row 0 0 0 1")
    return found.reshape(4, 4)


def _of_json(text: str, *, of_frame: bool) -> PinholeCamera:
    found = codec.decode_json(text)
    if not isinstance(found, dict):
        raise ValueError(f"invalid intrinsics: {_WANTED}")
    if "ppx" in found and "ppy" in found:  # as RealSense's tools name them, beside a distortion
        found = {key: found[key] for key in _OWN if key in found} | {
            "cx": found["ppx"],
            "cy": found["ppy"],
        }
    elif of_frame and "fx" in found:
        found = {"first_pixel": 0.5} | {key: found[key] for key in _OWN if key in found}
    if any(name in found for name in _MATRICES):
        return _of_entries(found)
    return msgspec.convert(found, codec.prepared(PinholeCamera))


def _of_entries(entries: Mapping[str, Any]) -> PinholeCamera:
    """Return the camera with a matrix among the entries. Raises ValueError, and DecodeError of msgspec."""
    k = next((_numbers(entries[name]) for name in _MATRICES if name in entries), [])
    p = next((_numbers(entries[name]) for name in _PROJECTIONS if name in entries), [])
    distorted = any(any(_numbers(entries[name])) for name in _DISTORTIONS if name in entries)
    if distorted and len(p) == 12 and p[0] > 0:  # images are rectified, and P is the matrix of these
        k = p
    if len(k) not in (9, 12, 16):
        raise ValueError(f"invalid intrinsics: {_WANTED}")
    matrix = np.array(k).reshape(-1, 3 if len(k) == 9 else 4)[:3, :3]
    if matrix[2, :2].any() and not matrix[:2, 2].any():
        matrix = matrix.T  # column by column, as Open3D writes it
    if not np.array_equal(matrix[2], [0, 0, 1]) or abs(matrix[0, 1]) > 1e-3 * abs(matrix[0, 0]):
        raise ValueError("invalid intrinsics: the matrix must be fx 0 cx 0 fy cy 0 0 1")
    given: dict[str, Any] = {name: entries[name] for name in _OPTIONAL if name in entries}
    for own, other in _SIZES:
        size = _numbers(entries.get(own, entries.get(other, [])))
        given |= {own: int(size[0])} if size else {}
    for name, value in zip(
        ("fx", "fy", "cx", "cy"), matrix[[0, 1, 0, 1], [0, 1, 2, 2]].tolist(), strict=True
    ):
        given[name] = value
    return msgspec.convert(given, codec.prepared(PinholeCamera), strict=False)


def _yaml_entries(text: str) -> dict[str, Any]:
    """Return the first value of each key in a YAML file; that of a matrix are its numbers."""
    keys = [*re.finditer(r"(?m)^[ \t]*([A-Za-z_]\w*)[ \t]*:(?=\s|$)", text)]
    ends = [*(key.start() for key in keys[1:]), len(text)]
    values = [(key[1], text[key.end() : end]) for key, end in zip(keys, ends, strict=False)]
    found: dict[str, Any] = {}
    for n, (name, value) in enumerate(values):
        if name in (*_MATRICES, *_PROJECTIONS, *_DISTORTIONS) and not re.search(_NUMBER, value):
            value = next((data for child, data in values[n + 1 : n + 5] if child == "data"), "")
        found.setdefault(name, value.strip())
    return found


def _numbers(value: Any) -> list[float]:
    """Return the numbers in a text, a list, nested lists, or the `data` of a matrix. Raises ValueError."""
    if isinstance(value, str):
        return [float(number) for number in re.findall(_NUMBER, value)]
    if isinstance(value, dict):
        return _numbers(value.get("data", []))
    if isinstance(value, list):
        return [number for part in value for number in _numbers(part)]
    if isinstance(value, int | float):
        return [float(value)]
    raise ValueError(f"invalid intrinsics: {value!r} is not a number")
