"""Masks in XML of CVAT ("CVAT for images"): polygons, boxes, and run lengths inside a box. Pure."""

from __future__ import annotations

import math
from xml.etree import ElementTree

import numpy as np

from semmap.nodes.perception_node.input.files.mask_polygons import counts_in, counts_of
from semmap.schemas.perception import MaskRun

_MOST_BYTES = 100_000_000
_SHAPES = ("polygon", "box", "mask")


def cvat_runs(data: bytes, height: int, width: int) -> list[MaskRun]:
    """Return the masks of the single image in a file, with their labels. Raises ValueError."""
    if len(data) > _MOST_BYTES:
        raise ValueError(f"it has more than {_MOST_BYTES:,} bytes")
    try:
        root = ElementTree.fromstring(data)
    except ElementTree.ParseError as error:
        raise ValueError(f"not XML: {error}") from None
    images = [image for image in root.iter("image") if any(shape.tag in _SHAPES for shape in image)]
    if next(root.iter("track"), None) is not None:
        raise ValueError("it has the tracks of a video; export it as 'CVAT for images'")
    if len(images) > 1:
        raise ValueError(f"it has masks of {len(images)} images; use one file per image")
    found = []
    for image in images:
        size = (image.get("width"), image.get("height"))
        if size != (str(width), str(height)):
            raise ValueError(
                f"its masks are for an image of {size[0]} x {size[1]} pixels, not {width} x {height}"
            )
        found += [_run(shape, height, width) for shape in image if shape.tag in _SHAPES]
    return found


def _run(shape: ElementTree.Element, height: int, width: int) -> MaskRun:
    try:
        match shape.tag:
            case "polygon":
                corners = [float(n) for point in shape.get("points", "").split(";") for n in point.split(",")]
                counts = counts_of([corners], height, width)
            case "box":
                counts = counts_of([_corners_of_box(shape)], height, width)
            case _:
                counts = _counts_in_box(shape, height, width)
    except ValueError as error:
        raise ValueError(f"a {shape.tag} of '{shape.get('label', '')}' is invalid: {error}") from None
    return MaskRun(size=(height, width), counts=tuple(counts), label=shape.get("label", ""), score=1.0)


def _corners_of_box(shape: ElementTree.Element) -> list[float]:
    """Return x and y of the corners of a box, which may be turned around its middle (degrees, clockwise)."""
    left, top, right, bottom = (float(shape.get(side, "")) for side in ("xtl", "ytl", "xbr", "ybr"))
    turn = math.radians(float(shape.get("rotation", "0")))
    (x, y), (a, b) = ((left + right) / 2, (top + bottom) / 2), ((right - left) / 2, (bottom - top) / 2)
    around = [(dx * a, dy * b) for dx, dy in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    cos, sin = math.cos(turn), math.sin(turn)
    return [side for dx, dy in around for side in (x + dx * cos - dy * sin, y + dx * sin + dy * cos)]


def _counts_in_box(shape: ElementTree.Element, height: int, width: int) -> list[int]:
    """Return the column-wise run lengths of a mask that is given row by row inside its box."""
    left, top, across, down = (int(shape.get(name, "")) for name in ("left", "top", "width", "height"))
    runs = [int(run) for run in shape.get("rle", "").split(",")]
    inside = left >= 0 and top >= 0 and left + across <= width and top + down <= height
    if not inside or min(across, down) <= 0 or min(runs) < 0 or sum(runs) != across * down:
        raise ValueError("its runs do not fill its box, or the box leaves the image")
    mask = np.zeros((height, width), bool)
    own = np.repeat(np.arange(len(runs)) % 2 == 1, runs).reshape(down, across)
    mask[top : top + down, left : left + across] = own
    return counts_in(mask)
