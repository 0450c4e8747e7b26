"""Depth images in files: PNG, TIFF and PGM of 16 bits or more, and arrays of NumPy."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import Floats
from semmap.nodes.perception_node.input.files import units
from semmap.nodes.perception_node.input.files.array_files import open_array
from semmap.nodes.runtime.pictures import MAX_PIXELS, open_picture
from semmap.schemas.wording import few

ARRAYS = (".npy", ".npz")
OPENEXR = ".exr"
_MODES = ("I;16", "I;16B", "I;16L", "I", "F")
_MM_M = 0.001
_PGM = re.compile(rb"P([25])" + rb"\s+(?:#[^\n]*\n\s*)*(\d+)" * 3 + rb"\s")


def is_depth(path: Path) -> bool:
    """Return whether an image is of depth: 16 bits or more in one channel. Raises ValueError, OSError."""
    if path.suffix.lower() in (*ARRAYS, OPENEXR):
        return True
    with open_picture(path) as image:
        return image.mode in _MODES


def read_depth(path: Path) -> NDArray[Any]:
    """Return the numbers (H, W) of a depth image. Raises ValueError and OSError."""
    numbers: NDArray[Any]
    match path.suffix.lower():
        case ".npy":
            numbers = open_array(path)
        case ".npz":
            numbers = _of_archive(path)
        case ".exr":
            raise ValueError(
                "OpenEXR is not supported; convert it to a TIFF or .npy file of floats in metres"
            )
        case _:
            numbers = _of_image(path)
    if numbers.ndim == 3 and 1 in (numbers.shape[0], numbers.shape[-1]):
        numbers = numbers.reshape([n for n in numbers.shape if n != 1] if numbers.size > 1 else (1, 1))
    if numbers.ndim != 2 or numbers.dtype.kind not in "iuf" or numbers.dtype.itemsize < 2:
        raise ValueError(
            f"{' x '.join(map(str, numbers.shape))} of {numbers.dtype} is not a depth image; it must be an"
            " array (height, width) of floats or of integers of 16 bits or more"
        )
    if not 0 < numbers.size <= MAX_PIXELS:
        raise ValueError(f"the depth image has {numbers.size:,} pixels; the maximum is {MAX_PIXELS:,}")
    return np.asarray(numbers)


def to_metres(numbers: NDArray[Any], depth_scale: float | None, camera: str) -> Floats:
    """Return depth (H, W) [m]. Raises ValueError for values that seem to be in another unit.

    `depth_scale`: metres per unit, if stated in the file `camera`; else integers are millimetres and floats
    metres.
    """
    scale_m = depth_scale or (1.0 if numbers.dtype.kind == "f" else _MM_M)
    if not np.any(numbers > 0):
        raise ValueError("it has no depth: no value is above 0")
    if (doubt := units.doubt(numbers, scale_m, stated=depth_scale is not None)) is not None:
        raise ValueError(f'{doubt}; set "depth_scale": {doubt.scale_m:g} in {camera}')
    return np.asarray(numbers.astype(np.float32) * np.float32(scale_m))


def _of_image(path: Path) -> NDArray[Any]:
    if path.suffix.lower() == ".pgm":
        return _of_pgm(path.read_bytes())
    with open_picture(path) as image:
        if image.mode not in _MODES:
            raise ValueError("it must have 16 bits or more in a single channel, 0 for no measurement")
        return np.asarray(image)


def _of_pgm(data: bytes) -> NDArray[Any]:
    """Return the numbers as they are; Pillow would scale them to 16 bits."""
    head = _PGM.match(data)
    if head is None:
        raise ValueError("not a PGM image")
    width, height, most = (int(number) for number in head.groups()[1:])
    if most < 256:
        raise ValueError("it must have 16 bits or more in a single channel, 0 for no measurement")
    count, body = width * height, data[head.end() :]
    if count > MAX_PIXELS:
        raise ValueError(f"the depth image has {count:,} pixels; the maximum is {MAX_PIXELS:,}")
    if head[1] == b"2":
        numbers = np.array(body.split()[:count], np.float64).astype(np.int64)
    else:
        numbers = np.frombuffer(body[: 2 * count], ">u2" if len(body) >= 2 * count else "u1").astype(np.int64)
    if len(numbers) != count:
        raise ValueError("truncated")
    return numbers.reshape(height, width)


def _of_archive(path: Path) -> NDArray[Any]:
    """Return the only array of an .npz file, or the one named depth."""
    try:
        with zipfile.ZipFile(path) as archive:
            names = [name.removesuffix(".npy") for name in archive.namelist()]
            name = names[0] if len(names) == 1 else "depth"
            if name not in names:
                raise ValueError(f"it has the arrays {few(names)}; name the depth image depth")
            if archive.getinfo(f"{name}.npy").file_size > 8 * MAX_PIXELS + 4096:
                raise ValueError(f"the array {name} has more than {MAX_PIXELS:,} pixels")
            with archive.open(f"{name}.npy") as file:
                return np.asarray(np.lib.format.read_array(file, allow_pickle=False))
    except (zipfile.BadZipFile, KeyError, EOFError):
        raise ValueError("not an .npz archive of arrays, or a truncated one") from None
