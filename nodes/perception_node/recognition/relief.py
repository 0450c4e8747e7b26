"""Relief features: two small images of a thing, its nearness in the camera's view and its height from above.

Both have a fixed size and are flipped so that the fuller side comes first, so a handle is always on the same
side. All things are computed together.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.nodes.perception_node.views.merged_thing import Thing

_SIDE = 12
RELIEF = 2 * _SIDE * _SIDE
"""The number of cells of both images."""

_LEAST, _LEAST_M = 1e-9, 1e-3
_NEAREST, _FARTHEST = 1.8, 0.2
"""Values of the nearest and the farthest cell. Empty cells are 0, and the middle is 1."""


def reliefs(things: Sequence[Thing], inside: Sequence[Numbers]) -> Numbers:
    """Return (N, RELIEF) features of N things; `inside` are the cells in each box, see `features`."""
    owner = np.repeat(np.arange(len(things)), [len(where) for where in inside])
    return np.concatenate([_front(things, owner), _top(things, inside, owner)], axis=1)


def _front(things: Sequence[Thing], owner: NDArray[np.int64]) -> Numbers:
    """Return the view of the nearest camera, upright."""
    middle = np.array([thing.box.bottom_m[:2] for thing in things])
    eyes = np.array([_nearest(thing) for thing in things])
    sight = middle - eyes[:, :2]
    sight /= np.maximum(np.linalg.norm(sight, axis=1, keepdims=True), _LEAST)
    cells = np.concatenate([thing.cells for thing in things])
    x, y = (cells[:, :2] - middle[owner]).T
    along, across = sight[owner].T
    beside, away = y * along - x * across, x * along + y * across
    bottom = np.array([thing.box.low[2] for thing in things])
    up = cells[:, 2] - bottom[owner]
    least, most = _ends(beside, owner, len(things))
    near, far = _ends(away, owner, len(things))
    _, top = _ends(up, owner, len(things))
    window = np.maximum(np.maximum(most - least, top), _LEAST_M)
    u = (beside - (least + most)[owner] / 2.0) / window[owner] + 0.5
    nearness = 1.0 + ((near + far)[owner] / 2.0 - away) / window[owner]
    return _image(u, up / window[owner], nearness, owner, len(things))


def _nearest(thing: Thing) -> NDArray[np.float64]:
    apart = np.linalg.norm(thing.eyes - thing.box.bottom_m, axis=1)
    return np.asarray(thing.eyes[apart.argmin()])


def _top(things: Sequence[Thing], inside: Sequence[Numbers], owner: NDArray[np.int64]) -> Numbers:
    """Return the view from above, with the longer side horizontal."""
    long_short = np.array([np.sort(thing.box.size_m[:2])[::-1] for thing in things])
    share = long_short[:, 1] / np.maximum(long_short[:, 0], _LEAST_M)
    u, v, up = np.concatenate(inside).T
    v = (v - 0.5) * share[owner] + 0.5
    return _image(u, v, _FARTHEST + (_NEAREST - _FARTHEST) * up, owner, len(things), flips=2)


def _ends(values: Numbers, owner: NDArray[np.int64], count: int) -> tuple[Numbers, Numbers]:
    """Return (count,) minimum and maximum of each thing's values; the cells of a thing are contiguous."""
    first = np.searchsorted(owner, np.arange(count))
    return np.minimum.reduceat(values, first), np.maximum.reduceat(values, first)


def _image(
    u: Numbers, v: Numbers, value: Numbers, owner: NDArray[np.int64], count: int, *, flips: int = 1
) -> Numbers:
    """Return (count, _SIDE * _SIDE) the maximum value of each cell, flipped on `flips` axes if needed.

    The fuller half comes first on these axes.
    """
    column, row = (np.clip((share * _SIDE).astype(np.int64), 0, _SIDE - 1) for share in (u, v))
    flat = np.zeros(count * _SIDE * _SIDE)
    np.maximum.at(flat, (owner * _SIDE + column) * _SIDE + row, np.clip(value, _FARTHEST, _NEAREST))
    pictures = flat.reshape(count, _SIDE, _SIDE)
    half = _SIDE // 2
    for axis in range(1, flips + 1):
        first, last = np.split(pictures, [half], axis=axis)
        turned = first.sum(axis=(1, 2)) < last.sum(axis=(1, 2))
        pictures[turned] = np.flip(pictures[turned], axis=axis)
    return np.asarray(pictures.reshape(count, -1))
