"""Training of segmentation from scenes."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from semmap.nodes.perception_node.segmentation.trees import Trees
from semmap.nodes.sim_node.vision.camera import Eye
from semmap.nodes.training.segmentation.examples import Example, Rows, example, joined, own_way, right_way
from semmap.nodes.training.segmentation.fit import fit
from semmap.nodes.training.segmentation.piles import pile
from semmap.nodes.training.segmentation.recorded_scenes import Scene, mirrored

_MADE_ROWS = 40_000
_RECORDED_WEIGHT = 2.0


class Lessons(NamedTuple):
    """The training data: rows of generated scenes, and of each recorded scene with its name."""

    made: Rows
    recorded: tuple[tuple[str, Rows], ...]


def made_up(count: int, rng: np.random.Generator) -> list[Example]:
    """Render piles and return their pairs of patches."""
    eye = Eye()
    return [example(*pile(rng, eye)) for _ in range(count)]


def lessons(made: Iterable[Example], scenes: Iterable[Scene], rng: np.random.Generator) -> Lessons:
    """Return the pairs of generated and of recorded scenes.

    Each scene contributes the pairs of a correct segmentation, and those that a model trained on generated
    scenes encounters. So the rows of a recorded scene do not depend on other recorded scenes.
    """
    made = list(made)
    right = _some(joined([right_way(one, rng) for one in made]), _MADE_ROWS, rng)
    novice = fit(right)
    own = _some(joined([own_way(one, novice.probability) for one in made]), _MADE_ROWS // 2, rng)
    recorded = []
    for scene in scenes:
        rows = []
        for way in (scene, mirrored(scene)) if scene.cloud.organised else (scene,):
            one = example(way.cloud, way.truth)
            rows += [right_way(one, rng), right_way(one, rng), own_way(one, novice.probability)]
        recorded.append((scene.name, joined(rows)))
    return Lessons(joined([right, own]), tuple(recorded))


def learn(of: Lessons, without: frozenset[str] = frozenset()) -> Trees:
    """Train a model on all data except the recorded scenes `without`."""
    heard = [rows for name, rows in of.recorded if name not in without]
    counted = [rows._replace(weight=rows.weight * _RECORDED_WEIGHT) for rows in heard]
    return fit(joined([of.made, *counted]))


def _some(rows: Rows, count: int, rng: np.random.Generator) -> Rows:
    chosen = rng.permutation(len(rows.one))[:count]
    return Rows(rows.features[chosen], rows.one[chosen], rows.weight[chosen])
