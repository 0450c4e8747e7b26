"""From things as they were seen to observations: class, pose and size of the whole."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from nodes.perception_node.boxes import Box, Numbers
from nodes.perception_node.recognition.features import colour, geometry, shape
from nodes.perception_node.recognition.learnt import CLUTTER, Learnt
from nodes.perception_node.recognition.sides import completed, side_features
from nodes.perception_node.recognition.vote import answer, vote
from nodes.perception_node.things import Thing
from schemas.entities import Pose, orientation_from_yaw
from schemas.perception import Observation

_CANDIDATES = 5
_WORTH_SAYING = 0.01


def features_of(things: Sequence[Thing]) -> list[Numbers]:
    """For each voter (N, its own number) what it looks at."""
    return [np.array([look(thing) for thing in things]) for look in (geometry, shape, colour)]


def expected_sizes(probabilities: Numbers, learnt: Learnt) -> Numbers:
    """(N, 3) long side, short side and height [m] that things of the likely leaves have: geometric means."""
    return np.asarray(np.exp(probabilities @ np.log(learnt.sizes_m)))


def recognise(things: Sequence[Thing], learnt: Learnt) -> list[Observation | None]:
    """An observation of each thing, None for one that is rather clutter than a thing."""
    if not things:
        return []
    probabilities = vote(learnt, features_of(things))
    expected = expected_sizes(probabilities, learnt)
    return [_observation(*row, learnt) for row in zip(things, probabilities, expected, strict=True)]


def _observation(
    thing: Thing, probabilities: Numbers, expected_m: Numbers, learnt: Learnt
) -> Observation | None:
    leaves = dict(zip(learnt.classes, probabilities.tolist(), strict=True))
    if leaves.pop(CLUTTER, 0.0) > 0.5:
        return None
    total = sum(leaves.values())
    leaves = {leaf: probability / total for leaf, probability in leaves.items()}
    class_, probability = answer(leaves, learnt.ancestors, learnt.sure)
    likely = sorted(leaves, key=leaves.__getitem__, reverse=True)[:_CANDIDATES]
    box = completed(thing, side_features(thing, expected_m), learnt.sides)
    box = _turned(box, bool(learnt.sideways[learnt.classes.index(likely[0])]))
    x, y, z = box.bottom_m.tolist()
    a, b, c = box.size_m.tolist()
    return Observation(
        class_=class_,
        probability=probability,
        candidates={leaf: leaves[leaf] for leaf in likely if leaves[leaf] > _WORTH_SAYING},
        pose=Pose(position_m=(x, y, z), orientation_wxyz=orientation_from_yaw(box.yaw_rad)),
        size_m=(a, b, c),
        points=thing.count,
        whole=thing.whole,
    )


def _turned(box: Box, sideways: bool) -> Box:
    """The box with its longer side along the axis where its class has it, its yaw in (-pi / 2, pi / 2]."""
    if (box.size_m[1] > box.size_m[0]) != sideways:
        box = box.quarter_turned()
    yaw = math.remainder(box.yaw_rad, math.pi)
    if abs(yaw - box.yaw_rad) < 1e-9:
        return box
    flip = round((box.yaw_rad - yaw) / math.pi) % 2
    low, high = (box.low, box.high) if not flip else (box.low.copy(), box.high.copy())
    if flip:
        low[:2], high[:2] = -box.high[:2], -box.low[:2]
    return Box(low, high, yaw)
