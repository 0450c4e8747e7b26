"""Pieces of things look for what they are pieces of: together they are easier to recognise than apart."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from nodes.perception_node.boxes import Numbers
from nodes.perception_node.recognition.features import features_of
from nodes.perception_node.recognition.learnt import CLUTTER, UNKNOWN, Learnt
from nodes.perception_node.recognition.vote import leaves
from nodes.perception_node.things import Thing

_NEAR_M = 0.015
_DOUBTFUL = 0.6
_ROUNDS = 6
_MOST_PAIRS = 12
_GAIN = 0.05
_PIECE = 0.5
_IDLE = 0.3

Join = Callable[[Thing, Thing], Thing]


def put_together(
    things: Sequence[Thing], learnt: Learnt, join: Join
) -> tuple[list[Thing], Numbers, list[list[int]]]:
    """Join neighbours that are recognised better as one, the pair that gains most first.

    Returns the things, (N, K) probabilities of their leaves, and for each the numbers of `things` in it.
    """
    if not things:
        return [], np.empty((0, len(learnt.classes))), []
    parts = list(things)
    members: list[tuple[int, ...]] = [(n,) for n in range(len(things))]
    chances = leaves(learnt, features_of(parts))
    tried: dict[tuple[tuple[int, ...], tuple[int, ...]], tuple[Thing, Numbers]] = {}
    for _ in range(_ROUNDS):
        pairs = _doubtful_neighbours(parts, *_judged(chances, learnt))[:_MOST_PAIRS]
        new = [(a, b) for a, b in pairs if (members[a], members[b]) not in tried]
        wholes = [join(parts[a], parts[b]) for a, b in new]
        if wholes:
            together = leaves(learnt, features_of(wholes))
            for (a, b), whole, chance in zip(new, wholes, together, strict=True):
                tried[members[a], members[b]] = whole, chance
        gains = [_gain(tried[members[a], members[b]][1], chances[[a, b]], learnt) for a, b in pairs]
        if max(gains, default=0.0) <= 0.0:
            break
        a, b = pairs[int(np.argmax(gains))]
        parts[a], chances[a] = tried[members[a], members[b]]
        members[a] += members[b]
        del parts[b], members[b]
        chances = np.delete(chances, b, axis=0)
    return parts, chances, [list(numbers) for numbers in members]


def _gain(whole: Numbers, apart: Numbers, learnt: Learnt) -> float:
    """How much surer the whole (K,) is than the surer of two (2, K); a mere piece may even cost a little."""
    known, piece = _judged(np.vstack([whole, apart]), learnt)
    idle = piece[1:].max() > _PIECE or known[1:].min() < _IDLE
    return float(known[0] - known[1:].max()) + (_GAIN if idle else -_GAIN)


def _judged(chances: Numbers, learnt: Learnt) -> tuple[Numbers, Numbers]:
    """(N,) how likely each is of its best class, and how likely it is a mere piece of something."""
    nameable = np.array([name not in (UNKNOWN, CLUTTER) for name in learnt.classes])
    return chances[:, nameable].max(axis=1), chances[:, learnt.classes.index(CLUTTER)]


def _doubtful_neighbours(things: Sequence[Thing], known: Numbers, piece: Numbers) -> list[tuple[int, int]]:
    """Pairs (a, b), a < b, that nearly touch, one of them hard to recognise alone; no table tops."""
    low = np.array([thing.cells.min(axis=0) for thing in things])
    high = np.array([thing.cells.max(axis=0) for thing in things])
    apart = np.maximum(low[:, None] - high, low - high[:, None]).max(axis=2)
    small = np.array([not thing.carrier for thing in things])
    doubtful = (known < _DOUBTFUL) | (piece > _PIECE)
    near = (apart < _NEAR_M) & small & small[:, None] & (doubtful | doubtful[:, None])
    return [(int(a), int(b)) for a, b in np.argwhere(np.triu(near, 1))]
