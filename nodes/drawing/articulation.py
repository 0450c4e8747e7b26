"""Surfaces with joints at their current positions: open doors, pulled-out drawers."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Final

import numpy as np
from msgspec import structs
from numpy.typing import NDArray

from semmap.schemas.joints import Joint
from semmap.schemas.scenes import Leaf, Surface

JointPositions = tuple[tuple[str, float], ...]
"""Names and positions [rad, m] of the joints that are not at 0, as which a model is drawn."""

_STEP: Final = {"hinge": 0.05, "slide": 0.01}
"""Positions are rounded to this step [rad, m], so an opening door is drawn about thirty times."""


def joint_positions_of(joints: Iterable[Joint]) -> JointPositions:
    """Return the rounded positions of joints; empty if all are at 0."""
    found = ((joint.name, _stepped(joint)) for joint in joints if joint.kind in _STEP)
    return tuple((name, position) for name, position in found if position)


def articulated(surface: Surface, joints: JointPositions) -> Surface:
    """Return a surface with these joints moved; unknown names are ignored.

    A leaf on another one, such as a hand on an arm, moves first: axes are given with all joints at 0.
    """
    positions = dict(joints)
    leaves = [leaf for leaf in surface.leaves if positions.get(leaf.joint)]
    if not leaves:
        return surface
    points = np.frombuffer(surface.points, "<f4").reshape(-1, 3).copy()
    normals = np.frombuffer(surface.normals, "<f4").reshape(-1, 3).copy()
    for leaf in reversed(leaves):
        rows = slice(leaf.first, leaf.first + leaf.count)
        turn, shift = transform_of(leaf, positions[leaf.joint])
        points[rows] = points[rows] @ turn.T + shift
        normals[rows] = normals[rows] @ turn.T
    return structs.replace(surface, points=points.tobytes(), normals=normals.tobytes())


def transform_of(leaf: Leaf, position: float) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return the rotation (3, 3) and translation (3,) [m] with which a joint at a position moves its leaf."""
    axis, anchor = np.array(leaf.axis) / np.linalg.norm(leaf.axis), np.array(leaf.anchor)
    if leaf.kind == "slide":
        return np.eye(3), position * axis
    turn = _about(axis, position)
    return turn, anchor - turn @ anchor


def paths_of(leaves: Sequence[Leaf]) -> list[tuple[int, ...]]:
    """Return the path to each leaf: the indices of the leaves that it moves with, and its own."""
    paths: list[tuple[int, ...]] = []
    for number, leaf in enumerate(leaves):
        holders = (k for k in reversed(range(number)) if _contains(leaves[k], leaf))
        paths.append((*paths[holder], number) if (holder := next(holders, None)) is not None else (number,))
    return paths


def _contains(outer: Leaf, inner: Leaf) -> bool:
    return outer.first <= inner.first and inner.first + inner.count <= outer.first + outer.count


def _stepped(joint: Joint) -> float:
    step = _STEP[joint.kind]
    return round(round(joint.position / step) * step, 4) + 0.0


def _about(axis: NDArray[Any], angle_rad: float) -> NDArray[Any]:
    """Return the rotation (3, 3) by an angle about a unit axis."""
    x, y, z = axis
    cross = np.array([(0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)])
    return np.asarray(np.eye(3) + np.sin(angle_rad) * cross + (1.0 - np.cos(angle_rad)) * cross @ cross)
