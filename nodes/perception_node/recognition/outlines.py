"""Outline features: the width at each height, height and width along the length, and roundness.

The width of a slice across the line of sight does not depend on its hidden back: a bottle's shoulders and a
cup's straight sides are visible from everywhere. All things are computed together.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.nodes.perception_node.views.merged_thing import Thing

_LEVELS, _LENGTHS, _BANDS = 20, 10, 4
WIDTH = _LEVELS + 2 * _LENGTHS + 3 * _BANDS
"""The number of outline features."""

_LEAST, _LEAST_M = 1e-9, 1e-3
_RIDGE = 1e-6
_FEWEST = 6
"""Minimum number of cells for a circle fit."""
_MOST_OFF, _MOST_WIDE = 1.0, 3.0


def outlines(things: Sequence[Thing], inside: Sequence[Numbers]) -> Numbers:
    """Return (N, WIDTH) features of N things; `inside` are the cells in each box, see `features`."""
    owner = np.repeat(np.arange(len(things)), [len(where) for where in inside])
    x, y, z = np.concatenate(inside).T
    middle = np.array([thing.box.bottom_m[:2] for thing in things])
    from_middle = np.concatenate([thing.cells[:, :2] for thing in things]) - middle[owner]
    across = _across(things, middle, owner, from_middle, z)
    widest = np.maximum(across.max(axis=1, keepdims=True), _LEAST_M)
    round_ = _roundness(from_middle / widest[owner], _key(owner, z, _BANDS), len(things))
    return np.concatenate([across / widest, _along(owner, x, y, z, len(things)), round_], axis=1)


def _across(
    things: Sequence[Thing], middle: Numbers, owner: NDArray[np.int64], from_middle: Numbers, z: Numbers
) -> Numbers:
    """Return (N, _LEVELS) the width [m] of each thing by height, across the widest line of sight."""
    most = max(len(thing.eyes) for thing in things)
    eyes = np.array([thing.eyes[np.minimum(np.arange(most), len(thing.eyes) - 1), :2] for thing in things])
    sight = middle[:, None] - eyes
    sight /= np.maximum(np.linalg.norm(sight, axis=2, keepdims=True), _LEAST)
    beside = from_middle[:, :1] * -sight[owner, :, 1] + from_middle[:, 1:] * sight[owner, :, 0]
    extents = _extents(beside, _key(owner, z, _LEVELS), len(things) * _LEVELS)
    return np.asarray(extents.max(axis=1).reshape(len(things), _LEVELS))


def _along(owner: NDArray[np.int64], x: Numbers, y: Numbers, z: Numbers, count: int) -> Numbers:
    """Return (count, 2 _LENGTHS) heights, then widths, along the longer side; the bulkier end comes first."""
    key = _key(owner, x, _LENGTHS)
    both = np.stack([y, z], axis=1)
    wide, _ = _extents(both, key, count * _LENGTHS).reshape(count, _LENGTHS, 2).transpose(2, 0, 1)
    tops = np.zeros(count * _LENGTHS)
    np.maximum.at(tops, key, z)
    high = tops.reshape(count, _LENGTHS)
    bulk = high * wide
    half = _LENGTHS // 2
    turned = bulk[:, :half].sum(axis=1) < bulk[:, half:].sum(axis=1)
    high[turned], wide[turned] = high[turned, ::-1], wide[turned, ::-1]
    return np.concatenate([high, wide], axis=1)


def _roundness(places: Numbers, key: NDArray[np.int64], count: int) -> Numbers:
    """Return (count, 3 _BANDS) per band of cells (M, 2): residual of a circle, its size, and eccentricity.

    The circle is fitted as in Kasa (1976), by one linear system. Sizes are relative to the whole thing.
    """
    bands = count * _BANDS
    x, y = places.T
    far = x * x + y * y
    ones = np.bincount(key, minlength=bands).astype(float)

    def sums(values: Numbers) -> Numbers:
        return np.asarray(np.bincount(key, values, bands), np.float64)

    sx, sy, sxx, sxy, syy = sums(x), sums(y), sums(x * x), sums(x * y), sums(y * y)
    left = np.array([[sxx, sxy, sx], [sxy, syy, sy], [sx, sy, ones]]).transpose(2, 0, 1)
    right = np.array([sums(x * far), sums(y * far), sums(far)]).T
    ridge = _RIDGE * (1.0 + sxx + syy)[:, None, None] * np.eye(3)
    a, b, c = np.linalg.solve(left + ridge, right[..., None])[..., 0].T
    radius = np.sqrt(np.maximum(c + (a * a + b * b) / 4.0, _LEAST))
    off = np.hypot(x - a[key] / 2.0, y - b[key] / 2.0) / radius[key] - 1.0
    some = np.maximum(ones, 1.0)
    vague = np.sqrt(sums(off * off) / some)
    xx, yy, xy = sxx / some - (sx / some) ** 2, syy / some - (sy / some) ** 2, sxy / some - sx * sy / some**2
    apart = np.hypot(xx - yy, 2.0 * xy)
    thin = np.sqrt(np.maximum(xx + yy - apart, 0.0) / np.maximum(xx + yy + apart, _LEAST))
    features = np.stack([np.minimum(vague, _MOST_OFF), np.minimum(2.0 * radius, _MOST_WIDE), thin], axis=1)
    features[ones < _FEWEST] = (_MOST_OFF, 0.0, 0.0)
    return np.asarray(features.reshape(count, _BANDS, 3).transpose(0, 2, 1).reshape(count, -1))


def _key(owner: NDArray[np.int64], share: Numbers, parts: int) -> NDArray[np.int64]:
    """Return (M,) the index of the part, within its thing, that contains each share from 0 to 1."""
    return np.asarray(owner * parts + np.minimum((share * parts).astype(np.int64), parts - 1))


def _extents(values: Numbers, key: NDArray[np.int64], count: int) -> Numbers:
    """Return (count, D) the ranges of values (M, D) of each key; 0 for unused keys."""
    order = np.argsort(key, kind="stable")
    ordered, used = np.ascontiguousarray(values[order].T), np.bincount(key, minlength=count) > 0
    first = np.searchsorted(key[order], np.flatnonzero(used))
    extents = np.zeros((count, values.shape[1]))
    low, high = (end.reduceat(ordered, first, axis=1) for end in (np.minimum, np.maximum))
    extents[used] = (high - low).T
    return extents
