"""Learn a similarity of two views: `python -m semmap.nodes.training.recognition.learn_similarity`.

Foreign things are excluded, as exemplars are not among the training objects either; they are for evaluation.
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.recognition.similarity import (
    SHIPPED,
    WIDTH,
    Similarity,
    pair_features,
    save,
)
from semmap.nodes.training.recognition.gathering import read_things
from semmap.nodes.training.recognition.samples import NOTHING, Samples
from semmap.nodes.training.scenes.simulated_scenes import foreign_class
from semmap.nodes.training.segmentation.examples import Rows
from semmap.nodes.training.segmentation.fit import fit

_TREES = 150
_LARGEST_M = 0.6
_VIEWS, _CUT, _DISTANCE, _STEEP = 14, 17, 15, 16  # columns of a view
_OTHER_EYE_M, _OTHER_EYE_SIN = 0.03, 0.02
"""Views from closer viewpoints count as the same image with different segmentations."""
_SAME, _SAME_PICTURE = 2, 1
_BESIDE, _ANYWHERE, _ALIKE, _ALIKE_BESIDE = 12, 12, 6, 4
"""The numbers of compared views per exemplar view: of the same thing, and of others (of the same scene, of
any scene, and the most similar of both)."""
_DRAWN = 160
_REACH = 4.0

Indices = NDArray[np.int64]


def learn_similarity(samples: Samples, kept: int, seed: int = 0) -> Similarity:
    """Train on `kept` exemplar views, each compared with views of the same thing and of other things."""
    small = np.exp(samples.geometry[:, :3]).max(axis=1) < _LARGEST_M
    own = np.array([foreign_class(kind) is None for kind in samples.kind])
    samples = samples[small & own]
    views = np.concatenate([samples.geometry, samples.shape, samples.colour], axis=1)
    if views.shape[1] != WIDTH:
        raise ValueError("the columns of similarity.py are not those of features.py")
    pairs = np.array(list(_pairs(samples, views, kept, np.random.default_rng(seed))))
    rows = Rows(pair_features(views[pairs[:, 0]], views[pairs[:, 1]]), pairs[:, 2] == 1, np.ones(len(pairs)))
    story = f"{len(pairs)} pairs of views, {rows.one.sum()} of the same thing"
    return Similarity(fit(rows, _TREES), story)


def _pairs(
    samples: Samples, views: NDArray[np.float64], kept: int, rng: np.random.Generator
) -> Iterator[tuple[int, int, int]]:
    """Yield an exemplar view, an observed one, and 1 if they show the same thing."""
    thing = _things(samples)
    of_thing, of_scene = defaultdict(list), defaultdict(list)
    for n, (one, scene) in enumerate(zip(thing, samples.scene, strict=True)):
        of_thing[one].append(n)
        of_scene[scene].append(n)
    place = np.clip((views - views.mean(axis=0)) / (views.std(axis=0) + 1e-6), -_REACH, _REACH)
    showable = (samples.kind != NOTHING) & (views[:, _VIEWS] == 0.0) & (views[:, _CUT] == 0.0)
    for a in rng.permutation(np.flatnonzero(showable))[:kept].tolist():
        same = np.array([n for n in of_thing[thing[a]] if n != a], np.int64)
        moved = _elsewhere(views, a, same)
        if not moved.any():
            continue
        beside = np.array([n for n in of_scene[samples.scene[a]] if thing[n] != thing[a]], np.int64)
        beside = beside[_elsewhere(views, a, beside)]  # else it may be a piece of the same thing
        drawn = rng.integers(len(views), size=_DRAWN)
        drawn = drawn[thing[drawn] != thing[a]]

        def most_alike(others: Indices, count: int) -> Indices:
            return others[np.argsort(np.square(place[others] - place[a]).sum(axis=1))[:count]]  # noqa: B023

        yield from ((a, int(b), 1) for b in rng.permutation(same[moved])[:_SAME])
        yield from ((a, int(b), 1) for b in rng.permutation(same[~moved])[:_SAME_PICTURE])
        for others in (
            rng.permutation(beside)[:_BESIDE],
            most_alike(beside, _ALIKE_BESIDE),
            drawn[:_ANYWHERE],
            most_alike(drawn, _ALIKE),
        ):
            yield from ((a, int(b), 0) for b in others)


def _elsewhere(views: NDArray[np.float64], a: int, others: Indices) -> NDArray[np.bool_]:
    """Return (N,) whether the viewpoint relative to the thing was different."""
    eye = np.abs(views[others] - views[a])
    return np.asarray((eye[:, _DISTANCE] > _OTHER_EYE_M) | (eye[:, _STEEP] > _OTHER_EYE_SIN))


def _things(samples: Samples) -> Indices:
    """Return (N,) numbers of the things; things of equal size in a scene share one. Clutter has its own."""
    names = [
        f"{scene}/{kind}/{size.tolist()}" if kind != NOTHING else f"clutter {n}"
        for n, (scene, kind, size) in enumerate(zip(samples.scene, samples.kind, samples.size_m, strict=True))
    ]
    return np.unique(names, return_inverse=True)[1]


def main() -> None:
    """Train on the samples of recognition, and write the shipped model."""
    parser = argparse.ArgumentParser(prog="python -m semmap.nodes.training.recognition.learn_similarity")
    parser.add_argument(
        "--parts", type=Path, required=True, help="samples of semmap.nodes.training.recognition"
    )
    parser.add_argument("--kept", type=int, default=4000, help="views that are compared with others")
    parser.add_argument("--out", type=Path, default=SHIPPED)
    options = parser.parse_args()
    likeness = learn_similarity(read_things(options.parts), options.kept)
    save(likeness, options.out)
    print(f"{options.out}: {likeness.story}")


if __name__ == "__main__":
    main()
