"""Learn to tell what is like nothing known, by leaving out classes that are known."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from sklearn.discriminant_analysis import LinearDiscriminantAnalysis
from sklearn.linear_model import LogisticRegression

from nodes.perception_node.recognition.novelty import Novelty, signs
from nodes.perception_node.recognition.vote import ballots, pool, shown_to_voters
from nodes.training.recognition.fitting import Numbers, classifier

_FOLDS = 4
_LEFT_OUT = 0.12
_ROUNDS = 12
_ENOUGH = 0.5
"""The share of the samples that the voters of a fold learn from: signs need no more."""

_AXES = 30
_SHARE = 0.05
"""How many of the things that are met are of no class that was learnt; nobody knows, so it is a guess."""


def space(features: Sequence[Numbers], target: NDArray[np.int64], classes: int) -> Novelty:
    """The space alone, without the regression: axes that tell classes apart, scaled by how they scatter."""
    together = np.concatenate(features, axis=1)
    mean = together.mean(axis=0)
    found = LinearDiscriminantAnalysis(solver="eigen", shrinkage=0.05, n_components=_AXES)
    several = np.bincount(target)[target] > 1  # one alone does not scatter
    found.fit((together - mean)[several], target[several])
    axes = found.scalings_[:, :_AXES]
    centres = np.full((classes, _AXES), 1e3)
    for k in np.unique(target):
        centres[k] = (together[target == k] - mean).mean(axis=0) @ axes
    return Novelty(mean, axes, centres, np.zeros(1))


def learn_novelty(
    features: Sequence[Numbers],
    target: NDArray[np.int64],
    held: NDArray[np.bool_],
    nameable: Sequence[int],
    hidden: Sequence[tuple[int, ...]],
    weights: Numbers,
) -> Novelty:
    """Some classes are left out at a time; the regression tells their held-out things from the others'.

    `nameable`: the leaves that are classes of things. `weights`: how much each vote counts.
    """
    classes, rng = int(target.max()) + 1, np.random.default_rng(0)
    order = rng.permutation(nameable)
    size = max(1, round(_LEFT_OUT * len(order)))
    rows, news = [], []
    for fold in range(_FOLDS):
        out = np.isin(target, order[fold * size : (fold + 1) * size])
        known = ~held & ~out & (rng.random(len(target)) < _ENOUGH)
        voters = [
            classifier(f[known], target[known], classes, h, seed=seed, rounds=_ROUNDS)
            for seed, (f, h) in enumerate(zip(shown_to_voters(features), hidden, strict=True))
        ]
        judged = held & np.isin(target, nameable)
        seen = [f[judged] for f in features]
        votes = ballots(voters, seen)
        pooled = pool(votes, weights)
        rows.append(signs(space([f[known] for f in features], target[known], classes), seen, votes, pooled))
        news.append(out[judged])
    told, new = np.concatenate(rows), np.concatenate(news)
    scale = told.std(axis=0)
    share = new.mean()
    regression = LogisticRegression(
        class_weight={True: _SHARE / share, False: (1.0 - _SHARE) / (1.0 - share)}, max_iter=1000
    ).fit(told / scale, new)
    whole = space([f[~held] for f in features], target[~held], classes)
    fitted = np.append(regression.coef_[0] / scale, regression.intercept_)
    return Novelty(whole.mean, whole.axes, whole.centres, fitted)
