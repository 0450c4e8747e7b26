"""Train the decision which neighbouring segments belong to one thing."""

from __future__ import annotations

import numpy as np

from semmap.nodes.perception_node.recognition.features import SORTS
from semmap.nodes.perception_node.recognition.joining import signs, worth_trying
from semmap.nodes.perception_node.recognition.shipped_votes import Learnt
from semmap.nodes.perception_node.recognition.vote import leaves
from semmap.nodes.perception_node.segmentation.trees import Trees
from semmap.nodes.training.recognition.neighbour_pairs import Pairs
from semmap.nodes.training.segmentation.examples import Rows
from semmap.nodes.training.segmentation.fit import fit

_TREES = 100


def learn_joining(learnt: Learnt, pairs: Pairs) -> Trees:
    """Train trees on pairs in scenes on which `learnt` was not trained."""
    of_sorts = (getattr(pairs, sort) for sort in SORTS)
    features = [values.reshape(-1, values.shape[2]) for values in of_sorts]
    chances = leaves(learnt, features).reshape(len(pairs.one), 3, -1)
    worth = worth_trying(chances[:, :2], learnt)
    told = signs(chances[worth, :2], chances[worth, 2], pairs.known[worth], learnt)
    return fit(Rows(told, pairs.one[worth], np.ones(len(told))), _TREES)
