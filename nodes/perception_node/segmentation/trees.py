"""Boosted trees, evaluated by numpy alone."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

LEAVES = 16
"""The most leaves of a tree: a set of them is the bits of 16."""


@dataclass(frozen=True)
class Trees:
    """A sum of T trees over features, turned into a probability.

    Each question "is the feature at most the threshold" that is answered *no* excludes the leaves below its *yes*;
    the first leaf that is left, counted from the left, is the tree's. `feature`, `threshold`, `keeps`: (Q,) of all
    questions, tree by tree; `keeps` has the bits of the leaves that a *no* leaves. `first`: (T,) each tree's first
    question. `value`: (T, LEAVES). `bias` is added to the sum.
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
        return 1 / (1 + np.exp(-total))


_LOWEST_BIT = np.zeros(1 << 16, np.uint8)
_LOWEST_BIT[1 << np.arange(16)] = np.arange(16)
