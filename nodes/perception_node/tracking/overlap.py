"""Overlap of upright boxes."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from semmap.schemas.entities import Pose, Size

_GRID = np.stack(
    np.meshgrid(*[(np.arange(n) + 0.5) / n - 0.5 for n in (6, 6, 4)], indexing="ij"), axis=-1
).reshape(-1, 3)
"""Points of a unit cube around the origin."""
_A_PART, _NO_PART = 0.3, 0.02
_THIN_M = 0.1


class OrientedBox(NamedTuple):
    """The box of a thing in the map: `pose` is that of its bottom centre."""

    pose: Pose
    size_m: Size

    @property
    def volume_m3(self) -> float:
        """Return the volume."""
        return math.prod(self.size_m)


def share(inner: OrientedBox, outer: OrientedBox) -> float:
    """Return the approximate share of the volume of `inner` in `outer`, in [0, 1]."""
    if _apart(inner, outer):
        return 0.0
    points = _GRID * inner.size_m @ _turn(inner.pose.yaw_rad).T
    points += np.array(inner.pose.position_m) - outer.pose.position_m
    points[:, 2] += (inner.size_m[2] - outer.size_m[2]) / 2.0
    return float(
        (np.abs(points @ _turn(outer.pose.yaw_rad)) <= np.array(outer.size_m) / 2.0).all(axis=1).mean()
    )


def may_be_same_thing(one: OrientedBox, other: OrientedBox) -> bool:
    """Return whether boxes may be of one thing: they overlap, and neither is tiny."""
    ratio = one.volume_m3 / other.volume_m3
    return (ratio > _NO_PART and share(one, other) > _A_PART) or (
        1.0 / ratio > _NO_PART and share(other, one) > _A_PART
    )


def uncovered_slabs(before: OrientedBox, now: OrientedBox) -> list[OrientedBox]:
    """Return the parts of one box outside the other, along its axes, as slabs of a minimum thickness."""
    turn = _turn(before.pose.yaw_rad)
    half, now_half = np.array(before.size_m) / 2.0, np.array(now.size_m) / 2.0
    middle = np.array(now.pose.position_m) - before.pose.position_m
    middle[:2] = turn[:2, :2].T @ middle[:2]
    middle[2] += now_half[2] - half[2]
    reach = np.abs(turn.T @ _turn(now.pose.yaw_rad)) @ now_half
    slabs = []
    for axis in range(3):
        for low, high in (
            (-half[axis], middle[axis] - reach[axis]),
            (middle[axis] + reach[axis], half[axis]),
        ):
            thick = min(high, half[axis]) - max(low, -half[axis])
            if thick < _THIN_M:
                continue
            size, at = 2.0 * half, np.zeros(3)
            size[axis], at[axis] = thick, (max(low, -half[axis]) + min(high, half[axis])) / 2.0
            x, y, z = turn @ at + before.pose.position_m + [0.0, 0.0, half[2] - size[2] / 2.0]
            w, d, h = size.tolist()
            slabs.append(
                OrientedBox(
                    Pose(position_m=(x, y, z), orientation_wxyz=before.pose.orientation_wxyz), (w, d, h)
                )
            )
    return slabs


def _apart(one: OrientedBox, other: OrientedBox) -> bool:
    reach = (math.hypot(*one.size_m[:2]) + math.hypot(*other.size_m[:2])) / 2.0
    horizontal = math.dist(one.pose.position_m[:2], other.pose.position_m[:2])
    vertical = other.pose.position_m[2] - one.pose.position_m[2]
    return horizontal > reach or vertical > one.size_m[2] or -vertical > other.size_m[2]


def _turn(yaw_rad: float) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    c, s = math.cos(yaw_rad), math.sin(yaw_rad)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
