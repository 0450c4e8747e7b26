"""Classification of third-party objects by cross-validation.

The things are divided into folds; each fold is classified by perception that was trained on the others.
Things that are excluded from training are classified by each of them. Frames are those of `foreign_frames`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from benchmarks.perception.simulated import LEAST_PIXELS, SAME_IOU
from benchmarks.perception.table import Row
from semmap.nodes.perception_node.input.projection import cloud_of
from semmap.nodes.perception_node.pipeline import RecognitionModel, observe_views
from semmap.nodes.perception_node.recognition.recognition_model import UNKNOWN
from semmap.nodes.perception_node.views.segmented_view import segment_cloud
from semmap.nodes.training.recognition.__main__ import learn
from semmap.nodes.training.recognition.gathering import Gathered, gather, read
from semmap.nodes.training.scenes.foreign_things import ForeignThing, foreign_things
from semmap.nodes.training.scenes.textured_scenes import Studio, distance_m, scenes

FOLDS = 4
_ALONE, _MIXED = 4, 60
_SEED = 1
_THIN_M = 0.025


def measure(folder: Path, samples: Path | None, training_scenes: int) -> list[Row]:
    """Train once per fold, then classify all things; `samples` saves the rendering."""
    things = foreign_things(folder)
    if not things:
        print(f"{folder} holds no things: the rows of foreign things are left out")
        return []
    dealt = folds(things)
    gathered = (
        read(samples)
        if samples
        else gather(training_scenes, training_scenes // 4, training_scenes // 3, seed=1, foreign=folder)
    )
    known, new = tallies(things, dealt, [_without(gathered, things, dealt, fold) for fold in range(FOLDS)])
    asked, asked_new = max(1, known.total()), max(1, new.total())
    right = known["exact"] + known["above"]
    return [
        Row("foreign things: reported", 1.0 - known["missed"] / asked, "", 0.96, 0.99),
        Row("foreign things: exact or a true ancestor", right / asked, "", 0.70, 0.85),
        Row("foreign things: exact", known["exact"] / asked),
        Row("foreign things: wrong names", known["wrong"] / asked, "", 0.06, 0.03, less=True),
        Row("of no class: reported", 1.0 - new["missed"] / asked_new, "", 0.93, 0.98),
        Row("of no class: said Object", new["exact"] / asked_new, "", 0.80, 0.90),
    ]


def folds(things: Sequence[ForeignThing]) -> dict[str, int]:
    """Return the fold of each thing by name; things of one class are in different folds."""
    in_order = sorted(
        things, key=lambda thing: (not thing.learnable, thing.new, thing.classes[0], thing.name)
    )
    return {thing.name: n % FOLDS for n, thing in enumerate(in_order)}


def _without(
    gathered: Gathered, things: Sequence[ForeignThing], dealt: dict[str, int], fold: int
) -> RecognitionModel:
    return learn(gathered, unseen=[thing.name for thing in things if dealt[thing.name] == fold])


def tallies(
    things: Sequence[ForeignThing], dealt: dict[str, int], learnt: Sequence[RecognitionModel]
) -> tuple[Counter[str], Counter[str]]:
    """Count the outcomes of things of known classes, from 2.5 cm in height, and of unknown ones."""
    rng, studio = np.random.default_rng(_SEED), Studio()
    known, new = Counter[str](), Counter[str]()
    for number, (_, stood) in enumerate(scenes(things, _ALONE, _MIXED, rng)):
        view, rgb, depth, mask = studio.shoot(stood, distance_m(number, rng), rng)
        sight = segment_cloud(cloud_of(depth, rgb, view.intrinsics, view.map_from_camera))
        seen = np.where(depth > 0, mask, 0)
        for fold in {dealt[one.thing.name] for one in stood}:
            found = observe_views([sight], learnt[fold])
            classes = [observation.class_ for observation in found.observations.observations]
            of = matched(seen, np.where(depth > 0, found.labels[0], 0), len(stood), len(classes))
            for n, one in enumerate(stood):
                if dealt[one.thing.name] != fold or (mask == n + 1).sum() < LEAST_PIXELS:
                    continue
                said = None if (i := of[n]) is None else classes[i]
                if one.thing.new:
                    new[outcome(said, (*one.thing.classes, UNKNOWN), learnt[fold])] += 1
                elif one.thing.size_m[2] >= _THIN_M:
                    known[outcome(said, one.thing.classes, learnt[fold])] += 1
    return known, new


def outcome(said: str | None, classes: Sequence[str], learnt: RecognitionModel) -> str:
    """Return `exact` for one of its classes, `above` for a superclass, `Object`, `wrong`, or `missed`."""
    if said is None:
        return "missed"
    if said in classes:
        return "exact"
    if said == UNKNOWN:
        return UNKNOWN
    return "above" if any(said in learnt.ancestors[of] for of in classes if of != UNKNOWN) else "wrong"


def matched(
    true: NDArray[np.integer], labels: NDArray[np.int32], things: int, objects: int
) -> list[int | None]:
    """Return for each thing of a mask (H, W), from 1, the object whose label covers it, from 0."""
    cells = np.bincount(
        (true.astype(np.int64) * (objects + 1) + labels).ravel(), minlength=(things + 1) * (objects + 1)
    ).reshape(things + 1, objects + 1)
    union = cells.sum(axis=1, keepdims=True) + cells.sum(axis=0, keepdims=True) - cells
    iou = (cells / np.maximum(union, 1))[1:, 1:]
    pairs = zip(*linear_sum_assignment(-iou), strict=True)
    of = {int(n): int(o) for n, o in pairs if iou[n, o] > SAME_IOU}
    return [of.get(n) for n in range(things)]
