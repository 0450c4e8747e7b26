"""Learn which neighbours are pieces of one thing."""

from __future__ import annotations

import numpy as np

from nodes.perception_node.recognition.joining import joining_signs, worth_joining
from nodes.perception_node.recognition.learnt import Learnt
from nodes.perception_node.recognition.perceptron import Perceptron
from nodes.perception_node.recognition.vote import leaves
from nodes.training.fitting import classifier
from nodes.training.pairs import Pairs

_HIDDEN = (24,)


def learn_joining(learnt: Learnt, pairs: Pairs) -> Perceptron:
    """Scores for two and for one, from pairs in scenes that `learnt` has not learnt from."""
    features = [values.reshape(-1, values.shape[2]) for values in (pairs.geometry, pairs.shape, pairs.colour)]
    chances = leaves(learnt, features).reshape(len(pairs.one), 3, -1)
    worth = worth_joining(chances[:, :2], learnt)
    signs = joining_signs(chances[worth, :2], chances[worth, 2], pairs.known[worth], learnt)
    return classifier(signs, pairs.one[worth].astype(np.int64), 2, _HIDDEN)
