"""The pixels of things of which a detector only has boxes: those of our segments that fill a box."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.masks import Box, Masks

FEWEST_POINTS = 20
"""A mask with fewer points on one surface is not used."""

_WITHIN, _PARTLY = 0.8, 0.25
"""A segment with the first share of its pixels in a box belongs to it; from the second on, those inside do:
the segment may be of two things that touch. A table below a thing has less of its pixels there."""
_FITS = 0.35
"""Minimum overlap of a box with the one around the segments in it, as a share of their union."""
_GAIN = 0.1
"""Minimum gain of that overlap by another segment of the same thing."""


def segments_in_boxes(labels: NDArray[np.int32], masks: Masks) -> NDArray[np.int32]:
    """Return (H, W) the number of the box whose thing a pixel shows, 0 for none.

    `labels` (H, W) are our segments. A box without a segment that fits has no pixels: a thing that is flat,
    or that the camera measures no depth of. The box with the better score comes first.
    """
    free, found = labels.copy(), np.zeros_like(labels)
    sizes = np.bincount(labels.ravel())
    score = [0.0 if label is None else label.score for label in masks.detector_labels]
    for n in sorted(range(len(masks.boxes)), key=lambda n: -score[n]):
        own = _pixels(free, sizes, masks.boxes[n])
        found[own] = n + 1
        free[own] = 0
    return found


def _pixels(free: NDArray[np.int32], sizes: NDArray[np.int64], box: Box) -> NDArray[np.bool_]:
    """Return the pixels of the segment that fits a box best, and of others that complete it."""
    inside = np.zeros(free.shape, bool)
    inside[box[1] : box[3], box[0] : box[2]] = True
    counts = np.bincount(free[inside], minlength=len(sizes))
    near = np.flatnonzero((counts >= FEWEST_POINTS) & (counts >= _PARTLY * sizes))
    parts = {int(n): (free == n) & (inside | bool(counts[n] >= _WITHIN * sizes[n])) for n in near if n}
    around = {n: _box_around(part) for n, part in parts.items()}
    own, best = np.zeros(free.shape, bool), 0.0
    whole: Box | None = None
    while parts:
        trial = {n: _joined(whole, around[n]) for n in parts}
        n = max(trial, key=lambda n: _overlap(trial[n], box))
        if _overlap(trial[n], box) < best + _GAIN:
            break
        whole, best = trial[n], _overlap(trial[n], box)
        own |= parts.pop(n)
    return own & (best >= _FITS)


def _box_around(pixels: NDArray[np.bool_]) -> Box:
    rows, columns = (np.flatnonzero(pixels.any(axis=axis)) for axis in (1, 0))
    return int(columns[0]), int(rows[0]), int(columns[-1]) + 1, int(rows[-1]) + 1


def _joined(one: Box | None, other: Box) -> Box:
    if one is None:
        return other
    return min(one[0], other[0]), min(one[1], other[1]), max(one[2], other[2]), max(one[3], other[3])


def _overlap(one: Box, other: Box) -> float:
    """Return the intersection of two boxes as a share of their union."""
    across = max(0, min(one[2], other[2]) - max(one[0], other[0]))
    down = max(0, min(one[3], other[3]) - max(one[1], other[1]))
    areas = ((box[2] - box[0]) * (box[3] - box[1]) for box in (one, other))
    return across * down / max(1, sum(areas) - across * down)
