"""Where the search for a pose starts: how a model may stand or lie in the box that was seen."""

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
"""A box is that of a lying model where it is unlike the lying one by less than this share of the upright."""
_UNLIKE = 0.25
"""A box is like a model's where the logarithms of their extents differ by no more, on the mean."""


@dataclass(frozen=True)
class InitialPose:
    """A model at the size that was seen, put into the map: `pose` (4, 4) is where its own frame is there.

    `turn` (3, 3) has laid it down before: its own frame in `model`'s. `laid_m` (3,): what it measures then,
    not yet scaled.
    """

    model: ModelSurface
    turn: Numbers
    pose: Numbers
    laid_m: Numbers

    @property
    def lying(self) -> bool:
        """Whether the model is not upright."""
        return bool(self.turn[2, 2] < 0.5)


def initial_poses(model: ModelSurface, pose: Pose, size_m: Size) -> Iterator[InitialPose]:
    """Every eighth of a turn in the box that was seen, upright and, where only that fits the box, lying."""
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
    """How far a model was drawn out of its proportions on the floor: the logarithm of that."""
    own = start.laid_m
    x, y, _ = start.model.size_m / own
    return abs(math.log(x / y))


def _turns(model: ModelSurface) -> int:
    return {0: 1, 4: 2, 2: 4}.get(model.fold, 8)


def size_mismatch(size_m: Numbers, seen_m: Numbers) -> float:
    """The mean difference of the logarithms of extents, whichever way the box is turned."""
    ways = (seen_m, seen_m[[1, 0, 2]])
    return min(float(np.abs(np.log(size_m / way)).mean()) for way in ways)


def choice_distance(size_m: Numbers, seen_m: Numbers) -> float:
    """How far a model's extents are off, whichever way it is turned, by the rule of `ontology/model_choice`.

    The squared logarithms of their ratios, and once more of proportions.
    """
    ways = (np.log(size_m / seen_m), np.log(size_m / seen_m[[1, 0, 2]]))
    return min(float((way**2).sum() + ((way - way.mean()) ** 2).sum()) for way in ways)


def in_proportion(own_m: Numbers, seen_m: Numbers) -> Numbers:
    """The size of a model that keeps its proportions on the floor: as large and high as what was seen."""
    factor = math.sqrt(float(seen_m[0] * seen_m[1] / (own_m[0] * own_m[1])))
    return np.array([factor * own_m[0], factor * own_m[1], seen_m[2]])


def placed(yaw_rad: float, pose: Pose) -> Numbers:
    """(4, 4) of what stands at a pose's position, turned by this yaw."""
    c, s = math.cos(yaw_rad), math.sin(yaw_rad)
    transform = np.eye(4)
    transform[:2, :2] = [[c, -s], [s, c]]
    transform[:3, 3] = pose.position_m
    return transform


def _laid() -> list[Numbers]:
    """The turns that lay a model on its front, back and sides, and upside down."""
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
