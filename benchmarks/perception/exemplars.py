"""Exemplars of third-party objects: shown once each, then searched for among nineteen others.

Each stands alone in one frame; perception is shown that, and nothing else. Then it is looked for on tables of
twenty things, elsewhere, turned otherwise, from another side. The classes that are shown are new ones.
"""

from __future__ import annotations

import math
import time
from collections import Counter, defaultdict
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.perception.foreign import matched
from benchmarks.perception.simulated import LEAST_PIXELS
from benchmarks.perception.table import Row
from semmap.nodes.perception_node.exemplar_views import ExemplarView, find_shown_thing, view_of_shown
from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.projection import cloud_of
from semmap.nodes.perception_node.pipeline import RecognitionModel, observe_views
from semmap.nodes.perception_node.recognition import similarity
from semmap.nodes.perception_node.recognition.exemplars import Exemplar, with_exemplars
from semmap.nodes.perception_node.views.segmented_view import segment_cloud
from semmap.nodes.training.scenes.foreign_things import ForeignThing, foreign_things
from semmap.nodes.training.scenes.placements import spread
from semmap.nodes.training.scenes.textured_scenes import Stood, Studio

TOGETHER = 20
_DRAWN = 26
"""The number of things that are tried for a table, the largest first."""
_AREA_M, _GAP_M = (0.95, 1.35), 0.02
_ALONE_M, _TOGETHER_M = (0.8, 1.2), (1.2, 1.8)
_SEED = 5

Frame = tuple[Cloud, NDArray[np.integer]]
"""Return the camera's frame, and object numbers (H, W), 0 for none."""


def measure(folder: Path, tables: int, learnt: RecognitionModel) -> list[Row]:
    """Show each thing, then search for all things on each table. Without things, no rows."""
    things = foreign_things(folder)
    if not things:
        print(f"{folder} holds no things: the rows of what is shown are left out")
        return []
    rng, studio = np.random.default_rng(_SEED), Studio()
    exemplars = _exemplars(things, learnt, studio, rng)
    likely = similarity.shipped()
    knowing_all = with_exemplars(learnt, list(exemplars.values()), likely)
    alone, together, took_s = Counter[str](), Counter[str](), defaultdict[str, float](float)
    for _ in range(tables):
        stood = _table(things, rng)
        cloud, mask = _frame(studio, stood, float(rng.uniform(*_TOGETHER_M)), rng)
        sight = segment_cloud(cloud)
        began_s = time.perf_counter()
        observe_views([sight], learnt)
        took_s["bare"] += time.perf_counter() - began_s
        began_s = time.perf_counter()
        every = observe_views([sight], knowing_all)
        took_s["all"] += time.perf_counter() - began_s
        seen = np.where(cloud.points_camera[..., 2] > 0, mask, 0)
        for n, one in enumerate(stood):
            if np.count_nonzero(mask == n + 1) < LEAST_PIXELS:
                continue
            name = one.thing.name
            lesson = exemplars.get(name)
            alone["asked"] += 1
            if lesson is None:
                continue
            found = observe_views([sight], with_exemplars(learnt, [lesson], likely))
            for tally, look in ((alone, found), (together, every)):
                said = [observation.class_ for observation in look.observations.observations]
                of = matched(seen, look.labels[0], len(stood), len(said))[n]
                tally["found"] += of is not None
                tally["right"] += of is not None and said[of] == name
                own = _pieces(seen == n + 1, look.labels[0])
                tally["false"] += sum(class_ == name for m, class_ in enumerate(said) if m not in (of, *own))
    asked = max(1, alone["asked"])
    return [
        Row("shown once, recognised among 20", alone["right"] / asked, "", 0.85, 0.95),
        Row("shown once: found at all", alone["found"] / asked),
        Row("shown once: others called so, a look", alone["false"] / asked, less=True),
        Row(f"all {len(exemplars)} shown at once: recognised", together["right"] / asked),
        Row(f"all {len(exemplars)} shown at once: time of a look", took_s["all"] / took_s["bare"], less=True),
    ]


def _pieces(thing: NDArray[np.bool_], labels: NDArray[np.int32]) -> list[int]:
    """Return the objects, from 0, that are more than half on a thing (H, W)."""
    total, on = np.bincount(labels.ravel()), np.bincount(labels[thing], minlength=int(labels.max()) + 1)
    return [int(m) - 1 for m in np.flatnonzero(on > 0.5 * total) if m]


def _exemplars(
    things: Sequence[ForeignThing], learnt: RecognitionModel, studio: Studio, rng: np.random.Generator
) -> dict[str, Exemplar]:
    """Return the views of each thing in one frame, none for things that were not detected."""
    found = {}
    for number, thing in enumerate(things, 1):
        x, y, yaw = rng.uniform(-0.15, 0.15), rng.uniform(-0.15, 0.15), rng.uniform(-math.pi, math.pi)
        stood = [Stood(thing, float(x), float(y), _height(rng), float(yaw))]
        cloud, _ = _frame(studio, stood, float(rng.uniform(*_ALONE_M)), rng)
        shown = find_shown_thing(cloud, learnt)
        if shown is None:
            print(f"{thing.name} is not found where it stands alone")
            continue
        found[thing.name] = exemplar_of(number, thing.name, view_of_shown(shown, cloud, learnt))
    return found


def exemplar_of(number: int, name: str, view: ExemplarView) -> Exemplar:
    """Return an exemplar of one view, of a class with this name."""
    return Exemplar(number, name, (), view.features[None], view.size_m, "", 0, view.image[None])


def _table(things: Sequence[ForeignThing], rng: np.random.Generator) -> list[Stood]:
    drawn = [things[int(n)] for n in rng.permutation(len(things))[:_DRAWN]]
    drawn.sort(key=lambda thing: -thing.size_m[0] * thing.size_m[1])
    places, z = spread([thing.size_m for thing in drawn], _AREA_M, _GAP_M, rng), _height(rng)
    pairs = zip(drawn, places, strict=True)
    return [Stood(t, at[0], at[1], z, at[4]) for t, at in pairs if at is not None][:TOGETHER]


def _height(rng: np.random.Generator) -> float:
    return float(rng.uniform(0.5, 0.9))


def _frame(studio: Studio, stood: Sequence[Stood], distance_m: float, rng: np.random.Generator) -> Frame:
    view, rgb, depth, mask = studio.shoot(stood, distance_m, rng)
    return cloud_of(depth, rgb, view.intrinsics, view.map_from_camera), mask
