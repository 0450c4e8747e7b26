"""Train the open-set decision (when to reject the votes) by holding out known classes and things."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from sklearn.discriminant_analysis import LinearDiscriminantAnalysis
from sklearn.linear_model import LogisticRegression

from semmap.nodes.perception_node.recognition.open_set import OpenSetDetector, open_set_features
from semmap.nodes.perception_node.recognition.recognition_model import CLUTTER, UNKNOWN
from semmap.nodes.perception_node.recognition.vote import choose_class, log_votes, pool_votes, voter_inputs
from semmap.nodes.training.recognition.fitting import Numbers, classifier
from semmap.nodes.training.recognition.gradient_descent import Recipe

_FOLDS = 4
_LEFT_OUT = 0.12
_ROUNDS = 6
_ENOUGH = 0.25
"""The share of the samples on which the voters of a fold are trained."""

_AXES = 30
_SURE, _CLEAR = 0.42, 2.0 / 3.0
"""The confidence from which a class counts as reported, and its share of that of a superclass, which is lower
than in perception, to get more errors."""
_NEW_CLASS, _NEW_THING, _FAR = 0.1, 0.4, 0.03
"""The assumed shares of encountered things: of an unknown class, of a known class but another make, and
unlike anything known. These are estimates."""
_FAR_OFF = (3.0, 40.0)
"""The distance of the latter from the mean in each feature, in standard deviations."""


@dataclass(frozen=True)
class LabelledSamples:
    """N samples with ground truth.

    `features`: per sort (N, its number of features). `target`: (N,) indices of `classes`. `stranger`: (N,)
    numbers of foreign things, -1 for our own. `held`: (N,) whether a sample is held out from training.
    """

    features: Sequence[Numbers]
    target: NDArray[np.int64]
    stranger: NDArray[np.int64]
    held: NDArray[np.bool_]
    classes: Sequence[str]
    ancestors: Mapping[str, Sequence[str]]

    def of(self, rows: NDArray[np.bool_]) -> list[Numbers]:
        """Return the features of some rows."""
        return [values[rows] for values in self.features]


def space(features: Sequence[Numbers], target: NDArray[np.int64], classes: int) -> OpenSetDetector:
    """Return the feature space without the regression: discriminant axes, scaled by the scatter."""
    together = np.concatenate(features, axis=1)
    mean = together.mean(axis=0)
    found = LinearDiscriminantAnalysis(solver="eigen", shrinkage=0.05, n_components=_AXES)
    several = np.bincount(target)[target] > 1  # one alone does not scatter
    found.fit((together - mean)[several], target[several])
    axes = found.scalings_[:, :_AXES]
    centres = np.full((classes, _AXES), 1e3)
    for k in np.unique(target):
        centres[k] = (together[target == k] - mean).mean(axis=0) @ axes
    return OpenSetDetector(mean, axes, centres, np.zeros(1))


def learn_novelty(labelled: LabelledSamples, recipes: Sequence[Recipe], weights: Numbers) -> OpenSetDetector:
    """Train with folds that leave out some classes and foreign things.

    The regression predicts where the votes misclassify things that they were not trained on; outliers always
    count as misclassified. `weights` are those of the votes.
    """
    things = np.flatnonzero([name not in (UNKNOWN, CLUTTER) for name in labelled.classes])
    rng = np.random.default_rng(0)
    order = rng.permutation(things)
    size = max(1, round(_LEFT_OUT * len(order)))
    rows, wrong, worth = [], [], []
    for fold in range(_FOLDS):
        new_class = np.isin(labelled.target, order[fold * size : (fold + 1) * size]) & (labelled.stranger < 0)
        new_thing = (labelled.stranger >= 0) & (labelled.stranger % _FOLDS == fold)
        drawn = rng.random(len(labelled.target)) < _ENOUGH
        known = ~labelled.held & ~new_class & ~new_thing & drawn
        voters = [
            classifier(
                f, labelled.target[known], len(labelled.classes), replace(recipe, rounds=_ROUNDS), seed=seed
            )
            for seed, (f, recipe) in enumerate(zip(voter_inputs(labelled.of(known)), recipes, strict=True))
        ]
        judged = drawn & (
            (labelled.held & np.isin(labelled.target, things) & (labelled.stranger < 0)) | new_thing
        )
        far = far_off(labelled.of(known), judged.sum() // 20, rng)
        seen = [np.concatenate(both) for both in zip(labelled.of(judged), far, strict=True)]
        votes = log_votes(voters, seen)
        pooled = pool_votes(votes, weights)
        place = space(labelled.of(known), labelled.target[known], len(labelled.classes))
        rows.append(open_set_features(place, seen, votes, pooled))
        is_far = np.arange(len(pooled)) >= judged.sum()
        wrong.append(np.append(_misnamed(pooled[~is_far], labelled, judged), is_far[is_far]))
        worth.append(_worth(new_class[judged], new_thing[judged], len(far[0])))
    seen_in_folds = np.concatenate(rows)
    scale = seen_in_folds.std(axis=0)
    regression = LogisticRegression(max_iter=1000)
    regression.fit(seen_in_folds / scale, np.concatenate(wrong), np.concatenate(worth))
    whole = space(labelled.of(~labelled.held), labelled.target[~labelled.held], len(labelled.classes))
    fitted = np.append(regression.coef_[0] / scale, regression.intercept_)
    return OpenSetDetector(whole.mean, whole.axes, whole.centres, fitted)


def far_off(features: Sequence[Numbers], count: int, rng: np.random.Generator) -> list[Numbers]:
    """Return features of `count` outliers per sort; a random share of the features is too large."""
    near, far = np.log(_FAR_OFF)
    away, above = np.exp(rng.uniform(near, far, (count, 1))), rng.random((count, 1))
    return [
        values.mean(axis=0)
        + values.std(axis=0) * np.where(rng.random((count, values.shape[1])) < above, away, -away)
        for values in features
    ]


def _worth(new_class: NDArray[np.bool_], new_thing: NDArray[np.bool_], far: int) -> Numbers:
    """Return (N + far,) sample weights that give the assumed shares."""
    sorts = (new_class, new_thing & ~new_class, ~new_class & ~new_thing)
    worth = np.zeros(len(new_class))
    for sort, share in zip(sorts, (_NEW_CLASS, _NEW_THING, 1.0 - _NEW_CLASS - _NEW_THING), strict=True):
        worth[sort] = share * len(new_class) / max(1, sort.sum())
    return np.append(worth, np.full(far, _FAR * len(new_class) / max(1, far)))


def _misnamed(pooled: Numbers, labelled: LabelledSamples, judged: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return (N,) whether the votes' class is neither the true class nor an ancestor of it."""
    found = []
    for chances, target in zip(np.exp(pooled), labelled.target[judged], strict=True):
        by_leaf = dict(zip(labelled.classes, chances.tolist(), strict=True))
        said, _ = choose_class(by_leaf, labelled.ancestors, _SURE, _CLEAR)
        true = labelled.classes[target]
        found.append(said != true and said not in labelled.ancestors.get(true, ()))
    return np.array(found)
