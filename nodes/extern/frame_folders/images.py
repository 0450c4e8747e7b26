"""Images of recorded topics, compressed or not."""

from __future__ import annotations

import re
import struct
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from semmap.nodes.extern.ros import images
from semmap.nodes.runtime.pictures import open_picture
from semmap.schemas.errors import BadRequest

_HEADER: Final = struct.Struct("<Iff")
"""The header before the PNG of a `compressedDepth`: a format, and the quantization parameters."""
_PNG: Final = b"\x89PNG"
_DEPTH: Final = re.compile(r"compressedDepth|16UC1|32FC1|mono16")


def encoding_of(message: Any) -> str:
    """Return the encoding of a `sensor_msgs/Image` or `CompressedImage`."""
    return str(message.format if hasattr(message, "format") else message.encoding)


def is_depth(encoding: str) -> bool:
    """Return whether an encoding is of depth images."""
    return bool(_DEPTH.search(encoding))


def is_colour(encoding: str) -> bool:
    """Return whether an encoding is of colour or grey images."""
    return not is_depth(encoding) and (encoding in images.COLOURS or bool(re.search("jpe?g|png", encoding)))


def colour_of(message: Any) -> NDArray[np.uint8]:
    """Return the pixels (H, W, 3) of a colour image. Raises BadRequest for other images."""
    if not hasattr(message, "format"):
        pixels = np.frombuffer(images.colour_of(message), np.uint8)
        return pixels.reshape(message.height, message.width, 3)
    with _opened(bytes(message.data), message.format) as image:
        return np.asarray(image.convert("RGB"))


def depth_of(message: Any, scale: float | None = None) -> NDArray[np.float32]:
    """Return the depth (H, W) [m] of an image, 0 for no measurement.

    `scale` is the unit [m], if integers are not millimetres or floats are not metres. Raises BadRequest for
    other images.
    """
    if not hasattr(message, "format"):
        pixels = np.frombuffer(images.depth_of(message), "<f4").reshape(message.height, message.width)
        if message.encoding == "32FC1":
            return pixels if scale is None else np.asarray(pixels * np.float32(scale), np.float32)
        return _apply_scale(pixels, scale)
    data = bytes(message.data)
    start = data.find(_PNG, 0, _HEADER.size + len(_PNG))
    if start < 0:
        raise BadRequest(f"unsupported depth image format {message.format!r}; supported: PNG")
    with _opened(data[start:], message.format) as image:
        if image.mode not in ("I;16", "I;16B", "I"):
            raise BadRequest(f"depth image {message.format!r} has pixels of type {image.mode}, not 16 bits")
        numbers = np.asarray(image).astype(np.float32)
    if "32FC1" not in message.format or start < _HEADER.size:
        return _apply_scale(numbers * np.float32(0.001), scale)
    _, a, b = _HEADER.unpack_from(data)
    with np.errstate(divide="ignore"):
        metres = np.where(numbers > 0, np.float32(a) / (numbers - np.float32(b)), 0.0)
    return np.where(np.isfinite(metres), metres, 0.0).astype(np.float32)


def _apply_scale(depth_m: NDArray[np.float32], scale: float | None) -> NDArray[np.float32]:
    return depth_m if scale is None else np.asarray(depth_m * np.float32(scale * 1000.0), np.float32)


def _opened(data: bytes, format_: str) -> Image.Image:
    try:
        return open_picture(data)
    except ValueError as error:
        raise BadRequest(f"invalid image in format {format_!r} of {len(data)} bytes: {error}") from None
