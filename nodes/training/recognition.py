"""Learn to recognise things from renderings of the model library: `python -m nodes.training.recognition`."""

from __future__ import annotations

import argparse
import time
from collections.abc import Collection, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from sklearn.neural_network import MLPClassifier, MLPRegressor

from nodes.perception_node.recognition.learnt import CLUTTER, SHIPPED, UNKNOWN, Learnt, save
from nodes.perception_node.recognition.perceptron import Perceptron, log_softmax
from nodes.perception_node.recognition.recognise import expected_sizes
from nodes.perception_node.recognition.vote import vote
from nodes.sim_node.models.table import MODELS
from nodes.training import samples as sampling
from nodes.training.arranging import training_scenes
from nodes.training.samples import NOTHING, Samples
from nodes.training.scenes import STRANGE, Stage
from nodes.training.taxonomy import class_of_models, hierarchy

SURE = 0.6
_HELD_OUT = 5
_HIDDEN = {"geometry": (96,), "shape": (96,), "colour": (64,)}


def gather(scenes: int, seed: int) -> Samples:
    """Samples from so many simulated scenes."""
    stage, rng = Stage(), np.random.default_rng(seed)
    found = []
    for number, (items, background, views) in enumerate(training_scenes(scenes, rng)):
        bodies = stage.show(items)
        stage.paint({"floor": tuple(rng.uniform(0.2, 0.9, 3).tolist())}, float(rng.uniform(0.25, 0.45)))
        shot = stage.shoot(bodies, views, rng)
        samples = sampling.samples_of(shot, items, number, background)
        if samples is not None:
            found.append(samples)
    return sampling.joined(found)


def learn(samples: Samples, *, without: Collection[str] = (), seed: int = 0) -> Learnt:
    """Train on four scenes of five, calibrate on the fifth; classes in `without` are left out altogether."""
    class_of = class_of_models(MODELS) | {STRANGE: UNKNOWN, NOTHING: CLUTTER}
    names = np.array([class_of[kind] for kind in samples.kind])
    known = ~np.isin(names, list(without))
    samples, names = samples[known], names[known]
    classes = tuple(sorted(set(names.tolist())))
    target = np.searchsorted(classes, names)
    held = samples.scene % _HELD_OUT == 0
    voters = tuple(
        _classifier(getattr(samples, name)[~held], target[~held], len(classes), hidden, seed)
        for name, hidden in _HIDDEN.items()
    )
    features = [getattr(samples, name) for name in _HIDDEN]
    weights = _calibrated(voters, [f[held] for f in features], target[held])
    sizes = _typical_sizes(samples, target, len(classes))
    learnt = Learnt(
        classes=classes,
        ancestors={name: above for name, above in hierarchy().items() if _relevant(name, classes)},
        sizes_m=sizes,
        sideways=_sideways(samples, target, len(classes)),
        voters=voters,
        weights=weights,
        sides=Perceptron(np.zeros(1), np.ones(1), (), ()),
        sure=SURE,
        story="",
    )
    expected = expected_sizes(vote(learnt, features), learnt)
    story = f"{len(samples)} segments of {samples.scene.max() + 1} simulated scenes, {len(classes)} classes"
    import dataclasses

    return dataclasses.replace(learnt, sides=_sides(samples, expected, seed), story=story)


def _relevant(name: str, classes: Sequence[str]) -> bool:
    return True


def _classifier(
    inputs: NDArray[np.float64], target: NDArray[np.int64], count: int, hidden: tuple[int, ...], seed: int
) -> Perceptron:
    mean, scale = inputs.mean(axis=0), inputs.std(axis=0) + 1e-6
    machine = MLPClassifier(
        hidden,
        alpha=1e-4,
        batch_size=256,
        learning_rate_init=2e-3,
        max_iter=40,
        random_state=seed,
        tol=0.0,
        n_iter_no_change=1000,
    )
    import warnings

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        machine.fit(np.clip((inputs - mean) / scale, -6.0, 6.0), target)
    # every class must have been seen in training: rows for those that were not get a low bias
    last, bias = np.zeros((hidden[-1], count)), np.full(count, -12.0)
    last[:, machine.classes_], bias[machine.classes_] = machine.coefs_[-1], machine.intercepts_[-1]
    return Perceptron(mean, scale, (*machine.coefs_[:-1], last), (*machine.intercepts_[:-1], bias))


def _calibrated(
    voters: Sequence[Perceptron], features: Sequence[NDArray[np.float64]], target: NDArray[np.int64]
) -> NDArray[np.float64]:
    """The weights of the votes that make the truth of held-out scenes likeliest."""
    votes = np.array([log_softmax(voter(seen)) for voter, seen in zip(voters, features, strict=True)])
    rows = np.arange(len(target))

    def surprise(weights: NDArray[np.float64]) -> float:
        return float(-log_softmax(np.tensordot(weights, votes, axes=1))[rows, target].mean())

    return np.asarray(minimize(surprise, np.full(len(voters), 0.6), method="Nelder-Mead").x)


def _typical_sizes(samples: Samples, target: NDArray[np.int64], count: int) -> NDArray[np.float64]:
    measured = np.isfinite(samples.size_m[:, 0])
    sizes = np.full((count, 3), 0.15)
    for k in np.unique(target[measured]):
        own = samples.size_m[measured & (target == k)]
        own = np.column_stack([own[:, :2].max(axis=1), own[:, :2].min(axis=1), own[:, 2]])
        sizes[k] = np.exp(np.log(own).mean(axis=0))
    return sizes


def _sideways(samples: Samples, target: NDArray[np.int64], count: int) -> NDArray[np.bool_]:
    longer = samples.size_m[:, 1] > samples.size_m[:, 0]
    return np.array(
        [bool(longer[target == k].mean() > 0.5) if (target == k).any() else False for k in range(count)]
    )


def _sides(samples: Samples, expected_m: NDArray[np.float64], seed: int) -> Perceptron:
    things = np.isfinite(samples.shifts[:, 0])
    inputs = samples.sides[things].copy()
    inputs[..., -3:] += np.log(expected_m[things])[:, None]
    inputs, shifts = inputs.reshape(-1, inputs.shape[-1]), samples.shifts[things].ravel()
    good = np.abs(shifts) < 1.0
    mean, scale = inputs.mean(axis=0), inputs.std(axis=0) + 1e-6
    machine = MLPRegressor(
        hidden_layer_sizes=(64, 32),
        batch_size=512,
        max_iter=40,
        random_state=seed,
        tol=0.0,
        n_iter_no_change=1000,
    )
    import warnings

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        machine.fit(np.clip((inputs[good] - mean) / scale, -6.0, 6.0), shifts[good])
    return Perceptron(mean, scale, tuple(machine.coefs_), tuple(machine.intercepts_))


def main() -> None:
    """Render, learn, and write what ships."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--scenes", type=int, default=1500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--samples", type=Path, help="keep the samples there, or take them from there")
    parser.add_argument("--out", type=Path, default=SHIPPED)
    options = parser.parse_args()
    started = time.perf_counter()
    if options.samples and options.samples.exists():
        samples = sampling.read(options.samples)
    else:
        samples = gather(options.scenes, options.seed)
        if options.samples:
            sampling.write(samples, options.samples)
    print(f"{len(samples)} samples after {time.perf_counter() - started:.0f} s")
    learnt = learn(samples)
    save(learnt, options.out)
    print(f"{options.out} after {time.perf_counter() - started:.0f} s: {learnt.story}")


if __name__ == "__main__":
    main()
