"""Features of the classifiers: box, shape histogram, colours, outline and relief of a thing.

`inside` (N, 3) are the thing's cells in its box, each axis from 0 to 1, with x along the longer side.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.recognition.outlines import outlines
from semmap.nodes.perception_node.recognition.relief import reliefs
from semmap.nodes.perception_node.views.boxes import Numbers, in_frame
from semmap.nodes.perception_node.views.merged_thing import Thing

SORTS = ("geometry", "shape", "colour", "outline", "relief")
"""The sorts of features, in the order of `features_of`."""

_SLICES = 8
_RINGS = 5
_PAIRS = 400
_PAIR_BINS = 10
_PICKS = np.random.default_rng(0).random((2, _PAIRS))
_HUES = 12
_GREYS = 4
_BANDS = 4
MEAN_COLOUR = slice(_HUES + _GREYS, _HUES + _GREYS + 3)
"""The columns of `colour` with the mean red, green and blue."""
_TRIMMED = np.array([0.01, 0.03, 0.08, 0.2])
_LEAST_M = 1e-3


def features_of(things: Sequence[Thing]) -> list[Numbers]:
    """Return for each of `SORTS` the features of all things: (N, features of this sort)."""
    inside = [_normalised(thing) for thing in things]
    one_by_one = [
        np.array([look(thing, where) for thing, where in zip(things, inside, strict=True)])
        for look in (geometry, shape, colour)
    ]
    return [*one_by_one, outlines(things, inside), reliefs(things, inside)]


def geometry(thing: Thing, inside: Numbers) -> Numbers:
    """Return features (G,) of the visible oriented box, its view, and how points fill it."""
    x, y, z = thing.box.size_m
    long, short = max(x, y), min(x, y)
    to_eye = in_frame(thing.eyes, thing.box.yaw_rad) - (thing.box.low + thing.box.high) / 2
    distance = np.linalg.norm(to_eye, axis=1)
    footprint = np.zeros((8, 8), bool)
    footprint[tuple((inside[:, :2] * 7.999).astype(int).T)] = True
    return np.array(
        [
            *np.log([long, short, z]),
            np.log(long / short),
            np.log(z / long),
            np.log(long * short * z) / 3.0,
            thing.lifted_m / z,
            float(footprint.mean()),
            float(np.mean(inside[:, 2] > 0.9)),
            float(np.mean(inside[:, 2] < 0.3)),
            *inside.std(axis=0),
            float(np.mean(np.abs(inside[:, :2] - 0.5).max(axis=1) > 0.4)),
            len(thing.eyes) - 1.0,
            float(distance.min()),
            float((to_eye[:, 2] / distance).max()),
            float(not thing.whole),
            np.log(thing.count),
            *_trimmed(inside, np.array([long, short, z])),
        ]
    )


def shape(thing: Thing, inside: Numbers) -> Numbers:
    """Return features (S,): width at each height, distribution around the axis, and pair distances."""
    long_short = np.sort(thing.box.size_m[:2])[::-1]
    offset = (inside[:, :2] - 0.5) * long_short / np.sqrt(long_short.prod())
    radius = np.hypot(*offset.T)
    level = np.minimum((inside[:, 2] * _SLICES).astype(int), _SLICES - 1)
    count = np.bincount(level, minlength=_SLICES)
    profile = [np.bincount(level, value, _SLICES) / np.maximum(count, 1) for value in (radius, radius**2)]
    spans = _spans(offset, level)
    ring = np.minimum((radius / 0.75 * _RINGS).astype(int), _RINGS - 1)
    rings = np.bincount(ring, minlength=_RINGS) / len(inside)
    tops = np.array([_high(inside[ring == r, 2]) for r in range(_RINGS)])
    return np.concatenate(
        [count / len(inside), *profile, spans.ravel(), rings, tops, _pair_distances(thing.cells)]
    )


def colour(thing: Thing, inside: Numbers) -> Numbers:
    """Return features (C,): shares of hues and greys, and the mean colours of bands from bottom to top.

    Returns zeros if the cameras have no colours.
    """
    size = _HUES + _GREYS + 6 + 3 * _BANDS
    if thing.colors is None:
        return np.zeros(size)
    red, green, blue = thing.colors.T
    high, low = thing.colors.max(axis=1), thing.colors.min(axis=1)
    chroma = high - low
    with np.errstate(divide="ignore", invalid="ignore"):
        hue = np.arctan2(np.sqrt(3.0) * (green - blue), 2.0 * red - green - blue) / (2.0 * np.pi) % 1.0
        saturation = np.where(high > 0.0, chroma / high, 0.0)
    vivid = np.clip(3.0 * saturation - 0.3, 0.0, 1.0)
    hues = np.bincount((hue * _HUES).astype(int) % _HUES, vivid, _HUES) / len(hue)
    greys = np.bincount(np.minimum((high * _GREYS).astype(int), _GREYS - 1), 1.0 - vivid, _GREYS) / len(hue)
    band = np.minimum((inside[:, 2] * _BANDS).astype(int), _BANDS - 1)
    count = np.maximum(np.bincount(band, minlength=_BANDS), 1)
    bands = [np.bincount(band, channel, _BANDS) / count for channel in (red, green, blue)]
    return np.concatenate(
        [hues, greys, thing.colors.mean(axis=0), thing.colors.std(axis=0), np.concatenate(bands)]
    )


def _normalised(thing: Thing) -> Numbers:
    """Return the cells (N, 3) in the box, each axis from 0 to 1; x is the longer side."""
    turned = in_frame(thing.cells, thing.box.yaw_rad)
    inside = np.clip((turned - thing.box.low) / thing.box.size_m, 0.0, 1.0)
    return inside if thing.box.size_m[0] >= thing.box.size_m[1] else inside[:, [1, 0, 2]]


def _trimmed(inside: Numbers, size_m: Numbers) -> Numbers:
    """Return (16,) the logarithms of extents without outer quantiles, and the lower end that remains.

    Where things touch, a piece of the neighbour makes the box much larger.
    """
    low, high = np.split(_quantiles(inside, np.concatenate([_TRIMMED, 1.0 - _TRIMMED])), 2)
    extents = np.column_stack([high[:, :2] - low[:, :2], high[:, 2]]) * size_m
    return np.concatenate([np.log(np.maximum(extents, _LEAST_M)).ravel(), low[:, 2]])


def _quantiles(values: Numbers, shares: Numbers) -> Numbers:
    """Return quantiles (S, D) of each column of values (N, D). NumPy's function takes ten times as long."""
    ordered = np.sort(values.T, axis=1)
    at = shares * (len(values) - 1)
    below = at.astype(int)
    above = np.minimum(below + 1, len(values) - 1)
    return np.asarray((ordered[:, below] * (1.0 - (at - below)) + ordered[:, above] * (at - below)).T)


def _spans(offset: Numbers, level: NDArray[np.int64]) -> Numbers:
    """Return the extents (_SLICES, 2) of each slice along the box's axes."""
    count = np.bincount(level, minlength=_SLICES)
    first, filled = np.cumsum(count) - count, count > 0
    by_level = np.ascontiguousarray(offset[np.argsort(level.astype(np.uint8), kind="stable")].T)
    spans = np.zeros((_SLICES, 2))
    low, high = (end.reduceat(by_level, first[filled], axis=1) for end in (np.minimum, np.maximum))
    spans[filled] = (high - low).T
    return spans


def _high(heights: Numbers) -> float:
    return float(heights.max()) if len(heights) else 0.0


def _pair_distances(cells: Numbers) -> Numbers:
    """Return a histogram (_PAIR_BINS,) of distances between pairs of points, as shares of the largest."""
    a, b = (_PICKS * len(cells)).astype(int)
    distances = np.linalg.norm(cells[a] - cells[b], axis=1)
    bins = np.minimum((distances / (distances.max() + 1e-9) * _PAIR_BINS).astype(int), _PAIR_BINS - 1)
    return np.asarray(np.bincount(bins, minlength=_PAIR_BINS) / _PAIRS)
