"""Train the decision which neighbouring segments belong to one thing."""

from __future__ import annotations

import numpy as np

from semmap.nodes.perception_node.recognition.features import SORTS
from semmap.nodes.perception_node.recognition.joining import is_worth_joining, pair_features
from semmap.nodes.perception_node.recognition.recognition_model import RecognitionModel
from semmap.nodes.perception_node.recognition.vote import leaf_probabilities
from semmap.nodes.perception_node.segmentation.trees import Trees
from semmap.nodes.training.recognition.neighbour_pairs import Pairs
from semmap.nodes.training.segmentation.examples import Rows
from semmap.nodes.training.segmentation.fit import fit

_TREES = 100


def learn_joining(learnt: RecognitionModel, pairs: Pairs) -> Trees:
    """Train trees on pairs in scenes on which `learnt` was not trained."""
    of_sorts = (getattr(pairs, sort) for sort in SORTS)
    features = [values.reshape(-1, values.shape[2]) for values in of_sorts]
    chances = leaf_probabilities(learnt, features).reshape(len(pairs.one), 3, -1)
    worth = is_worth_joining(chances[:, :2], learnt)
    told = pair_features(chances[worth, :2], chances[worth, 2], pairs.known[worth], learnt)
    return fit(Rows(told, pairs.one[worth], np.ones(len(told))), _TREES)
