"""Patches become objects: the surest pair is merged first, and what that changes is looked at anew."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from nodes.perception_node.segmentation.pairs import candidates
from nodes.perception_node.segmentation.statistics import Indices, Statistics

Judge = Callable[[Statistics, Indices, Indices], NDArray[np.float32]]
"""How likely the pairs of patches (a, b) are one object: (N,)."""

SURE_ENOUGH = 0.5


def merge(of: Statistics, judge: Judge) -> NDArray[np.int32]:
    """(P,) for each patch the number of its object, from 1. `of` is used up."""
    count = len(of.inside)
    may = candidates(of)
    score = np.zeros((count, count), np.float32)

    def look(a: Indices, b: Indices) -> None:
        if len(a):
            score[a, b] = score[b, a] = judge(of, a, b)

    look(*np.nonzero(np.triu(may)))
    while count:
        a, b = divmod(int(score.argmax()), count)
        if score[a, b] < SURE_ENOUGH:
            break
        of.merge(a, b)
        may[a] |= may[b]
        may[:, a] |= may[:, b]
        may[b] = may[:, b] = False
        may[a, a] = False
        score[b] = score[:, b] = 0
        others = np.flatnonzero(may[a])
        look(np.full(len(others), a), others)
    return np.unique(of.owner, return_inverse=True)[1].astype(np.int32) + 1
