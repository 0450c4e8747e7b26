"""Boosted trees, evaluated with NumPy."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

LEAVES = 16
"""Maximum number of leaves of a tree, stored as bits."""


@dataclass(frozen=True)
class Trees:
    """A sum of T trees over features, converted to a probability.

    All tests of all trees are evaluated at once: is the feature at most the threshold? If not, the leaves
    below the other branch are excluded. The leftmost remaining leaf is the tree's (QuickScorer).

    `feature`, `threshold`, `keeps`: (Q,) of all tests, tree by tree; `keeps` has a bit for each leaf that a
    failed test does not exclude. `first`: (T,) the first test of each tree. `value`: (T, LEAVES) the value of
    each leaf, and `bias` a constant.
    """

    feature: NDArray[np.int32]
    threshold: NDArray[np.float32]
    keeps: NDArray[np.uint16]
    first: NDArray[np.int32]
    value: NDArray[np.float32]
    bias: float

    def probability(self, features: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the probabilities (N,) of rows (N, F)."""
        feature, threshold, rules_out = self._tests
        answers = np.ascontiguousarray(features.T)[feature] > threshold
        left = ~np.bitwise_or.reduce(answers * rules_out, axis=0)
        leaf = _LOWEST_BIT[left & -left]
        value = self.value.ravel().take(leaf + LEAVES * np.arange(len(leaf))[:, None])
        total = value.sum(axis=0) + np.float32(self.bias)
        return np.asarray(1 / (1 + np.exp(-total)), np.float32)

    @cached_property
    def _tests(self) -> tuple[NDArray[np.int32], NDArray[np.float32], NDArray[np.uint16]]:
        """Return the tests by depth, so that the bits of many trees are combined at once.

        Feature (Q, T), threshold (Q, T, 1), and the excluded leaves (Q, T, 1). A tree with fewer tests
        repeats its last one.
        """
        count = np.diff(self.first, append=len(self.feature))
        at = self.first + np.minimum(np.arange(count.max(initial=0))[:, None], count - 1)
        return self.feature[at], self.threshold[at][..., None], ~self.keeps[at][..., None]


_LOWEST_BIT = np.zeros(1 << 16, np.uint8)
_LOWEST_BIT[1 << np.arange(16)] = np.arange(16)
