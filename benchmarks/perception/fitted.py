"""Model fitting in simulated rooms: orientation errors and lost names."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache, partial
from statistics import median

import numpy as np
from scipy.optimize import linear_sum_assignment

from benchmarks.perception.rooms import Room, rooms
from benchmarks.perception.simulated import LEAST_PIXELS, SAME_IOU, Judge, looked, overlap, shots
from benchmarks.perception.table import Row
from semmap.nodes.perception_node.fitting.fit import Fit, angle_between
from semmap.nodes.perception_node.fitting.fit_observations import fit_of, points_of, with_fit, with_poses
from semmap.nodes.perception_node.fitting.model_surfaces import ClassSurfaces
from semmap.nodes.perception_node.fitting.model_surfaces import shipped as shipped_surfaces
from semmap.nodes.perception_node.pipeline import FrameResult, observe_clouds
from semmap.nodes.perception_node.recognition.recognition_model import RecognitionModel
from semmap.nodes.sim_node.models.library import build
from semmap.nodes.sim_node.models.model_table import MODELS
from semmap.nodes.sim_node.models.parts import rotation_matrix
from semmap.nodes.training.model_surfaces import surface_of
from semmap.nodes.training.scenes.simulated_scenes import Item, Shot
from semmap.nodes.training.taxonomy import class_of_models
from semmap.schemas.entities import Pose
from semmap.schemas.perception import Observation

_SEEDS = {False: 20273, True: 20274}
"""Rooms that were not used for tuning."""


@dataclass
class Fitted:
    """Sums over rooms. `directed` things are correctly classified and not round."""

    directed: int = 0
    errors_deg: list[float] = field(default_factory=list)
    before_deg: list[float] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    right: int = 0
    wrong: int = 0
    lost: int = 0
    taken_back: int = 0

    @property
    def covered(self) -> float:
        """The share of non-round things with a fitted orientation."""
        return len(self.errors_deg) / max(1, self.directed)


def matched(room: Room, shot: Shot, found: FrameResult) -> Iterator[tuple[Item, Pose, int]]:
    """Yield each detected thing with its true pose and the number of its observation from 1."""
    items = {item.name: item for item in room.items}
    shared, pixels = overlap(shot, found)
    wanted = [n for n in range(len(shot.bodies)) if pixels[n] >= LEAST_PIXELS]
    for row, column in zip(*linear_sum_assignment(-shared[wanted]), strict=True):
        if shared[wanted[row], column] > SAME_IOU:
            body = shot.bodies[wanted[row]]
            yield items[body.name], body.pose, int(column) + 1


def score(
    seen: Sequence[tuple[Room, Shot]], looks: Sequence[FrameResult], judge: Judge, surfaces: ClassSurfaces
) -> Fitted:
    """Fit all detections and compare them with the ground truth."""
    total = Fitted()
    for (room, shot), found in zip(seen, looks, strict=True):
        clouds = with_poses(shot.clouds[: len(found.labels)], found)
        for item, pose, number in matched(room, shot, found):
            observation = found.observations.observations[number - 1]
            started = time.perf_counter()
            fit = fit_of(observation, points_of(number, clouds, found), clouds, surfaces)
            if fit is not None:
                total.seconds.append(time.perf_counter() - started)
            _count(total, item, pose, observation, fit, judge)
    return total


def _count(total: Fitted, item: Item, truth: Pose, seen: Observation, fit: Fit | None, judge: Judge) -> None:
    right, contradicts_class = judge.right(item, seen.class_), with_fit(seen, fit).class_ != seen.class_
    total.right, total.lost = total.right + right, total.lost + (right and contradicts_class)
    total.wrong, total.taken_back = (
        total.wrong + (not right),
        total.taken_back + (not right and contradicts_class),
    )
    if not right or _fold(item.kind) == 0:
        return
    total.directed += 1
    error = partial(_error_deg, truth=truth, fold=_fold(item.kind))
    if fit is not None and fit.has_orientation:
        total.errors_deg.append(error(fit.pose))
        total.before_deg.append(error(seen.pose))


@cache
def _fold(model: str) -> int:
    return surface_of(build(model, None)).fold


def _error_deg(pose: Pose, truth: Pose, fold: int) -> float:
    said, true = (np.asarray(rotation_matrix(one.orientation_wxyz)) for one in (pose, truth))
    return math.degrees(angle_between(said, true, fold))


def measure(scenes: int, learnt: RecognitionModel) -> list[Row]:
    """Return all figures for easy and crowded rooms, from both cameras and from one."""
    judge, surfaces, rows = Judge(class_of_models(MODELS), learnt.ancestors), shipped_surfaces(), list[Row]()
    for crowded, name in ((False, "easy"), (True, "crowded")):
        seen = list(shots(rooms(scenes, _SEEDS[crowded], crowded=crowded), seed=3))
        for cameras in (2, 1):
            looks = looked(seen, partial(observe_clouds, learnt=learnt), cameras=cameras).looks
            found = score(seen, looks, judge, surfaces)
            where = f"{name}, {cameras} camera{'s' if cameras > 1 else ''}"
            off = np.array(found.errors_deg)
            rows += [
                Row(f"{where}: orientation, median", median(found.errors_deg), "deg", 6, 3, less=True),
                Row(f"{where}: of its box, median", median(found.before_deg), "deg"),
                Row(f"{where}: share with an orientation", found.covered, "", 0.7, 0.9),
                Row(f"{where}: of these off by more than 20 deg", float((off > 20.0).mean())),
                Row(f"{where}: a fit, median", 1e3 * median(found.seconds), "ms"),
                Row(f"{where}: right names lost, of {found.right}", found.lost, "names"),
                Row(f"{where}: wrong names taken back, of {found.wrong}", found.taken_back, "names"),
            ]
    return rows
