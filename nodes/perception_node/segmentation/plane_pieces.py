"""Pieces of a level plane: table tops and seats of one height are no single surface."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from semmap.nodes.perception_node.segmentation.working_image import Floats, Mask

_AROUND = np.ones((3, 3))
_STEEP = 0.5
"""A slice through upright things is this steep from row to row: sine of the angle."""


def pieces_of(on: Mask, points: Floats, height: Floats, thickness: Floats, least: float) -> list[Mask]:
    """The pieces, each (h, w), of a plane that have `least` cells or more, the largest first.

    `on`: (h, w) which of `points` (3, h, w) lie on it. `height`: how far each is on the camera's side of it,
    `thickness`: what it may be off it [m]. Pieces are parted by what one sees past the plane; behind what
    stands before it, it may go on. What it merely cuts through is no piece of it.
    """
    hidden = height > thickness  # NaN is not
    numbers = np.where(on, ndimage.label(on | hidden, _AROUND)[0], 0)
    counts = np.bincount(numbers.ravel())
    counts[0] = 0
    large = [n for n in np.argsort(-counts, kind="stable") if counts[n] >= least]
    pieces = (np.asarray(numbers == n) for n in large)
    return [piece for piece in pieces if not _is_slice(piece, points, height)]


def _is_slice(piece: Mask, points: Floats, height: Floats) -> bool:
    """Whether a plane merely cuts through this: from row to row its points rather rise than recede."""
    both = piece[1:] & piece[:-1]
    if not both.any():
        return True
    step = np.linalg.norm(np.diff(points, axis=1)[:, both], axis=0)
    return bool(np.median(np.abs(np.diff(height, axis=0)[both]) / np.maximum(step, 1e-6)) > _STEEP)
