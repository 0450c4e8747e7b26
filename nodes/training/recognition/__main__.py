"""Train object recognition on renderings: `python -m semmap.nodes.training.recognition`."""

from __future__ import annotations

import argparse
import time
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from semmap.nodes.perception_node.recognition.features import SORTS
from semmap.nodes.perception_node.recognition.perceptron import Perceptron
from semmap.nodes.perception_node.recognition.recognition_model import (
    CLUTTER,
    SHIPPED,
    UNKNOWN,
    RecognitionModel,
    save,
)
from semmap.nodes.perception_node.recognition.sides import SIZE_FEATURES
from semmap.nodes.perception_node.recognition.vote import (
    expected_sizes,
    log_votes,
    pool_votes,
    vote,
    voter_inputs,
)
from semmap.nodes.sim_node.models.model_table import MODELS
from semmap.nodes.training.recognition.fitting import Numbers, classifier, regressor
from semmap.nodes.training.recognition.gathering import Gathered, gather
from semmap.nodes.training.recognition.gradient_descent import Recipe
from semmap.nodes.training.recognition.learn_familiar import learn_familiar
from semmap.nodes.training.recognition.learn_joining import learn_joining
from semmap.nodes.training.recognition.learn_open_set import LabelledSamples, learn_novelty
from semmap.nodes.training.recognition.natural_colours import unnatural
from semmap.nodes.training.recognition.samples import NOTHING, Samples
from semmap.nodes.training.scenes.families.table import FAMILIES
from semmap.nodes.training.scenes.simulated_scenes import DISTRACTOR, foreign_class
from semmap.nodes.training.segmentation.fit import trees_of
from semmap.nodes.training.taxonomy import class_of_models, hierarchy

_HELD_OUT = 5
_ONE_SORT = Recipe((256,), rounds=12, dropped=(0.1, 0.3))
_ALL = Recipe((512, 256), rounds=12, dropped=(0.1, 0.3))
_FAMILIAR = Recipe((512, 256), rounds=24, dropped=(0.05, 0.2))
_COLOUR = Recipe((64,), dropped=(0.1, 0.1))
_RECIPES = (_ONE_SORT, _ONE_SORT, _COLOUR, _ONE_SORT, _ONE_SORT, _ALL, _ALL, _ALL)
"""The training parameters of each of `VOTERS`."""

_SIDES = Recipe((128, 64), rounds=60, decay=1e-4)
_MOST_SIDES = 60_000  # things teach where sides are
_FARTHEST = 1.0
"""Sides with a larger error, relative to the object's size, count as unseen."""


def learn(
    gathered: Gathered, *, without: Collection[str] = (), unseen: Collection[str] = ()
) -> RecognitionModel:
    """Train on four scenes of five, calibrate on the fifth.

    Classes in `without`, and foreign things whose names are in `unseen`, are left out altogether.
    """
    class_of = classes_of(gathered)
    left_out = [
        kind
        for kind, name in class_of.items()
        if name in without or ((of := foreign_class(kind)) is not None and of[0] in unseen)
    ]
    things, own = (s[~np.isin(s.kind, left_out)] for s in (gathered.things, gathered.own))
    samples = things[~unnatural(things, own)]
    names = np.array([class_of[kind] for kind in samples.kind])
    pairs = gathered.pairs[np.asarray(~np.isin(gathered.pairs.kinds, left_out).any(axis=1))]
    classes, ancestors = tuple(sorted(set(names.tolist()))), hierarchy()
    target = np.searchsorted(classes, names)
    held = samples.scene % _HELD_OUT == 0
    features = [getattr(samples, name) for name in SORTS]
    voters = tuple(
        classifier(f[~held], target[~held], len(classes), recipe, seed=seed)
        for seed, (f, recipe) in enumerate(zip(voter_inputs(features), _RECIPES, strict=True))
    )
    weights = _calibrated(voters, [f[held] for f in features], target[held])
    labelled = LabelledSamples(features, target, strangers(samples.kind), held, classes, ancestors)
    novelty = learn_novelty(labelled, _RECIPES, weights)
    familiar = _familiar(things[things.scene % _HELD_OUT != 0], own, class_of, classes)
    sizes = _typical_sizes(samples, target, len(classes))
    expected = expected_sizes(vote(voters, weights, features), sizes)
    learnt = RecognitionModel(
        classes=classes,
        ancestors=ancestors,
        sizes_m=sizes,
        sideways=_sideways(samples, target, len(classes)),
        voters=voters,
        weights=weights,
        familiar=familiar,
        novelty=novelty,
        joining=trees_of([], 0.0),  # is learnt last, from what all else says
        sides=_sides(samples, expected),
        story=f"{len(samples)} segments, {len(pairs.one)} pairs, {len(classes)} leaves; "
        "rendered from the model library, 2 cameras",
    )
    return replace(learnt, joining=learn_joining(learnt, pairs))


def _familiar(
    things: Samples, own: Samples, class_of: Mapping[str, str], classes: Sequence[str]
) -> Perceptron:
    """Train the recogniser of our own models."""
    seen = Samples.joined([things, own])
    leaf = np.searchsorted(classes, [class_of[kind] for kind in seen.kind])
    leaf = np.where(seen.as_modelled, leaf, len(classes))
    return learn_familiar([getattr(seen, name) for name in SORTS], leaf, len(classes), _FAMILIAR)


def classes_of(gathered: Gathered) -> dict[str, str]:
    """Return the class of each kind in the samples and pairs."""
    class_of = class_of_models(MODELS) | {DISTRACTOR: UNKNOWN, NOTHING: CLUTTER}
    for kind in {*gathered.things.kind.tolist(), *gathered.pairs.kinds.ravel().tolist()}:
        if (foreign := foreign_class(kind)) is not None:
            class_of[kind] = foreign[1] or UNKNOWN
    return class_of


def strangers(kind: NDArray[np.str_]) -> NDArray[np.int64]:
    """Return (N,) numbers of foreign things by kind (N,); -1 for our own."""
    kinds, which = np.unique(kind, return_inverse=True)
    own = {family.kind for family in FAMILIES}
    foreign = np.array([foreign_class(kind) is not None and kind not in own for kind in kinds])
    number = np.where(foreign, np.cumsum(foreign) - 1, -1)
    return np.asarray(number[which])


def _calibrated(
    voters: Sequence[Perceptron], features: Sequence[Numbers], target: NDArray[np.int64]
) -> Numbers:
    """Return the weights of the votes that maximise the likelihood of held-out scenes."""
    votes = log_votes(voters, features)
    rows = np.arange(len(target))

    def surprise(weights: Numbers) -> float:
        return float(-pool_votes(votes, weights)[rows, target].mean())

    return np.asarray(minimize(surprise, np.full(len(voters), 0.3), method="Nelder-Mead").x)


def _typical_sizes(samples: Samples, target: NDArray[np.int64], count: int) -> Numbers:
    """Return (count, 3) geometric means of long side, short side and height [m] for each leaf class."""
    measured = np.isfinite(samples.size_m[:, 0])
    long_short = np.sort(samples.size_m[:, :2], axis=1)[:, ::-1]
    logs = np.log(np.column_stack([long_short, samples.size_m[:, 2]]))
    sizes = np.tile(np.exp(logs[measured].mean(axis=0)), (count, 1))
    for k in np.unique(target[measured]):
        sizes[k] = np.exp(logs[measured & (target == k)].mean(axis=0))
    return sizes


def _sideways(samples: Samples, target: NDArray[np.int64], count: int) -> NDArray[np.bool_]:
    longer = np.bincount(target, samples.size_m[:, 1] > samples.size_m[:, 0], count)
    return np.asarray(longer > 0.5 * np.bincount(target, minlength=count))


def _sides(samples: Samples, expected_m: Numbers) -> Perceptron:
    things = np.flatnonzero(np.isfinite(samples.shifts[:, 0]))
    things = things[:: -(-len(things) // _MOST_SIDES)]
    inputs = samples.sides[things].copy()
    inputs[..., SIZE_FEATURES] += np.log(expected_m[things])[:, None]
    shifts = samples.shifts[things].ravel()
    near = np.abs(shifts) < _FARTHEST
    return regressor(inputs.reshape(len(shifts), -1)[near], shifts[near], _SIDES)


def main() -> None:
    """Render, train, and write the shipped model."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--scenes", type=int, default=3300)
    parser.add_argument("--heaps", type=int, default=480, help="scenes for learning what belongs together")
    parser.add_argument("--ours", type=int, default=1200, help="scenes with our unmodified models only")
    parser.add_argument("--seed", type=int, default=101)
    parser.add_argument("--foreign", type=Path, help="a folder of foreign things for training")
    parser.add_argument("--parts", type=Path, help="a folder for the samples, from which training can resume")
    parser.add_argument("--out", type=Path, default=SHIPPED)
    options = parser.parse_args()
    started = time.perf_counter()
    gathered = gather(
        options.scenes, options.heaps, options.ours, options.seed, options.foreign, options.parts
    )
    print(f"{len(gathered.things)} segments after {time.perf_counter() - started:.0f} s")
    learnt = learn(gathered)
    save(learnt, options.out)
    print(f"{options.out} after {time.perf_counter() - started:.0f} s: {learnt.story}")


if __name__ == "__main__":
    main()
