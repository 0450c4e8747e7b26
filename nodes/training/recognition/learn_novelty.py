"""Learn to tell what is like nothing known, by leaving out classes that are known."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from sklearn.discriminant_analysis import LinearDiscriminantAnalysis
from sklearn.linear_model import LogisticRegression

from nodes.perception_node.recognition.novelty import Novelty, signs
from nodes.perception_node.recognition.vote import ballots, pool, shown_to_voters
from nodes.training.recognition.fitting import Numbers, classifier
from nodes.training.recognition.gradient_descent import Recipe

_FOLDS = 4
_LEFT_OUT = 0.12
_ROUNDS = 6
_ENOUGH = 0.25
"""The share of the samples that the voters of a fold learn from: signs need no more."""

_AXES = 30
_SHARE = 0.1
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
    recipes: Sequence[Recipe],
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
            classifier(f[known], target[known], classes, replace(recipe, rounds=_ROUNDS), seed=seed)
            for seed, (f, recipe) in enumerate(zip(shown_to_voters(features), recipes, strict=True))
        ]
        judged = held & np.isin(target, nameable)
        seen = [f[judged] for f in features]
        votes = ballots(voters, seen)
        pooled = pool(votes, weights)
        rows.append(signs(space([f[known] for f in features], target[known], classes), seen, votes, pooled))
        news.append(out[judged])
    told, new = np.concatenate(rows), np.concatenate(news)
    scale = told.std(axis=0)
    regression = LogisticRegression(class_weight="balanced", max_iter=1000).fit(told / scale, new)
    constant = regression.intercept_ + math.log(_SHARE / (1.0 - _SHARE))
    whole = space([f[~held] for f in features], target[~held], classes)
    fitted = np.append(regression.coef_[0] / scale, constant)
    return Novelty(whole.mean, whole.axes, whole.centres, fitted)
