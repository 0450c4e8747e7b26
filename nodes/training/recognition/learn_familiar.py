"""Train the recognition of our own models, and the rejection of other things."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.recognition.perceptron import Perceptron
from semmap.nodes.training.recognition.fitting import Numbers, classifier
from semmap.nodes.training.recognition.gradient_descent import Recipe
from semmap.nodes.training.recognition.learn_open_set import far_off

_FAR = 0.05
"""The share of added outliers, which are not our models."""


def learn_familiar(
    features: Sequence[Numbers], leaf: NDArray[np.int64], leaves: int, recipe: Recipe
) -> Perceptron:
    """Train scores (N, leaves + 1) from all features, per sort (N, its number of features).

    `leaf`: (N,) the leaf class whose model has exactly this form, `leaves` for none.
    """
    far = far_off(features, round(_FAR * len(leaf)), np.random.default_rng(0))
    seen = np.concatenate([np.concatenate(both) for both in zip(features, far, strict=True)], axis=1)
    aim = np.append(leaf, np.full(len(far[0]), leaves))
    return classifier(seen, aim, leaves + 1, recipe, seed=leaves)
