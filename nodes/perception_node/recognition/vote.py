"""The vote of the classifiers, and the most specific class that is certain enough."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from semmap.nodes.perception_node.recognition.features import SORTS
from semmap.nodes.perception_node.recognition.perceptron import Perceptron, log_softmax
from semmap.nodes.perception_node.recognition.recognition_model import (
    CLUTTER,
    UNKNOWN,
    VOTERS,
    RecognitionModel,
)
from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.schemas.perception import SURE

_CLEAR = 0.9
_SAY = 0.2
"""Weight of the votes for a thing with the form of our model, so that they can rule it out."""


def vote(voters: Sequence[Perceptron], weights: Numbers, features: Sequence[Numbers]) -> Numbers:
    """Return (N, K) probabilities of the leaves; `features`: of each sort (N, its own number).

    The votes are independent evidence: their logarithms are added, with weights from calibration on other
    scenes.
    """
    return np.exp(pool_votes(log_votes(voters, features), weights))


def voter_inputs(features: Sequence[Numbers]) -> list[Numbers]:
    """Return the inputs of each of `VOTERS` from `features`: of each sort (N, its own number)."""
    of_sort = dict(zip(SORTS, features, strict=True))
    shown = {
        sorts: np.concatenate([of_sort[sort] for sort in sorts], axis=1) for sorts in set(VOTERS.values())
    }
    return [shown[sorts] for sorts in VOTERS.values()]


def log_votes(voters: Sequence[Perceptron], features: Sequence[Numbers]) -> Numbers:
    """Return (voters, N, K) the log probabilities of each voter."""
    shown = voter_inputs(features)
    return np.array([log_softmax(voter(seen)) for voter, seen in zip(voters, shown, strict=True)])


def pool_votes(votes: Numbers, weights: Numbers) -> Numbers:
    """Return (N, K) the log probabilities of all votes (voters, N, K) together."""
    return log_softmax(np.tensordot(weights, votes, axes=1))


def leaf_probabilities(learnt: RecognitionModel, features: Sequence[Numbers]) -> Numbers:
    """Return (N, K) probabilities of the leaves, with things of no known class counted as `UNKNOWN`.

    A thing with the exact form of one of our models is recognised by that; the votes decide otherwise.
    Exemplars are additional leaves, independent of both.
    """
    votes = log_votes(learnt.voters, features)
    pooled = pool_votes(votes, learnt.weights)
    new = learnt.novelty(features, votes, pooled)
    probabilities = np.exp(pooled)
    nameable = np.array([name not in (UNKNOWN, CLUTTER) for name in learnt.classes[: pooled.shape[1]]])
    moved = np.where(nameable, probabilities * new[:, None], 0.0)
    probabilities -= moved
    probabilities[:, learnt.classes.index(UNKNOWN)] += moved.sum(axis=1)
    scores = log_softmax(learnt.familiar(np.concatenate(features, axis=1)))
    scores[:, :-1] += _SAY * pooled
    familiar = np.exp(log_softmax(scores))
    probabilities = familiar[:, :-1] + familiar[:, -1:] * probabilities
    return (
        probabilities
        if learnt.exemplars is None
        else learnt.exemplars.add_probabilities(features, probabilities)
    )


def expected_sizes(probabilities: Numbers, sizes_m: Numbers) -> Numbers:
    """Return (N, 3) the expected sizes [m]: the geometric mean of `sizes_m` (K, 3) over the leaves."""
    return np.asarray(np.exp(probabilities @ np.log(sizes_m)))


def choose_class(
    probabilities: Mapping[str, float],
    ancestors: Mapping[str, Sequence[str]],
    sure: float = SURE,
    clear: float = _CLEAR,
) -> tuple[str, float]:
    """Return the most specific class with a probability of at least `sure`; else `UNKNOWN`.

    A class must have at least the share `clear` of the probability of each of its ancestors: a thing that is
    either a desk or a table is furniture. Among unrelated classes, the most likely is chosen.
    """
    total: dict[str, float] = {}
    for leaf, probability in probabilities.items():
        for name in (leaf, *ancestors.get(leaf, ())):
            total[name] = total.get(name, 0.0) + probability
    certain = [
        name
        for name in total
        if name not in (UNKNOWN, CLUTTER)
        and total[name] >= sure
        and all(total[name] >= clear * total[above] for above in ancestors.get(name, ()) if above != UNKNOWN)
    ]
    lowest = [name for name in certain if not any(name in ancestors.get(other, ()) for other in certain)]
    best = max(lowest, key=total.__getitem__, default=UNKNOWN)
    return best, min(1.0, total.get(best, 0.0))


def probability_of(
    class_: str, probabilities: Mapping[str, float], ancestors: Mapping[str, Sequence[str]]
) -> float:
    """Return the probability of a class from those of the leaves."""
    return min(1.0, sum(p for leaf, p in probabilities.items() if class_ in (leaf, *ancestors.get(leaf, ()))))
