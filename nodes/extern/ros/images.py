"""Conversion of ROS images for perception: colour as rgb8, depth in metres."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from semmap.schemas import errors

COLOURS: Final[Mapping[str, tuple[int, tuple[int, int, int]]]] = {
    "rgb8": (3, (0, 1, 2)),
    "bgr8": (3, (2, 1, 0)),
    "rgba8": (4, (0, 1, 2)),
    "bgra8": (4, (2, 1, 0)),
    "mono8": (1, (0, 0, 0)),
}
"""By encoding: the bytes per pixel, and the indices of red, green and blue."""


_DEPTHS: Final[Mapping[str, tuple[str, float]]] = {
    "16UC1": ("u2", 1e-3),
    "mono16": ("u2", 1e-3),
    "32FC1": ("f4", 1.0),
}
"""By encoding: the type of a pixel, and its unit [m]."""


def colour_of(image: Any) -> bytes:
    """Convert a `sensor_msgs/Image` to (height, width, 3) bytes. Raises BadRequest for other encodings."""
    if image.encoding not in COLOURS:
        raise errors.BadRequest(
            f"unsupported colour encoding {image.encoding!r}; supported: {', '.join(COLOURS)}"
        )
    channels, order = COLOURS[image.encoding]
    rows = _rows(image, "u1", channels).reshape(image.height, image.width, channels)
    return np.ascontiguousarray(rows[:, :, order]).tobytes()


def depth_of(image: Any) -> bytes:
    """Convert a `sensor_msgs/Image` to (height, width) little-endian floats [m], 0 for no measurement.

    Raises BadRequest for other encodings.
    """
    if image.encoding not in _DEPTHS:
        raise errors.BadRequest(
            f"unsupported depth encoding {image.encoding!r}; supported: {', '.join(_DEPTHS)}"
        )
    kind, metres = _DEPTHS[image.encoding]
    order = ">" if image.is_bigendian else "<"
    depth_m = np.nan_to_num(_rows(image, order + kind, 1), nan=0.0, posinf=0.0, neginf=0.0) * metres
    return bytes(depth_m.astype("<f4").tobytes())


def _rows(image: Any, kind: str, channels: int) -> NDArray[Any]:
    """Return (height, width * channels) without the padding of the rows."""
    wide = image.width * channels * np.dtype(kind).itemsize
    content = np.asarray(image.data, np.uint8)
    if not wide or not image.height or image.step < wide or content.size < image.step * image.height:
        raise errors.BadRequest(
            f"{content.size} bytes are not an image of {image.width} x {image.height} pixels in"
            f" {image.encoding!r} with rows of {image.step} bytes"
        )
    rows = content[: image.step * image.height].reshape(image.height, image.step)[:, :wide]
    return np.ascontiguousarray(rows).view(kind)
