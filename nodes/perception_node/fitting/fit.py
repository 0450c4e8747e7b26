"""Estimates pose and shape of one thing by the model of its class. Pure."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec

import numpy as np

from semmap.nodes.perception_node.fitting.evidence import verified_share, visible_share
from semmap.nodes.perception_node.fitting.initial_poses import (
    InitialPose,
    choice_distance,
    initial_poses,
    stretch,
)
from semmap.nodes.perception_node.fitting.model_surfaces import ModelSurface
from semmap.nodes.perception_node.fitting.registration import register
from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.schemas.entities import Pose, Quaternion, Size

MOST_POINTS = 400
FEWEST_POINTS = 60
_WITHIN_M = 0.008
_THROUGH_M = 0.012
_REFINED = 5
_FORMS = 2
"""Number of models tried per class: a round bottle and a spray bottle may have nearly the same size."""
_STRETCHED = 0.3
"""Penalty for a pose that changes the proportions of the model."""
_UNFIT = 0.15
"""A whole thing with a lower score is not of the class; no correct one was lower (`benchmarks/README.md`)."""
_UPRIGHT = 0.7
_OTHER_RAD = math.radians(25.0)
_CLEAR = 0.015
"""An orientation is unambiguous if its score exceeds that of all others by this margin."""


@dataclass(frozen=True)
class Fit:
    """The alignment of a class's model with a thing.

    `pose`: of the model's own frame, whose origin is the centre of its bottom, in the map. `size_m`: the
    fitted size along the model's axes. `score`: 0 to 1, the share of observed points on the model times the
    share of the visible model surface that was observed. `clear`: whether the orientation is unambiguous,
    except for symmetry. `fold`: rotational symmetry about the model's z axis (0: round; 1: none).
    """

    class_: str
    pose: Pose
    size_m: Size
    score: float
    clear: bool
    fold: int

    @property
    def is_verified(self) -> bool:
        """Return whether the thing may be of the class; others of a class may look unlike our model."""
        return self.score >= _UNFIT

    @property
    def has_orientation(self) -> bool:
        """Return whether the orientation is known and not symmetric."""
        return self.clear and self.is_verified and (self.fold != 0 or self.lying)

    @property
    def lying(self) -> bool:
        """Return whether the model's z axis is not up."""
        _, x, y, _ = self.pose.orientation_wxyz
        return 1.0 - 2.0 * (x * x + y * y) < _UPRIGHT


def available() -> bool:
    """Return whether Open3D, which computes the registration, is installed."""
    return find_spec("open3d") is not None


def fit_models(
    class_: str,
    models: Sequence[ModelSurface],
    points: Numbers,
    pose: Pose,
    size_m: Size,
    clouds: Sequence[Cloud],
) -> Fit | None:
    """Align the models of a class with a thing; return None if too few points were seen.

    The models nearest in size are tried, and the best fit is returned. `points` (N, 3): observed points, map
    frame [m]; `pose` and `size_m`: the box of the thing; `clouds`: the clouds, which show where nothing is.
    """
    points = thinned(points[np.isfinite(points).all(axis=1)])
    if len(points) < FEWEST_POINTS:
        return None
    rough = [
        _run_trial(start, start.pose, model.fold, points, clouds, fine=False)
        for model in sorted(models, key=lambda model: choice_distance(model.size_m, np.array(size_m)))[
            :_FORMS
        ]
        for start in initial_poses(model, pose, size_m)
    ]
    rough.sort(key=lambda trial: -trial.score)
    found = [
        _run_trial(trial.start, trial.pose, trial.fold, points, clouds, fine=True)
        for trial in _select_trials(rough)
    ]
    best = max(found, key=lambda trial: trial.score)
    others = (trial.score for trial in found if best.angle_from(trial) > _OTHER_RAD)
    return Fit(
        class_=class_,
        pose=_pose(best),
        size_m=_size(best.start),
        score=best.verified_share,
        clear=best.score - max(others, default=0.0) > _CLEAR,
        fold=best.fold,
    )


def thinned(points: Numbers) -> Numbers:
    """Return at most `MOST_POINTS` of the points, evenly chosen."""
    return points[:: math.ceil(len(points) / MOST_POINTS)] if len(points) > MOST_POINTS else points


@dataclass(frozen=True)
class _Trial:
    """An initial pose, the registered pose, and its score."""

    start: InitialPose
    pose: Numbers
    fold: int
    verified_share: float
    score: float

    @property
    def rotation(self) -> Numbers:
        """Return the rotation (3, 3) of the model's frame in the map."""
        return np.asarray(self.pose[:3, :3] @ self.start.turn)

    def angle_from(self, other: _Trial) -> float:
        """Return the angle [rad] to another trial, up to symmetry."""
        if other.fold == 0 != self.fold:
            return math.pi
        return angle_between(self.rotation, other.rotation, self.fold)


def _run_trial(
    start: InitialPose, pose: Numbers, fold: int, points: Numbers, clouds: Sequence[Cloud], *, fine: bool
) -> _Trial:
    pose = register(points, start, pose, _WITHIN_M, fine=fine)
    seen = verified_share(points, start.model, pose, _WITHIN_M)
    there = visible_share(start.model, pose, clouds, _THROUGH_M)
    both = seen * (1.0 if there is None else there)
    return _Trial(start, pose, fold, both, both * math.exp(-_STRETCHED * stretch(start) ** 2))


def _select_trials(trials: Sequence[_Trial]) -> list[_Trial]:
    """Return the best few trials, and the best one with another orientation."""
    kept = list(trials[:_REFINED])
    other = next((t for t in trials[_REFINED:] if kept[0].angle_from(t) > _OTHER_RAD), None)
    return kept if other is None else [*kept, other]


def angle_between(one: Numbers, other: Numbers, fold: int) -> float:
    """Return the angle [rad] between rotations (3, 3) of a thing with `fold`-fold symmetry about z."""
    if fold == 0:
        return math.acos(float(np.clip(one[:, 2] @ other[:, 2], -1.0, 1.0)))
    return min(_angle(one, other @ _about_z(2.0 * math.pi * n / fold)) for n in range(fold))


def _angle(one: Numbers, other: Numbers) -> float:
    return math.acos(float(np.clip((np.trace(one.T @ other) - 1.0) / 2.0, -1.0, 1.0)))


def _about_z(angle_rad: float) -> Numbers:
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _size(start: InitialPose) -> Size:
    """Return the size of a model along its own axes at an initial pose [m]."""
    x, y, z = np.abs(start.turn.T @ start.model.size_m).tolist()
    return (x, y, z)


def _pose(trial: _Trial) -> Pose:
    start = trial.start
    up = np.array([0.0, 0.0, 0.5])
    origin = up * start.model.size_m - start.turn @ (up * _size(start))  # in the frame of the lying model
    x, y, z = (trial.pose[:3, :3] @ origin + trial.pose[:3, 3]).tolist()
    return Pose(position_m=(x, y, z), orientation_wxyz=quaternion(trial.rotation))


def quaternion(rotation: Numbers) -> Quaternion:
    """Return the unit quaternion (w, x, y, z) of a rotation (3, 3), with w >= 0."""
    from scipy.spatial.transform import Rotation

    x, y, z, w = Rotation.from_matrix(rotation).as_quat().tolist()
    return (w, x, y, z) if w >= 0.0 else (-w, -x, -y, -z)
