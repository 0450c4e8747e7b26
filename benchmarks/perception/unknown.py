"""Things of untrained classes: whether they are reported as `Object` or as a superclass."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.perception.rooms import THINGS, rooms
from benchmarks.perception.simulated import Judge, looked, score, shots
from benchmarks.perception.table import Row
from semmap.nodes.perception_node.pipeline import observe_clouds
from semmap.nodes.perception_node.recognition.recognition_model import UNKNOWN
from semmap.nodes.sim_node.models.model_table import MODELS
from semmap.nodes.training.recognition.__main__ import learn
from semmap.nodes.training.recognition.gathering import gather, read
from semmap.nodes.training.taxonomy import class_of_models

LEFT_OUT = 10
_SEED = 20263


def measure(scenes: int, samples: Path | None, training_scenes: int) -> list[Row]:
    """Train without ten random classes, then classify their things; `samples` saves the rendering."""
    class_of = class_of_models(MODELS)
    kinds = [str(kind) for kind in np.random.default_rng(_SEED).choice(THINGS, LEFT_OUT, replace=False)]
    learnt = learn(
        read(samples)
        if samples
        else gather(training_scenes, training_scenes // 4, training_scenes // 3, seed=1),
        without=[class_of[kind] for kind in kinds],
    )
    judge = Judge(class_of, learnt.ancestors)
    seen = list(shots(rooms(scenes, _SEED, crowded=False, things=kinds), seed=2))
    total = score(seen, looked(seen, partial(observe_clouds, learnt=learnt)).looks, judge, of=kinds)
    unnamed = sum(said == UNKNOWN for _, said in total.wrong)
    return [
        Row(
            "ten classes left out: Object or a true ancestor",
            (total.right + unnamed) / total.found,
            "",
            0.8,
            0.9,
        ),
        Row("ten classes left out: called Object", unnamed / total.found),
    ]
