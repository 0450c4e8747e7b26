"""Cuts the images of things out of colour images, as the input of the network."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from semmap.nodes.perception_node.image_features.efficientnet import SIDE

Bytes = NDArray[np.uint8]
LabelledImage = tuple[Bytes, NDArray[np.int32]]
"""The colours (H, W, 3) of a view, and the number of the thing that each pixel (H, W) shows, 0 for none."""

_MARGIN = 0.15
"""Room on each side, as a share of the longer side."""
_GREY = 127


def crops_of(views: Sequence[LabelledImage], number: int) -> tuple[Bytes, Bytes] | None:
    """Return a thing's image (SIDE, SIDE, 3), and the same with its surroundings in grey.

    It is cut out of the view that shows most of the thing. Returns None if no view shows it.
    """
    owns = [labels == number for _, labels in views]
    best = max(range(len(owns)), key=lambda view: np.count_nonzero(owns[view]), default=None)
    if best is None or not owns[best].any():
        return None
    colours, own = views[best][0], owns[best]
    square = _square_around(own)
    return _cut(colours, square), _cut(np.where(own[..., None], colours, np.uint8(_GREY)), square)


def _square_around(own: NDArray[np.bool_]) -> tuple[int, int, int, int]:
    """Return the first row and column of a square around pixels, and those after the last."""
    rows, columns = (np.flatnonzero(own.any(axis=axis)) for axis in (1, 0))
    ends = (int(rows[0]), int(rows[-1]) + 1), (int(columns[0]), int(columns[-1]) + 1)
    half = (0.5 + _MARGIN) * max(last - first for first, last in ends)
    (top, bottom), (left, right) = ends
    row, column = (top + bottom) / 2, (left + right) / 2
    return round(row - half), round(column - half), round(row + half), round(column + half)


def _cut(colours: Bytes, square: tuple[int, int, int, int]) -> Bytes:
    """Return the square at the size of the network's input; pixels outside of the image are grey."""
    top, left, bottom, right = square
    cut = np.full((bottom - top, right - left, 3), _GREY, np.uint8)
    height, width = colours.shape[:2]
    first_row, last_row = max(0, top), min(height, bottom)
    first_column, last_column = max(0, left), min(width, right)
    cut[first_row - top : last_row - top, first_column - left : last_column - left] = colours[
        first_row:last_row, first_column:last_column
    ]
    return np.asarray(Image.fromarray(cut).resize((SIDE, SIDE), Image.Resampling.BILINEAR))
