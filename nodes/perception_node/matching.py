"""Which observation is of which thing: optimal assignment on position, size and class."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple, TypeVar

import numpy as np
from scipy.optimize import linear_sum_assignment

from nodes.perception_node.kinship import ANYTHING, Kinship
from schemas.entities import Pose, Size
from schemas.perception import Observation

A = TypeVar("A")
B = TypeVar("B")

FORBIDDEN = math.inf
_PROHIBITIVE = 1e6
_NEARBY_M = 0.05
_UNLIKE = 0.4
"""Sizes that differ by more (mean of |log ratio|) are not of one thing that seems to have another class."""
_OF_A_KIND, _OF_ANY_KIND = 0.35, 0.15
"""The same for what is recognised somewhere else: by a class and size alone, or by its size alone."""


class Target(NamedTuple):
    """A thing that may be seen: where it was last, how big it is if that is known, and its class."""

    pose: Pose
    size_m: Size | None
    class_: str


def assign(rows: Sequence[A], columns: Sequence[B], cost: Callable[[A, B], float]) -> list[tuple[int, int]]:
    """Pairs (row, column), as many as may be and of the least cost together; FORBIDDEN ones never."""
    costs = np.array([[cost(a, b) for b in columns] for a in rows]).reshape(len(rows), len(columns))
    pairs = zip(*linear_sum_assignment(np.minimum(costs, _PROHIBITIVE)), strict=True)
    return [(int(i), int(j)) for i, j in pairs if costs[i, j] < _PROHIBITIVE]


def cost_in_place(target: Target, seen: Observation, kinship: Kinship) -> float:
    """How unlike an observation is a thing that hardly moved, if at all; FORBIDDEN if it cannot be it."""
    size_m = target.size_m or seen.size_m
    aside, above = _apart(target.pose, size_m, seen)
    reach = (max(size_m[:2]) + max(seen.size_m[:2])) / 4.0 + _NEARBY_M
    if aside > reach or above > (size_m[2] + seen.size_m[2]) / 4.0 + _NEARBY_M:
        return FORBIDDEN
    unlike, alien = size_unlike(size_m, seen), class_unlike(target.class_, seen, kinship)
    if unlike > 2.0 * _UNLIKE or (alien > 0.5 and unlike > _UNLIKE):
        return FORBIDDEN
    return aside / reach + unlike + alien


def cost_elsewhere(target: Target, seen: Observation, kinship: Kinship) -> float:
    """How unlike an observation is a thing that has vanished from its place; FORBIDDEN if of another kind."""
    if target.size_m is None or not kinship.related(target.class_, seen.class_):
        return FORBIDDEN
    unlike = size_unlike(target.size_m, seen)
    if unlike > (_OF_ANY_KIND if ANYTHING in (seen.class_, target.class_) else _OF_A_KIND):
        return FORBIDDEN
    aside, above = _apart(target.pose, target.size_m, seen)
    return unlike + class_unlike(target.class_, seen, kinship) + 0.1 * math.hypot(aside, above)


def fills(target: Target, seen: Observation) -> bool:
    """Whether an observation that is of something else takes the place of a thing."""
    if target.size_m is None or size_unlike(target.size_m, seen) > 2.0 * _UNLIKE:
        return False
    aside, above = _apart(target.pose, target.size_m, seen)
    return aside < min(seen.size_m[:2]) / 2.0 and above < seen.size_m[2] / 2.0


def size_unlike(size_m: Size, seen: Observation) -> float:
    """Mean of |log ratio| of the extents, however turned; what is seen in part may be smaller."""
    ratios = [math.log(b / a) for a, b in zip(_upright(size_m), _upright(seen.size_m), strict=True)]
    return sum(abs(ratio) if ratio > 0.0 or seen.whole else 0.3 * abs(ratio) for ratio in ratios) / 3.0


def class_unlike(class_name: str, seen: Observation, kinship: Kinship) -> float:
    """From 0 for one that is related to what was seen, to 1 for one that it can hardly be."""
    if kinship.related(class_name, seen.class_):
        return 0.0
    return max(0.0, 1.0 - sum(p for leaf, p in seen.candidates.items() if kinship.is_a(leaf, class_name)))


def _upright(size_m: Size) -> tuple[float, float, float]:
    x, y, z = size_m
    return (min(x, y), max(x, y), z)


def _apart(pose: Pose, size_m: Size, seen: Observation) -> tuple[float, float]:
    """Distance of the middles, horizontally and vertically [m]."""
    (x, y, z), (u, v, w) = pose.position_m, seen.pose.position_m
    return math.hypot(u - x, v - y), abs(w + seen.size_m[2] / 2.0 - z - size_m[2] / 2.0)
