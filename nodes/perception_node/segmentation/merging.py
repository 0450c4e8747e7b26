"""Merges patches to objects: the most certain pairs first, with updated scores after each merge."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.segmentation.pairs import candidates
from semmap.nodes.perception_node.segmentation.statistics import Indices, Statistics

Judge = Callable[[Statistics, Indices, Indices], NDArray[np.float32]]
"""Returns the probabilities (N,) that pairs of patches (a, b) are one object."""

SURE_ENOUGH = 0.5
_CERTAIN = 0.9  # pairs this certain are merged together


class Merged(NamedTuple):
    """N objects from P patches.

    `number`: (P,) the object of each patch, from 1. `same`: (N, N) the probability that two objects are one,
    0 if they were not compared.
    """

    number: NDArray[np.int32]
    same: NDArray[np.float32]


def merge(of: Statistics, judge: Judge) -> Merged:
    """Merge patches; `of` is modified."""
    count = len(of.inside)
    may = candidates(of)
    score = np.zeros((count, count), np.float32)
    news = np.triu(may)
    while count:
        a, b = np.nonzero(news)
        if a.size:
            score[a, b] = score[b, a] = judge(of, a, b)
        pairs = _next(score)
        if not pairs:
            break
        news = np.zeros_like(may)
        grown = []
        for keep, merged in pairs:
            of.merge(keep, merged)
            may[keep] |= may[merged]
            may[:, keep] |= may[:, merged]
            may[merged] = may[:, merged] = False
            may[keep, keep] = False
            score[merged] = score[:, merged] = 0
            grown.append(keep)
        news[grown] = may[grown]
        news &= ~(news.T & np.tri(count, dtype=bool))  # each pair once
    left, number = np.unique(of.owner, return_inverse=True)
    return Merged(number.astype(np.int32) + 1, score[np.ix_(left, left)])


def _next(score: NDArray[np.float32]) -> list[tuple[int, int]]:
    """Return the pairs to merge: all that are certain and mutually best, else the best certain enough."""
    best = score.argmax(axis=1)
    index = np.arange(len(score))
    mutual = (best[best] == index) & (index < best) & (score[index, best] >= _CERTAIN)
    if mutual.any():
        return [(int(a), int(best[a])) for a in np.flatnonzero(mutual)]
    a, b = divmod(int(score.argmax()), len(score))
    return [(a, b)] if score[a, b] >= SURE_ENOUGH else []
