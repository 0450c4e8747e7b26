"""Patches become objects: the surest pairs are merged first, and what that changes is looked at anew."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.segmentation.pairs import candidates
from semmap.nodes.perception_node.segmentation.statistics import Indices, Statistics

Judge = Callable[[Statistics, Indices, Indices], NDArray[np.float32]]
"""How likely the pairs of patches (a, b) are one object: (N,)."""

SURE_ENOUGH = 0.5
_CERTAIN = 0.9  # pairs as sure as this need not wait for one another


class Merged(NamedTuple):
    """N objects out of P patches.

    `number`: (P,) of each patch's object, from 1. `same`: (N, N) how likely two objects are one all the same,
    0 where they were not compared.
    """

    number: NDArray[np.int32]
    same: NDArray[np.float32]


def merge(of: Statistics, judge: Judge) -> Merged:
    """Put patches together; `of` is used up."""
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
        for keep, gone in pairs:
            of.merge(keep, gone)
            may[keep] |= may[gone]
            may[:, keep] |= may[:, gone]
            may[gone] = may[:, gone] = False
            may[keep, keep] = False
            score[gone] = score[:, gone] = 0
            grown.append(keep)
        news[grown] = may[grown]
        news &= ~(news.T & np.tri(count, dtype=bool))  # each pair once
    left, number = np.unique(of.owner, return_inverse=True)
    return Merged(number.astype(np.int32) + 1, score[np.ix_(left, left)])


def _next(score: NDArray[np.float32]) -> list[tuple[int, int]]:
    """The pairs to merge now: all that are certain and each other's best, else the surest if sure enough."""
    best = score.argmax(axis=1)
    index = np.arange(len(score))
    mutual = (best[best] == index) & (index < best) & (score[index, best] >= _CERTAIN)
    if mutual.any():
        return [(int(a), int(best[a])) for a in np.flatnonzero(mutual)]
    a, b = divmod(int(score.argmax()), len(score))
    return [(a, b)] if score[a, b] >= SURE_ENOUGH else []
