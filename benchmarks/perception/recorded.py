"""Segmentation of real Kinect scenes by models that were not trained on them."""

from __future__ import annotations

import os
import re
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from benchmarks.perception.table import Row
from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.segmentation import segment
from semmap.nodes.perception_node.segmentation.merge_model import MergeModel, shipped
from semmap.nodes.perception_node.segmentation.merging import Judge
from semmap.nodes.training.segmentation.recorded_scenes import Scene, read_scenes
from semmap.nodes.training.segmentation.teach import Lessons, learn, lessons, made_up

IOU, LEAST_POINTS = 0.5, 400
"""The minimum overlap of a matching segment, and the minimum size of objects that are counted."""

_FOLDS = 6
_REPEATS = 3
_GROUPS = {
    "learn": {"boxes": 17, "stacked": 25, "occluded": 33, "cylinders": 45},
    "test": {"boxes": 16, "stacked": 24, "occluded": 31, "cylinders": 43, "mixed": 55, "complex": 66},
}
"""The last scene number of each group."""

Labels = NDArray[np.int32]


class Counts(NamedTuple):
    """Counts over scenes: objects, segments, and matching pairs."""

    objects: int = 0
    found: int = 0
    matched: int = 0

    @property
    def f1(self) -> float:
        """The harmonic mean of precision and recall."""
        return 2 * self.matched / max(1, self.objects + self.found)

    def plus(self, other: Counts) -> Counts:
        """Both together."""
        return Counts(self.objects + other.objects, self.found + other.found, self.matched + other.matched)


def data_folder() -> Path:
    """Return the folder of recorded scenes: `mosd/` in SEMMAP_DATA."""
    return Path(os.environ.get("SEMMAP_DATA") or "../shared/data") / "mosd"


def group_of(name: str) -> str:
    """Return the group of a scene by its file name."""
    found = re.fullmatch(r"(learn|test)(\d+)", name)
    if found is None:
        return "other"
    ends = _GROUPS[found[1]]
    return next((group for group, end in ends.items() if int(found[2]) < end), "other")


def score(scene: Scene, labels: Labels) -> Counts:
    """Match segments (H, W) to objects one to one, so that the overlaps are largest in sum."""
    truth, labels = scene.truth[scene.valid], labels[scene.valid]
    shape = (int(truth.max(initial=0)) + 1, int(labels.max(initial=0)) + 1)
    both = np.bincount(truth * shape[1] + labels, minlength=shape[0] * shape[1]).reshape(shape)
    objects, segments = both.sum(axis=1), both.sum(axis=0)
    iou = (both / np.maximum(objects[:, None] + segments - both, 1))[1:, 1:]
    iou = iou[objects[1:] >= LEAST_POINTS][:, segments[1:] >= LEAST_POINTS]
    matched = iou[linear_sum_assignment(-iou)] > IOU
    return Counts(iou.shape[0], iou.shape[1], int(matched.sum()))


def by_group(scenes: Iterable[Scene], segments: Callable[[Scene], Labels]) -> dict[str, Counts]:
    """Return the counts of each group of scenes, and of "all"."""
    totals: dict[str, Counts] = {}
    for scene in scenes:
        counts = score(scene, segments(scene))
        for group in (group_of(scene.name), "all"):
            totals[group] = totals.get(group, Counts()).plus(counts)
    return totals


def measure(folder: Path, piles: int) -> list[Row]:
    """Evaluate by cross-validation, without groups, and on renderings only; with baselines and time."""
    scenes = list(read_scenes(folder))
    if not scenes:
        print(f"no recorded scenes in {folder}: set SEMMAP_DATA, or give --recorded")
        return []
    rng = np.random.default_rng(1)
    heard = lessons(made_up(piles, rng), scenes, rng)
    names = [scene.name for scene in scenes]
    groups = sorted({group_of(name) for name in names})
    crossed = held_out(scenes, heard, [names[start::_FOLDS] for start in range(_FOLDS)])
    strange = held_out(scenes, heard, [[n for n in names if group_of(n) == group] for group in groups])
    rendered = held_out(scenes, heard, [names])
    rows = [
        Row("real scenes: objects, F1, cross-validation over scenes", crossed["all"].f1, "", 0.95, 0.98),
        *(Row(f"the same, {group}", crossed[group].f1) for group in groups),
        Row("the same, leave-one-group-out", strange["all"].f1, "", 0.85, 0.92),
        *(Row(f"the same, {group} left out", strange[group].f1) for group in groups),
        Row("the same, learnt from renderings alone", rendered["all"].f1),
    ]
    for what, segments in (("plane and DBSCAN", clustered), ("chance: patches merged by lot", random_labels)):
        rows.append(Row(f"real scenes: F1, {what}", by_group(scenes, segments)["all"].f1))
    return rows + times(scenes)


def times(scenes: Iterable[Scene]) -> list[Row]:
    """Measure wall time and CPU time, which depends less on other load."""
    clock, cpu = np.transpose([_milliseconds(scene.cloud) for scene in scenes])
    return [
        Row("real scenes: segmentation, median", float(np.median(clock)), "ms", 40, 20, less=True),
        Row("real scenes: segmentation, worst", float(clock.max()), "ms", 100, 50, less=True),
        Row("the same, CPU time, median", float(np.median(cpu)), "ms"),
        Row("the same, CPU time, worst", float(cpu.max()), "ms"),
    ]


def held_out(scenes: Sequence[Scene], heard: Lessons, folds: Iterable[Sequence[str]]) -> Mapping[str, Counts]:
    """Segment each fold's scenes by a model trained on all the others."""
    totals: dict[str, Counts] = {}
    for fold in folds:
        judge = MergeModel(learn(heard, frozenset(fold)), "")
        tested = (scene for scene in scenes if scene.name in fold)
        for group, counts in by_group(tested, partial(_segmented, judge=judge)).items():
            totals[group] = totals.get(group, Counts()).plus(counts)
    return totals


def _segmented(scene: Scene, judge: Judge) -> Labels:
    return segment(scene.cloud, judge).labels


def random_labels(scene: Scene) -> Labels:
    """Merge our patches at random."""
    rng = np.random.default_rng(0)
    return _segmented(scene, lambda known, a, b: rng.random(len(a), dtype=np.float32))


def clustered(scene: Scene) -> Labels:
    """Segment by Open3D's plane and DBSCAN above it: a third of the pixels, 2 cm, 10 neighbours."""
    import open3d

    every = 3
    thin = scene.cloud.points_camera[::every, ::every]
    seen = np.isfinite(thin[..., 2])
    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(thin[seen].astype(float)))
    (a, b, c, d), _ = cloud.segment_plane(0.01, 3, 1000)
    side = np.sign(d) or 1.0  # the camera's
    height = (thin @ np.array([a, b, c]) + d) * side
    out = seen & (height > 0.01) & (height < 0.5)
    things = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(thin[out].astype(float)))
    small = np.zeros(out.shape, np.int32)
    small[out] = np.asarray(things.cluster_dbscan(0.02, 10), np.int32) + 1
    height_px, width_px = scene.truth.shape
    return small.repeat(every, axis=0)[:height_px].repeat(every, axis=1)[:, :width_px]


def _milliseconds(cloud: Cloud) -> tuple[float, float]:
    """Return the median wall time and CPU time of several runs."""
    shipped()  # loading the model is not part of the measurement
    taken = []
    for _ in range(_REPEATS):
        started = time.perf_counter(), time.thread_time()
        segment(cloud)
        taken.append((time.perf_counter() - started[0], time.thread_time() - started[1]))
    clock, cpu = 1e3 * np.median(taken, axis=0)
    return float(clock), float(cpu)
