"""Occupancy grids in the format of the ROS map server: a YAML file and an image, PNG or PGM.

The first row of the image has the greatest y. Dark is occupied, light is free, other values are unknown.
"""

from __future__ import annotations

import math
import re
import struct
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.navigation.grid import (
    FREE,
    MOST_CELLS,
    OCCUPIED,
    UNKNOWN,
    Cells,
    Frame,
    Mask,
    OccupancyGrid,
)
from semmap.schemas import errors

Pixels = NDArray[np.uint8]

_WHITE, _GREY, _BLACK = 254, 205, 0
_OCCUPIED_FROM, _FREE_TO = 0.65, 0.196
"""With these thresholds grey is unknown: (255 - 205) / 255 is just above the second."""
_COARSEST_M: Final = 10.0
_GAP = rb"((?:\s+|#[^\n]*\n)+)"
_PGM_HEAD = re.compile(rb"P([25])" + _GAP + rb"(\d+)" + _GAP + rb"(\d+)" + _GAP + rb"(\d+)\s")


@dataclass(frozen=True)
class MapDescription:
    """The content of the YAML file: `origin` is the pose of the image's lower left corner [m, m, rad]."""

    image: str
    resolution: float
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    negate: bool = False
    occupied_thresh: float = _OCCUPIED_FROM
    free_thresh: float = _FREE_TO
    mode: str = "trinary"


def yaml_of(image: str, frame: Frame) -> str:
    """Return the YAML file for an image of this grid."""
    return (
        f"image: {image}\nmode: trinary\nresolution: {frame.resolution:g}\n"
        f"origin: [{frame.x:g}, {frame.y:g}, 0]\nnegate: 0\n"
        f"occupied_thresh: {_OCCUPIED_FROM}\nfree_thresh: {_FREE_TO}\n"
    )


def pixels_of(grid: OccupancyGrid) -> Pixels:
    """Return the image of a grid."""
    pixels = np.full(grid.cells.shape, _GREY, dtype=np.uint8)
    pixels[grid.cells == FREE] = _WHITE
    pixels[grid.cells == OCCUPIED] = _BLACK
    return pixels[::-1]


def mask_pixels(mask: Mask) -> Pixels:
    """Return the image of a mask, which is black."""
    return np.where(mask, _BLACK, _WHITE).astype(np.uint8)[::-1]


def png(pixels: Pixels) -> bytes:
    """Encode grey pixels (height, width) as PNG."""
    height, width = pixels.shape
    rows = np.zeros((height, width + 1), dtype=np.uint8)  # each begins with its filter: none
    rows[:, 1:] = pixels

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    body = zlib.compress(rows.tobytes(), 6)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", body) + chunk(b"IEND", b"")


def read_yaml(text: str, name: str) -> MapDescription:
    """Parse a map server's YAML file. Raises BadFile."""
    entries = dict(_entries(text, name))
    if "image" not in entries or "resolution" not in entries:
        raise errors.BadFile(
            f"{name} is not a map description; it requires image: FILE and resolution: METRES"
        )
    resolution = _number(entries, "resolution", name)
    if not 0.0 < resolution <= _COARSEST_M:
        raise errors.BadFile(
            f"{name}: invalid resolution {resolution:g}; it must be metres per pixel, above 0 and"
            f" up to {_COARSEST_M:g}"
        )
    origin = _origin(entries.get("origin", "[0, 0, 0]"), name)
    mode = entries.get("mode", "trinary").lower()
    if mode not in ("trinary", "scale", "raw"):
        raise errors.BadFile(f"{name}: invalid mode '{mode}'; use trinary, scale or raw")
    thresholds = {}
    for key, usual in (("occupied_thresh", _OCCUPIED_FROM), ("free_thresh", _FREE_TO)):
        thresholds[key] = _number(entries, key, name) if key in entries else usual
    if not 0.0 <= thresholds["free_thresh"] < thresholds["occupied_thresh"] <= 1.0:
        raise errors.BadFile(f"{name}: free_thresh must be below occupied_thresh, both from 0 to 1")
    return MapDescription(
        image=entries["image"],
        resolution=resolution,
        origin=origin,
        negate=entries.get("negate", "0").lower() in ("1", "true", "yes"),
        mode=mode,
        **thresholds,
    )


def _entries(text: str, name: str) -> Mapping[str, str]:
    """Parse the top-level `key: value` lines; a list may have one item per line."""
    found: dict[str, str] = {}
    key = ""
    for line in text.splitlines():
        bare = re.sub(r"(^|\s)#.*$", "", line).rstrip()
        if not bare or bare in ("---", "..."):
            continue
        item = re.fullmatch(r"\s*-\s*(\S+)", bare)
        if item is not None and key:
            found[key] = f"{found[key].rstrip(']').lstrip('[')}{', ' if found[key] else ''}{item[1]}"
            continue
        pair = re.fullmatch(r"([A-Za-z_]\w*)\s*:\s*(.*)", bare)
        if pair is None:
            raise errors.BadFile(f"{name} is not a map description: invalid line '{bare[:60]}'")
        key = pair[1]
        found[key] = pair[2].strip().strip("'\"")
    return found


def _number(entries: Mapping[str, str], key: str, name: str) -> float:
    try:
        value = float(entries[key])
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise errors.BadFile(f"{name}: {key} '{entries[key]}' is not a number")
    return value


def _origin(text: str, name: str) -> tuple[float, float, float]:
    try:
        x, y, *rest = (float(word) for word in text.strip("[] ").split(","))
        yaw = rest[0] if rest else 0.0
        if len(rest) > 1 or not all(map(math.isfinite, (x, y, yaw))):
            raise ValueError
    except ValueError:
        raise errors.BadFile(f"{name}: invalid origin '{text}'; it must be [x, y, yaw]") from None
    return x, y, yaw


def read_image(content: bytes, name: str, decode: Callable[[bytes], Pixels]) -> Pixels:
    """Return the grey pixels (height, width) of a PGM file, or of a PNG file that `decode` reads.

    Raises BadFile.
    """
    if content[:2] in (b"P2", b"P5"):
        return _pgm(content, name)
    if content[:8] == b"\x89PNG\r\n\x1a\n":
        return decode(content)
    raise errors.BadFile(f"{name} is not a PNG or PGM image")


def _pgm(content: bytes, name: str) -> Pixels:
    head = _PGM_HEAD.match(content)
    if head is None:
        raise errors.BadFile(f"{name} is not a PGM file: invalid header")
    width, height, most = int(head[3]), int(head[5]), int(head[7])
    if not (width > 0 and height > 0 and width * height <= MOST_CELLS and 0 < most < 65536):
        raise errors.BadFile(f"{name} is {width} x {height}; a map has at most {MOST_CELLS:,} pixels")
    body = content[head.end() :]
    try:
        if head[1] == b"2":
            values = np.array(body.split()[: width * height], dtype=np.float64)
        else:
            kind = np.dtype(">u2") if most > 255 else np.dtype(np.uint8)
            values = np.frombuffer(body, kind, count=width * height).astype(np.float64)
        return (values.reshape(height, width) * (255.0 / most)).round().clip(0, 255).astype(np.uint8)
    except ValueError:
        raise errors.BadFile(f"{name} is truncated: it has fewer than {width} x {height} pixels") from None


def has_unknown_grey(described: MapDescription, pixels: Pixels) -> bool:
    """Return whether grey is unknown in an image, although `free_thresh` makes it free.

    A trinary image with the three values 0, 205 and 254 was written by ROS's map_saver, for which 205 is
    unknown, also with its default threshold of 0.25.
    """
    is_free = described.free_thresh > 1.0 - _GREY / 255.0
    if described.mode != "trinary" or described.negate or not is_free:
        return False
    return {*np.unique(pixels).tolist()} == {_BLACK, _GREY, _WHITE}


def grid_of(described: MapDescription, pixels: Pixels) -> OccupancyGrid:
    """Return the grid of an image in its own frame: not rotated, lower left corner at (0, 0)."""
    shade = pixels.astype(np.float64) / 255.0
    occupied = shade if described.negate else 1.0 - shade
    if described.mode == "raw":
        occupied = pixels.astype(np.float64) / 100.0
        occupied[pixels > 100] = math.nan
    cells: Cells = np.full(pixels.shape, UNKNOWN, dtype=np.int8)
    with np.errstate(invalid="ignore"):
        cells[occupied < described.free_thresh] = FREE
        cells[occupied > described.occupied_thresh] = OCCUPIED
    if has_unknown_grey(described, pixels):
        cells[pixels == _GREY] = UNKNOWN
    height, width = pixels.shape
    return OccupancyGrid(Frame(0.0, 0.0, described.resolution, width, height), cells[::-1].copy())


def pgm(pixels: Pixels) -> bytes:
    """Encode grey pixels (height, width) as PGM."""
    height, width = pixels.shape
    return b"P5\n%d %d\n255\n" % (width, height) + pixels.tobytes()
