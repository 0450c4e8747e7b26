"""How likely a thing is of no class that was learnt."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.distance import cdist

from semmap.nodes.perception_node.views.boxes import Numbers


@dataclass(frozen=True)
class OpenSetDetector:
    """A space in which things of one class lie close together, and a regression on how far off a thing is.

    `mean`: (D,) of all features together, `axes`: (D, A) into the space, `centres`: (K, A) of the leaves.
    `weights`: (open_set_features + 1,) of the logistic regression, the constant last; see `open_set_features`.
    """

    mean: Numbers
    axes: Numbers
    centres: Numbers
    weights: Numbers

    def __call__(self, features: Sequence[Numbers], votes: Numbers, pooled: Numbers) -> Numbers:
        """(N,) probabilities that things are like nothing known; arguments as for `open_set_features`."""
        told = open_set_features(self, features, votes, pooled)
        return np.asarray(1.0 / (1.0 + np.exp(-(told @ self.weights[:-1] + self.weights[-1]))))


def open_set_features(
    novelty: OpenSetDetector, features: Sequence[Numbers], votes: Numbers, pooled: Numbers
) -> Numbers:
    """(N, open_set_features) what tells the unknown: doubt, disagreement and distance.

    `features`: of each sort (N, its own number); `votes`: (voters, N, K) and `pooled`: (N, K) logarithms of
    probabilities.
    """
    best = pooled.argmax(axis=1)
    rows = np.arange(len(best))
    doubt = -(np.exp(pooled) * pooled).sum(axis=1)
    place = (np.concatenate(features, axis=1) - novelty.mean) @ novelty.axes
    apart = cdist(place, novelty.centres)
    agreed = np.maximum(votes[:, rows, best], -10.0)
    return np.column_stack(
        [pooled[rows, best], doubt, *agreed, np.log(apart.min(axis=1)), np.log(apart[rows, best])]
    )
