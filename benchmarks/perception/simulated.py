"""Perception of simulated rooms: detection, classification, pose and size errors."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from statistics import median

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from benchmarks.perception.baseline import clustered, guessed
from benchmarks.perception.rooms import Room, rooms
from benchmarks.perception.table import Row
from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.pipeline import FrameResult, observe_clouds
from semmap.nodes.perception_node.recognition.recognition_model import RecognitionModel
from semmap.nodes.sim_node.models.model_table import MODELS
from semmap.nodes.training.scenes.paint import Paint, black, one_colour
from semmap.nodes.training.scenes.simulated_scenes import Item, Shot, Stage
from semmap.nodes.training.taxonomy import class_of_models
from semmap.schemas.entities import Pose, Size
from semmap.schemas.perception import Observation

LEAST_PIXELS = 150
"""The minimum number of visible pixels, in all cameras together, of an expected thing."""

SAME_IOU = 0.5
SMALL_M = 0.3
_SEEDS = {False: 20271, True: 20272}

Perceive = Callable[[Sequence[Cloud]], FrameResult]


@dataclass
class Score:
    """Sums over rooms. Errors are those of detected, completely visible things."""

    asked: int = 0
    found: int = 0
    said: int = 0
    right: int = 0
    exact: int = 0
    position_m: list[float] = field(default_factory=list)
    size_m: list[float] = field(default_factory=list)
    wrong: list[tuple[str, str]] = field(default_factory=list)

    def f1(self, hits: int) -> float:
        """Return the F1 score from hits, expected and reported numbers."""
        return 2.0 * hits / max(1, self.asked + self.said)


class Judge:
    """The ground truth: `class_of` a model, and the superclasses of a class (without `Object`)."""

    def __init__(self, class_of: Mapping[str, str], above: Mapping[str, Sequence[str]]) -> None:
        self._class_of = class_of
        self._above = {name: set(found) - {"Object"} for name, found in above.items()}

    def class_of(self, item: Item) -> str:
        """Return the class of its model."""
        return self._class_of[item.kind]

    def exact(self, item: Item, said: str) -> bool:
        """Return whether the class is exact."""
        return said == self._class_of[item.kind]

    def right(self, item: Item, said: str) -> bool:
        """Return whether it is the class or a superclass below `Object`."""
        return self.exact(item, said) or said in self._above[self._class_of[item.kind]]


def shots(
    rooms: Iterable[Room], seed: int, paint: Callable[[np.random.Generator], Paint] | None = None
) -> Iterable[tuple[Room, Shot]]:
    """Render the rooms with painted things."""
    stage, rng = Stage(), np.random.default_rng(seed)
    for room in rooms:
        bodies = stage.show(room.items)
        stage.paint({"floor": room.floor}, 0.35)
        paints = {item.name: paint(rng) for item in room.items[1:]} if paint else {}
        yield room, stage.shoot(bodies, room.views, rng, paints)


@dataclass(frozen=True)
class Looks:
    """Yield the observations of each room, with the duration [s]."""

    looks: list[FrameResult]
    seconds: list[float]


def looked(photographed: Iterable[tuple[Room, Shot]], perceive: Perceive, *, cameras: int = 2) -> Looks:
    """Run perception on every room with so many of its cameras."""
    looks, seconds = [], []
    for _, shot in photographed:
        started = time.perf_counter()
        looks.append(perceive(shot.clouds[:cameras]))
        seconds.append(time.perf_counter() - started)
    return Looks(looks, seconds)


def score(
    photographed: Iterable[tuple[Room, Shot]],
    looks: Iterable[FrameResult],
    judge: Judge,
    *,
    of: Collection[str] = tuple(MODELS),
) -> Score:
    """Compare with the ground truth for things of the given models."""
    total = Score()
    for (room, shot), seen in zip(photographed, looks, strict=True):
        _count(total, room, shot, seen, judge, of)
    return total


def _count(
    score: Score, room: Room, shot: Shot, look: FrameResult, judge: Judge, of: Collection[str]
) -> None:
    items = {item.name: item for item in room.items}
    truth = [items[body.name] for body in shot.bodies]
    poses = [body.pose for body in shot.bodies]
    sizes = [body.size_m for body in shot.bodies]
    shared, pixels = overlap(shot, look)
    wanted = [n for n, item in enumerate(truth) if pixels[n] >= LEAST_PIXELS and item.kind in of]
    ignored = [n for n in range(len(truth)) if n not in wanted]
    said = [
        o for o in range(len(look.observations.observations)) if not (shared[ignored, o] > SAME_IOU).any()
    ]
    score.asked += len(wanted)
    score.said += len(said)
    iou = shared[np.ix_(wanted, said)]
    for row, column in zip(*linear_sum_assignment(-iou), strict=True):
        if iou[row, column] <= SAME_IOU:
            continue
        n, observation = wanted[row], look.observations.observations[said[column]]
        score.found += 1
        score.right += judge.right(truth[n], observation.class_)
        score.exact += judge.exact(truth[n], observation.class_)
        if not judge.right(truth[n], observation.class_):
            score.wrong.append((truth[n].kind, observation.class_))
        if observation.whole and max(sizes[n]) <= SMALL_M:
            score.position_m.append(position_error_m(observation, poses[n]))
            score.size_m.append(size_error_m(observation, sizes[n]))


def overlap(shot: Shot, look: FrameResult) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return intersection over union (bodies, observations) of pixels, and visible pixels per body."""
    rows, columns = len(shot.bodies) + 1, len(look.observations.observations) + 1
    both = np.zeros((rows, columns))
    for owner, label, cloud in zip(shot.owners, look.labels, shot.clouds, strict=False):
        seen = np.isfinite(cloud.points_camera[..., 2])
        both += np.bincount(owner[seen] * columns + label[seen], minlength=rows * columns).reshape(
            rows, columns
        )
    union = both.sum(axis=1, keepdims=True) + both.sum(axis=0, keepdims=True) - both
    return (both / np.maximum(union, 1))[1:, 1:], both.sum(axis=1)[1:].astype(int)


def position_error_m(observation: Observation, truth: Pose) -> float:
    """Return the distance of the bottom centres."""
    return float(np.linalg.norm(np.subtract(observation.pose.position_m, truth.position_m)))


def size_error_m(observation: Observation, truth: Size) -> float:
    """Return the mean error of the three extents; the horizontal axes can be swapped."""
    said, true = ([*sorted(size[:2]), size[2]] for size in (observation.size_m, truth))
    return float(np.abs(np.subtract(said, true)).mean())


def measure(scenes: int, learnt: RecognitionModel) -> list[Row]:
    """Return all figures for easy and crowded rooms."""
    judge = Judge(class_of_models(MODELS), learnt.ancestors)
    ours = partial(observe_clouds, learnt=learnt)
    rows: list[Row] = []
    for crowded, name, reach, aim in ((False, "easy", 0.98, 0.99), (True, "crowded, touching", 0.93, 0.95)):
        seen = list(shots(rooms(scenes, _SEEDS[crowded], crowded=crowded), seed=1))
        both, alone = looked(seen, ours), looked(seen, ours, cameras=1)
        two, one = score(seen, both.looks, judge), score(seen, alone.looks, judge)
        chance = score(seen, guessed(both.looks, learnt), judge)
        plain = score(seen, looked(seen, partial(clustered, learnt=learnt)).looks, judge)
        rows += [
            Row(f"{name}: detection F1", two.f1(two.found), "", reach, aim),
            Row(f"{name}: class F1 (right or an ancestor below Object)", two.f1(two.right), "", reach, aim),
            Row(f"{name}: class F1, exact", two.f1(two.exact)),
            Row(f"{name}: detection F1 from one camera", one.f1(one.found)),
            Row(f"{name}: class F1 from one camera", one.f1(one.right)),
            Row(f"{name}: class F1 by chance", chance.f1(chance.right)),
            Row(f"{name}: detection F1, planes + DBSCAN", plain.f1(plain.found)),
            Row(f"{name}: class F1, planes + DBSCAN", plain.f1(plain.right)),
        ]
        if not crowded:
            rows += [
                Row("position, small things, median, 1 camera", _mm(one.position_m), "mm", 7, 5, less=True),
                Row("position, small things, median, 2 cameras", _mm(two.position_m), "mm", 3, 2, less=True),
                Row("size, small things, median, 1 camera", _mm(one.size_m), "mm"),
                Row("size, small things, median, 2 cameras", _mm(two.size_m), "mm", 12, 8, less=True),
                Row(
                    "one 640x480 frame, whole pipeline, median",
                    1e3 * median(alone.seconds),
                    "ms",
                    120,
                    66,
                    less=True,
                ),
            ]
    return rows


def measure_painted(scenes: int, learnt: RecognitionModel) -> list[Row]:
    """Evaluate our models in easy rooms, all black, and each in one random colour."""
    judge = Judge(class_of_models(MODELS), learnt.ancestors)
    rows = []
    for name, paint, reach, aim in (
        ("black", black, 0.85, 0.95),
        ("in one random colour", one_colour, 0.92, 0.97),
    ):
        seen = list(shots(rooms(scenes, _SEEDS[False], crowded=False), seed=1, paint=paint))
        total = score(seen, looked(seen, partial(observe_clouds, learnt=learnt)).looks, judge)
        rows.append(Row(f"own models {name}: right", total.right / total.asked, "", reach, aim))
    return rows


def _mm(errors_m: Sequence[float]) -> float:
    return 1e3 * median(errors_m)
