"""Boosted trees, evaluated by numpy alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

LEAVES = 16
"""The most leaves of a tree: a set of them is the bits of 16."""


@dataclass(frozen=True)
class Trees:
    """A sum of T trees over features, turned into a probability.

    All questions of all trees are asked at once: "is the feature at most the threshold?" A *no* rules out the
    leaves below the question's *yes*, and of the leaves that no answer rules out the leftmost is the tree's.

    `feature`, `threshold`, `keeps`: (Q,) of all questions, tree by tree; `keeps` has a bit for each leaf that
    a *no* does not rule out. `first`: (T,) each tree's first question. `value`: (T, LEAVES) what each leaf
    adds to the sum, and `bias` what is added to it besides.
    """

    feature: NDArray[np.int32]
    threshold: NDArray[np.float32]
    keeps: NDArray[np.uint16]
    first: NDArray[np.int32]
    value: NDArray[np.float32]
    bias: float

    def probability(self, features: NDArray[np.float32]) -> NDArray[np.float32]:
        """(N,) of rows (N, F)."""
        no = features[:, self.feature] > self.threshold
        left = np.bitwise_and.reduceat(np.where(no, self.keeps, np.uint16(0xFFFF)), self.first, axis=1)
        leaf = _LOWEST_BIT[left & -left]
        total = self.value[np.arange(len(self.value)), leaf].sum(axis=1) + np.float32(self.bias)
        return np.asarray(1 / (1 + np.exp(-total)), np.float32)


_LOWEST_BIT = np.zeros(1 << 16, np.uint8)
_LOWEST_BIT[1 << np.arange(16)] = np.arange(16)
