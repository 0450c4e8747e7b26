"""Pieces of a level plane: table tops and seats of one height are separate surfaces."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from semmap.nodes.perception_node.segmentation.working_image import Floats, Mask

_AROUND = np.ones((3, 3))
_STEEP = 0.5
"""Minimum slope (sine) of a slice through upright things, from row to row."""


def pieces_of(on: Mask, points: Floats, height: Floats, thickness: Floats, least: float) -> list[Mask]:
    """Return the pieces (h, w) of a plane with at least `least` cells, the largest first.

    `on`: (h, w) which of `points` (3, h, w) lie on it. `height`: their distance on the camera's side,
    `thickness`: the tolerance [m]. Pieces are separated where the camera looks past the plane; behind an
    occluder it may continue. Slices through things are excluded.
    """
    hidden = height > thickness  # NaN is not
    numbers = np.where(on, ndimage.label(on | hidden, _AROUND)[0], 0)
    counts = np.bincount(numbers.ravel())
    counts[0] = 0
    large = [n for n in np.argsort(-counts, kind="stable") if counts[n] >= least]
    pieces = (np.asarray(numbers == n) for n in large)
    return [piece for piece in pieces if not _is_slice(piece, points, height)]


def _is_slice(piece: Mask, points: Floats, height: Floats) -> bool:
    """Return whether the plane cuts through a thing: from row to row its points rise more than recede."""
    both = piece[1:] & piece[:-1]
    if not both.any():
        return True
    step = np.linalg.norm(np.diff(points, axis=1)[:, both], axis=0)
    return bool(np.median(np.abs(np.diff(height, axis=0)[both]) / np.maximum(step, 1e-6)) > _STEEP)
