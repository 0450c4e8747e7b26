"""Initial poses for registration: how a model may stand or lie in the observed box."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from semmap.nodes.perception_node.fitting.model_surfaces import ModelSurface
from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.schemas.entities import Pose, Size

_EIGHTH = math.pi / 4.0
_LIES = 0.75
"""A box is of a lying model if its mismatch is below this share of the mismatch of the upright model."""
_UNLIKE = 0.25
"""Maximum mean difference of the log extents of a box and a model."""


@dataclass(frozen=True)
class InitialPose:
    """A model at the observed size; `pose` (4, 4) is its frame in the map.

    `turn` (3, 3) is the rotation from its own frame to `model`'s, for lying models. `laid_m` (3,): the size
    after this rotation, before scaling.
    """

    model: ModelSurface
    turn: Numbers
    pose: Numbers
    laid_m: Numbers

    @property
    def lying(self) -> bool:
        """Return whether the model is not upright."""
        return bool(self.turn[2, 2] < 0.5)


def initial_poses(model: ModelSurface, pose: Pose, size_m: Size) -> Iterator[InitialPose]:
    """Yield every eighth of a turn, upright and, if only that fits the box, lying."""
    seen = np.array(size_m)
    upright = [np.eye(3)]
    lying = [turn for turn in _LAID if size_mismatch(np.abs(turn @ model.size_m), seen) < _UNLIKE]
    best = min((size_mismatch(np.abs(turn @ model.size_m), seen) for turn in lying), default=math.inf)
    if best > _LIES * size_mismatch(model.size_m, seen):
        lying = []
    for turn in [*upright, *lying]:
        laid = model if turn is upright[0] else model.rotated(turn)
        for eighth, scale in product(range(_turns(laid)), (False, True)):
            yaw = pose.yaw_rad + eighth * _EIGHTH
            if eighth % 2 and not scale:
                continue
            size = in_proportion(laid.size_m, seen) if scale else seen[[1, 0, 2]] if eighth % 4 == 2 else seen
            yield InitialPose(laid.scaled(size), turn, placed(yaw, pose), laid.size_m)


def stretch(start: InitialPose) -> float:
    """Return the log change of the model's proportions on the floor."""
    own = start.laid_m
    x, y, _ = start.model.size_m / own
    return abs(math.log(x / y))


def _turns(model: ModelSurface) -> int:
    return {0: 1, 4: 2, 2: 4}.get(model.fold, 8)


def size_mismatch(size_m: Numbers, seen_m: Numbers) -> float:
    """Return the mean difference of log extents, for the better of two orientations of the box."""
    orientations = (seen_m, seen_m[[1, 0, 2]])
    return min(float(np.abs(np.log(size_m / orientation)).mean()) for orientation in orientations)


def choice_distance(size_m: Numbers, seen_m: Numbers) -> float:
    """Return the distance of a model's size from the observed one, as in `ontology/model_choice`.

    It is the sum of the squared log ratios of extents and of proportions, for the better of two orientations.
    """
    ratios = (np.log(size_m / seen_m), np.log(size_m / seen_m[[1, 0, 2]]))
    return min(float((r**2).sum() + ((r - r.mean()) ** 2).sum()) for r in ratios)


def in_proportion(own_m: Numbers, seen_m: Numbers) -> Numbers:
    """Return the size of a model that keeps its proportions on the floor, with the observed area."""
    factor = math.sqrt(float(seen_m[0] * seen_m[1] / (own_m[0] * own_m[1])))
    return np.array([factor * own_m[0], factor * own_m[1], seen_m[2]])


def placed(yaw_rad: float, pose: Pose) -> Numbers:
    """Return the transform (4, 4) to a pose's position with this yaw."""
    c, s = math.cos(yaw_rad), math.sin(yaw_rad)
    transform = np.eye(4)
    transform[:2, :2] = [[c, -s], [s, c]]
    transform[:3, 3] = pose.position_m
    return transform


def _laid() -> list[Numbers]:
    """Return the rotations that lay a model on its front, back and sides, and upside down."""
    found = []
    for axis, quarters in (("x", 1), ("x", 3), ("y", 1), ("y", 3)):
        angle = quarters * math.pi / 2.0
        c, s = round(math.cos(angle)), round(math.sin(angle))
        found.append(
            np.array([[1, 0, 0], [0, c, -s], [0, s, c]], float)
            if axis == "x"
            else np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]], float)
        )
    return found


_LAID = _laid()
