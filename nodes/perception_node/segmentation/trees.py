"""Boosted trees, evaluated by numpy alone."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

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
        feature, threshold, rules_out = self._asked
        answers = np.ascontiguousarray(features.T)[feature] > threshold
        left = ~np.bitwise_or.reduce(answers * rules_out, axis=0)
        leaf = _LOWEST_BIT[left & -left]
        value = self.value.ravel().take(leaf + LEAVES * np.arange(len(leaf))[:, None])
        total = value.sum(axis=0) + np.float32(self.bias)
        return np.asarray(1 / (1 + np.exp(-total)), np.float32)

    @cached_property
    def _asked(self) -> tuple[NDArray[np.int32], NDArray[np.float32], NDArray[np.uint16]]:
        """The trees' first questions, their second ones, and so on, since bits of many are joined at once.

        Feature (Q, T), threshold (Q, T, 1), and the leaves that a *no* rules out (Q, T, 1); a tree that has
        no more questions asks its last one again.
        """
        count = np.diff(self.first, append=len(self.feature))
        at = self.first + np.minimum(np.arange(count.max(initial=0))[:, None], count - 1)
        return self.feature[at], self.threshold[at][..., None], ~self.keeps[at][..., None]


_LOWEST_BIT = np.zeros(1 << 16, np.uint8)
_LOWEST_BIT[1 << np.arange(16)] = np.arange(16)
