"""Open-set recognition: how likely a thing is of no known class."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.distance import cdist

from semmap.nodes.perception_node.views.boxes import Numbers


@dataclass(frozen=True)
class OpenSetDetector:
    """An embedding in which things of one class are close, and a logistic regression on the distance.

    `mean`: (D,) of all features, `axes`: (D, A) of the projection, `centres`: (K, A) of the leaves.
    `weights`: (F + 1,) of the regression on `open_set_features`, with the constant last.
    """

    mean: Numbers
    axes: Numbers
    centres: Numbers
    weights: Numbers

    def __call__(self, features: Sequence[Numbers], votes: Numbers, pooled: Numbers) -> Numbers:
        """Return (N,) probabilities that things are of no known class; see `open_set_features`."""
        inputs = open_set_features(self, features, votes, pooled)
        return np.asarray(1.0 / (1.0 + np.exp(-(inputs @ self.weights[:-1] + self.weights[-1]))))


def open_set_features(
    novelty: OpenSetDetector, features: Sequence[Numbers], votes: Numbers, pooled: Numbers
) -> Numbers:
    """Return features (N, F): entropy of the votes, disagreement, and distance to classes.

    `features`: of each sort (N, its own number). `votes`: (voters, N, K) and `pooled`: (N, K) are logarithms
    of probabilities.
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
