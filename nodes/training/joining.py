"""Learn which neighbours are pieces of one thing."""

from __future__ import annotations

import numpy as np
from sklearn.linear_model import LogisticRegression

from nodes.perception_node.boxes import Numbers
from nodes.perception_node.recognition.joining import signs, worth_trying
from nodes.perception_node.recognition.learnt import Learnt
from nodes.perception_node.recognition.vote import leaves
from nodes.training.pairs import Pairs

_STRENGTH = 0.3


def learn_joining(learnt: Learnt, pairs: Pairs) -> Numbers:
    """Weights for `joining.likely_one`, from pairs in scenes that `learnt` has not learnt from."""
    features = [values.reshape(-1, values.shape[2]) for values in (pairs.geometry, pairs.shape, pairs.colour)]
    chances = leaves(learnt, features).reshape(len(pairs.one), 3, -1)
    worth = worth_trying(chances[:, :2], learnt)
    told = signs(chances[worth, :2], chances[worth, 2], pairs.known[worth], learnt)
    scale = told.std(axis=0)
    regression = LogisticRegression(C=_STRENGTH, max_iter=2000).fit(told / scale, pairs.one[worth])
    return np.append(regression.coef_[0] / scale, regression.intercept_)
