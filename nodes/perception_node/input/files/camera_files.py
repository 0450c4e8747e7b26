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
from semmap.nodes.perception_node.input.projection import fits, is_pose
from semmap.schemas import codec
from semmap.schemas.wording import sentence

_WANTED = "expected fx, fy, cx and cy, a matrix K, Open3D's intrinsic_matrix, or a camera_info file of ROS"
_MATRICES = ("intrinsic_matrix", "K", "k", "camera_matrix")
_PROJECTIONS = ("P", "p", "projection_matrix")
_DISTORTIONS = ("D", "d", "distortion_coefficients")
_SIZES = (("width", "image_width"), ("height", "image_height"))
_OPTIONAL = ("depth_scale", "map_from_camera")
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_FOCAL = (0.2, 3.0)
"""Range of the focal length of depth cameras relative to the longer side: a view of 19 to 136 degrees."""
_USUAL_FOCAL = 0.9


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
    """Read the camera in a file. Raises ValueError and OSError.

    The file is JSON with fx, fy, cx and cy (or RealSense's ppx and ppy), JSON of Open3D, a `camera_info` of
    ROS in YAML or JSON, or the nine numbers of a matrix as text. Its origin is the centre of the first pixel.
    """
    try:
        text = path.read_bytes().decode()
        if re.fullmatch(rf"(?:[\s\[\](),;]|{_NUMBER})*", text) and re.search(r"\d", text):
            camera = _of_entries({"K": _numbers(text)})
        elif text.lstrip().startswith(("{", "[")):
            camera = _of_json(text)
        else:
            camera = _of_entries(_yaml_entries(text))
    except UnicodeDecodeError:
        raise ValueError(f"invalid intrinsics: not text; {_WANTED}") from None
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


def require_fit(
    intrinsics: Transform,
    width: int,
    height: int,
    declared: tuple[int, int] | None = None,
    offset_px: float = 0.0,
) -> None:
    """Raise ValueError if intrinsics (3, 3) cannot be those of a depth image of this size [pixel].

    The image corner is at 0, and at `-offset_px` in the file of the intrinsics. `declared`: width and height
    that the file names. The message has the values of the file, and likely ones.
    """
    if declared not in (None, (width, height)):
        raise ValueError(
            f"the intrinsics are for images of {' x '.join(map(str, declared or ()))}; this one has {width} x"
            f" {height} pixels"
        )
    fx, fy, cx, cy = (intrinsics[[0, 1, 0, 1], [0, 1, 2, 2]] - [0, 0, offset_px, offset_px]).tolist()
    values, image = f"fx {fx:g} fy {fy:g} cx {cx:g} cy {cy:g}", f"an image of {width} x {height} pixels"
    side = max(width, height)
    if not all(_FOCAL[0] * side <= focal <= _FOCAL[1] * side for focal in (fx, fy)):
        view = np.degrees(2 * np.arctan2(width / 2, fx))
        raise ValueError(
            f"the intrinsics {values} do not fit {image}: its view would be {view:.0f} degrees wide; fx and"
            f" fy are probably about {_USUAL_FOCAL * side:.0f}"
        )
    if not fits(intrinsics, width, height):
        raise ValueError(
            f"the intrinsics {values} do not fit {image}; cx is probably about {width / 2 - offset_px:g}, cy"
            f" about {height / 2 - offset_px:g}"
        )


def _of_json(text: str) -> PinholeCamera:
    found = msgspec.json.decode(text)
    if not isinstance(found, dict):
        raise ValueError(f"invalid intrinsics: {_WANTED}")
    if "ppx" in found and "ppy" in found:  # as RealSense's tools name them, beside a distortion
        found = {key: found.get(key) for key in ("fx", "fy", "width", "height", *_OPTIONAL)} | {
            "cx": found["ppx"],
            "cy": found["ppy"],
        }
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
