"""Pieces of things look for what they are pieces of: together they are easier to recognise than apart."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from nodes.perception_node.boxes import Numbers
from nodes.perception_node.recognition.features import features_of
from nodes.perception_node.recognition.learnt import CLUTTER, UNKNOWN, Learnt
from nodes.perception_node.recognition.vote import leaves
from nodes.perception_node.things import Thing

_NEAR_M = 0.015
_DOUBTFUL = 0.6
_ROUNDS = 4
_GAIN = 0.05
_PIECE = 0.5

Join = Callable[[Thing, Thing], Thing]


def put_together(
    things: Sequence[Thing], learnt: Learnt, join: Join
) -> tuple[list[Thing], Numbers, list[list[int]]]:
    """Join neighbours that are recognised better as one.

    Returns the things, (N, K) probabilities of their leaves, and for each the numbers of `things` in it.
    """
    parts, members = list(things), [[n] for n in range(len(things))]
    chances = leaves(learnt, features_of(parts)) if parts else np.empty((0, len(learnt.classes)))
    for _ in range(_ROUNDS):
        known, piece = _judged(chances, learnt)
        pairs = _doubtful_neighbours(parts, known, piece)
        if not pairs:
            break
        wholes = [join(parts[a], parts[b]) for a, b in pairs]
        together = leaves(learnt, features_of(wholes))
        sure = _judged(together, learnt)[0]
        apart = np.array(
            [max(known[a], known[b]) - (2 * _GAIN if piece[[a, b]].max() > _PIECE else 0.0) for a, b in pairs]
        )
        best = int((sure - apart).argmax())
        if sure[best] < apart[best] + _GAIN:
            break
        a, b = pairs[best]
        parts[a], members[a], chances[a] = wholes[best], members[a] + members[b], together[best]
        del parts[b], members[b]
        chances = np.delete(chances, b, axis=0)
    return parts, chances, members


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
