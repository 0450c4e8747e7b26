"""What tells whether two neighbours are pieces of one thing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from nodes.perception_node.boxes import Numbers
from nodes.perception_node.recognition.learnt import CLUTTER, UNKNOWN, Learnt
from nodes.perception_node.things import Thing

_BESIDE_M = 0.015
_ABOVE_M = 0.2
"""So far a lamp's shade may be above its foot: what is thin between them is not seen."""

_DOUBTFUL = 0.6
_PIECE = 0.5
_LEAST = 1e-3


def near(things: Sequence[Thing]) -> list[tuple[int, int]]:
    """Pairs (a, b), a < b, that nearly touch or are above one another; no table tops."""
    low = np.array([thing.cells.min(axis=0) for thing in things])
    high = np.array([thing.cells.max(axis=0) for thing in things])
    small = np.array([not thing.carrier for thing in things])
    apart = np.maximum(low[:, None] - high, low - high[:, None])
    close = (apart < [_BESIDE_M, _BESIDE_M, _ABOVE_M]).all(axis=2) & small & small[:, None]
    return [(int(a), int(b)) for a, b in np.argwhere(np.triu(close, 1))]


def between(a: Thing, b: Thing, whole: Thing, held_for_one: Numbers) -> NDArray[np.float64]:
    """(7,) of a pair that nobody has recognised yet: points of each, gaps, how empty the whole's box is.

    `held_for_one`: (2, A, B) of what a and b consist of, see `fusion`.
    """
    gap = np.maximum(a.cells.min(axis=0) - b.cells.max(axis=0), b.cells.min(axis=0) - a.cells.max(axis=0))
    volumes = [thing.box.size_m.prod() for thing in (whole, a, b)]
    return np.array(
        [
            np.log(a.count),
            np.log(b.count),
            gap[:2].max(),
            gap[2],
            np.log(volumes[0] / sum(volumes[1:])),
            held_for_one[0].min(),
            held_for_one[1].max(),
        ]
    )


def worth_joining(apart: Numbers, learnt: Learnt) -> NDArray[np.bool_]:
    """(N,) whether one of two things (N, 2, K) is hard to recognise alone, or both are taken for the same."""
    known = apart[..., nameable(learnt)]
    doubtful = (known.max(axis=2) < _DOUBTFUL) | (apart[..., learnt.classes.index(CLUTTER)] > _PIECE)
    best = known.argmax(axis=2)
    return np.asarray(doubtful.any(axis=1) | (best[:, 0] == best[:, 1]))


def joining_signs(apart: Numbers, whole: Numbers, known: Numbers, learnt: Learnt) -> Numbers:
    """(N, signs) from probabilities of the leaves of two things (N, 2, K) and of both as one (N, K).

    `known`: (N, 7), see `between`. The order of the two does not matter: the surer one comes first.
    """
    things, rows = nameable(learnt), np.arange(len(whole))
    order = np.argsort(-apart[..., things].max(axis=2), axis=1, kind="stable")
    apart = np.take_along_axis(apart, order[..., None], axis=1)
    counts = np.take_along_axis(known[:, :2], order, axis=1)
    best = np.where(things, apart[:, 0], -1.0).argmax(axis=1)
    likely = [whole[:, things].max(axis=1), *apart[..., things].max(axis=2).T]
    same = [whole[rows, best], apart[rows, 1, best]]
    unnamed = [learnt.classes.index(CLUTTER), learnt.classes.index(UNKNOWN)]
    odd = [p[:, unnamed] for p in (whole, apart[:, 0], apart[:, 1])]
    logs = np.log(np.maximum(np.column_stack(likely + same), _LEAST))
    return np.column_stack([logs, *odd, counts, known[:, 2:]])


def nameable(learnt: Learnt) -> NDArray[np.bool_]:
    """(K,) which leaves are classes of things."""
    return np.array([name not in (UNKNOWN, CLUTTER) for name in learnt.classes])
