"""Patches become objects: the surest pair is merged first, and what that changes is looked at anew."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from nodes.perception_node.segmentation.pairs import candidates, features
from nodes.perception_node.segmentation.statistics import Statistics

Probability = Callable[[NDArray[np.float32]], NDArray[np.float32]]
"""Of rows of pair features, (N, F) to (N,)."""

SURE_ENOUGH = 0.5


def merge(of: Statistics, probability: Probability) -> NDArray[np.int32]:
    """(P,) for each patch the number of its object, from 1. `of` is used up."""
    count = len(of.inside)
    owner = np.arange(count)
    may = candidates(of)
    score = np.zeros((count, count), np.float32)

    def look(a: NDArray[np.int64], b: NDArray[np.int64]) -> None:
        if len(a):
            score[a, b] = score[b, a] = probability(features(of, a, b))

    look(*np.nonzero(np.triu(may)))
    while count:
        a, b = np.unravel_index(score.argmax(), score.shape)
        if score[a, b] < SURE_ENOUGH:
            break
        of.merge(int(a), int(b))
        owner[owner == b] = a
        may[a] |= may[b]
        may[:, a] |= may[:, b]
        may[b] = may[:, b] = False
        may[a, a] = False
        score[b] = score[:, b] = 0
        others = np.flatnonzero(may[a])
        look(np.full(len(others), a), others)
    return np.unique(owner, return_inverse=True)[1].astype(np.int32) + 1
