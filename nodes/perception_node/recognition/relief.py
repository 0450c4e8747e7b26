"""Two small pictures of a thing: how near it is, seen as the camera does, and how high, seen from above.

Both are of one size for all things, and turned so that the fuller side comes first: a handle is always on the
same one. All things are worked out together.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.nodes.perception_node.views.merged_thing import Thing

_SIDE = 12
RELIEF = 2 * _SIDE * _SIDE
"""How many cells both pictures have."""

_LEAST, _LEAST_M = 1e-9, 1e-3
_NEAREST, _FARTHEST = 1.8, 0.2
"""What stands for the nearest and the farthest; nothing is 0, and the middle 1."""


def reliefs(things: Sequence[Thing], inside: Sequence[Numbers]) -> Numbers:
    """(N, RELIEF) of N things; `inside`: of each its cells in its box, see `features`."""
    owner = np.repeat(np.arange(len(things)), [len(where) for where in inside])
    return np.concatenate([_front(things, owner), _top(things, inside, owner)], axis=1)


def _front(things: Sequence[Thing], owner: NDArray[np.int64]) -> Numbers:
    """As its nearest camera sees it, upright."""
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
    return _picture(u, up / window[owner], nearness, owner, len(things))


def _nearest(thing: Thing) -> NDArray[np.float64]:
    apart = np.linalg.norm(thing.eyes - thing.box.bottom_m, axis=1)
    return np.asarray(thing.eyes[apart.argmin()])


def _top(things: Sequence[Thing], inside: Sequence[Numbers], owner: NDArray[np.int64]) -> Numbers:
    """From above, its longer side across."""
    long_short = np.array([np.sort(thing.box.size_m[:2])[::-1] for thing in things])
    share = long_short[:, 1] / np.maximum(long_short[:, 0], _LEAST_M)
    u, v, up = np.concatenate(inside).T
    v = (v - 0.5) * share[owner] + 0.5
    return _picture(u, v, _FARTHEST + (_NEAREST - _FARTHEST) * up, owner, len(things), flips=2)


def _ends(values: Numbers, owner: NDArray[np.int64], count: int) -> tuple[Numbers, Numbers]:
    """(count,) the least and the largest of each thing's values; its cells follow one another."""
    first = np.searchsorted(owner, np.arange(count))
    return np.minimum.reduceat(values, first), np.maximum.reduceat(values, first)


def _picture(
    u: Numbers, v: Numbers, value: Numbers, owner: NDArray[np.int64], count: int, *, flips: int = 1
) -> Numbers:
    """(count, _SIDE * _SIDE) the largest value in each cell; the fuller half comes first on so many axes."""
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
