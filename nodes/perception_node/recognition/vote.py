"""The vote of the classifiers, and the most special class that is sure enough."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from nodes.perception_node.boxes import Numbers
from nodes.perception_node.recognition.learnt import CLUTTER, UNKNOWN, Learnt
from nodes.perception_node.recognition.perceptron import log_softmax


def vote(learnt: Learnt, features: Sequence[Numbers]) -> Numbers:
    """(N, K) probabilities of the leaves; `features`: for each voter (N, its own number).

    The votes are independent evidence, so their logarithms add up, each with the weight that calibration on
    scenes apart gave it.
    """
    votes = [log_softmax(voter(seen)) for voter, seen in zip(learnt.voters, features, strict=True)]
    return np.exp(log_softmax(np.tensordot(learnt.weights, np.array(votes), axes=1)))


def answer(
    probabilities: Mapping[str, float], ancestors: Mapping[str, Sequence[str]], sure: float
) -> tuple[str, float]:
    """The most special class whose leaves together are at least `sure`, and its probability; else `UNKNOWN`.

    Of several, none of which is below another, the likelier.
    """
    total: dict[str, float] = {}
    for leaf, probability in probabilities.items():
        for name in (leaf, *ancestors.get(leaf, ())):
            total[name] = total.get(name, 0.0) + probability
    certain = [name for name in total if total[name] >= sure and name not in (UNKNOWN, CLUTTER)]
    lowest = [name for name in certain if not any(name in ancestors.get(other, ()) for other in certain)]
    best = max(lowest, key=total.__getitem__, default=UNKNOWN)
    return best, min(1.0, total.get(best, 0.0))
