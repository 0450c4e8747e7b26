"""Selects what a model detected: by score, and one box for each thing. Pure."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.detection.decoding import Candidates, Indices
from semmap.nodes.perception_node.detection.model_input import Floats

_SAME_CLASS, _ANY_CLASS = 0.5, 0.8
"""Boxes that overlap by more are of the same thing: of the same class, and of any classes."""
_MOST = 200
"""Number of things that are kept of one image."""
_MOST_COMPARED = 3000


def select(found: Candidates, least_score: float) -> Indices:
    """Return the rows of the things in an image, by descending score."""
    corners = found.corners
    usable = np.isfinite(corners).all(axis=1) & (corners[:, 2:] > corners[:, :2]).all(axis=1)
    rows = np.flatnonzero(usable & (found.scores >= least_score))
    rows = rows[np.argsort(-found.scores[rows], kind="stable")][:_MOST_COMPARED]
    kept: list[int] = []
    while len(rows) and len(kept) < _MOST:
        best, rows = int(rows[0]), rows[1:]
        kept.append(best)
        overlap = overlaps(corners[best], corners[rows])
        limit = np.where(found.kinds[rows] == found.kinds[best], _SAME_CLASS, _ANY_CLASS)
        rows = rows[overlap <= limit]
    return np.array(kept, np.int64)


def overlaps(box: Floats, others: Floats) -> NDArray[np.floating]:
    """Return (N,) the intersection of a box (4,) with others (N, 4), as a share of their union."""
    low, high = np.maximum(box[:2], others[:, :2]), np.minimum(box[2:], others[:, 2:])
    common = np.prod(np.maximum(high - low, 0.0), axis=1)
    union = np.prod(box[2:] - box[:2]) + np.prod(others[:, 2:] - others[:, :2], axis=1) - common
    return np.asarray(common / np.maximum(union, 1e-9))
