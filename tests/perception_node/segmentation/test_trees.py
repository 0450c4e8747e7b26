"""Trees in NumPy give the results of scikit-learn."""

from __future__ import annotations

import numpy as np

from semmap.nodes.perception_node.segmentation.trees import LEAVES
from semmap.nodes.training.segmentation.fit import trees_of

RNG = np.random.default_rng(0)
X = RNG.normal(size=(600, 7)).astype(np.float32)
Y = X[:, 0] * X[:, 1] + X[:, 2] > 0.3


def fitted(y, **options):
    from sklearn.ensemble import HistGradientBoostingClassifier  # when it is needed: it takes a second

    model = HistGradientBoostingClassifier(max_leaf_nodes=LEAVES, min_samples_leaf=5, **options)
    model.fit(X, y)
    return model, trees_of([p[0].nodes for p in model._predictors], float(model._baseline_prediction.item()))


def test_the_same_probabilities():
    model, trees = fitted(Y, max_iter=8)
    seen = np.concatenate([X, RNG.normal(scale=3, size=(500, 7)).astype(np.float32)])
    expected = model.predict_proba(seen)[:, 1]
    np.testing.assert_allclose(trees.probability(seen), expected, atol=1e-5)
    assert expected.std() > 0.2


def test_trees_that_ask_nothing():
    model, trees = fitted(RNG.random(600) < 0.5, max_iter=3, l2_regularization=1e9)
    np.testing.assert_allclose(trees.probability(X), model.predict_proba(X)[:, 1], atol=1e-5)


def test_no_rows():
    _, trees = fitted(Y, max_iter=2)
    assert trees.probability(X[:0]).shape == (0,)
