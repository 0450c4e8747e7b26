"""From things as they were seen to observations: class, pose and size of the whole."""

from __future__ import annotations

import math
from collections.abc import Sequence

from nodes.perception_node.recognition.shipped_votes import CLUTTER, Learnt
from nodes.perception_node.recognition.sides import completed, side_features
from nodes.perception_node.recognition.trimming import looked_at_again
from nodes.perception_node.recognition.vote import answer, expected_sizes
from nodes.perception_node.views.boxes import Box, Numbers
from nodes.perception_node.views.merged_thing import Thing
from schemas.entities import Pose, orientation_from_yaw
from schemas.perception import Observation

_CANDIDATES = 5
_CLUTTER = 0.7
_WORTH_SAYING = 0.01


def recognise(things: Sequence[Thing], chances: Numbers, learnt: Learnt) -> list[Observation | None]:
    """An observation of each thing, None for one that is rather clutter than a thing.

    `chances`: (N, K) the probabilities of the leaves.
    """
    chances = looked_at_again(things, chances, learnt)
    expected = expected_sizes(chances, learnt.sizes_m)
    return [_observation(*row, learnt) for row in zip(things, chances, expected, strict=True)]


def _observation(
    thing: Thing, probabilities: Numbers, expected_m: Numbers, learnt: Learnt
) -> Observation | None:
    chances = dict(zip(learnt.classes, probabilities.tolist(), strict=True))
    clutter = chances.pop(CLUTTER)
    if clutter > _CLUTTER:
        return None
    chances = {leaf: chance / (1.0 - clutter) for leaf, chance in chances.items()}
    class_, probability = answer(chances, learnt.ancestors, learnt.sure)
    likely = sorted(chances, key=chances.__getitem__, reverse=True)[:_CANDIDATES]
    box = completed(thing, side_features(thing, expected_m), learnt.sides)
    box = _turned(box, bool(learnt.sideways[learnt.classes.index(likely[0])]))
    x, y, z = box.bottom_m.tolist()
    a, b, c = box.size_m.tolist()
    return Observation(
        class_=class_,
        probability=probability,
        candidates={leaf: chances[leaf] for leaf in likely if chances[leaf] > _WORTH_SAYING},
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
