"""Surfaces with their joints where they stand: open doors, drawn-out drawers."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final

import numpy as np
from msgspec import structs
from numpy.typing import NDArray

from semmap.schemas.joints import Joint
from semmap.schemas.scenes import Surface

JointPositions = tuple[tuple[str, float], ...]
"""Joints that are not where a model is drawn with them, at 0: names and positions [rad, m]."""

_STEP: Final = {"hinge": 0.05, "slide": 0.01}
"""What moves by less looks the same [rad, m]; so a door that opens is drawn some thirty times."""


def joint_positions_of(joints: Iterable[Joint]) -> JointPositions:
    """How joints stand, in steps that can be seen; empty where all are as the model is drawn."""
    found = ((joint.name, _stepped(joint)) for joint in joints if joint.kind in _STEP)
    return tuple((name, position) for name, position in found if position)


def articulated(surface: Surface, bends: JointPositions) -> Surface:
    """A surface with these joints moved; names that it does not have are passed over."""
    positions = dict(bends)
    leaves = [leaf for leaf in surface.leaves if positions.get(leaf.joint)]
    if not leaves:
        return surface
    points = np.frombuffer(surface.points, "<f4").reshape(-1, 3).copy()
    normals = np.frombuffer(surface.normals, "<f4").reshape(-1, 3).copy()
    for leaf in leaves:
        rows = slice(leaf.first, leaf.first + leaf.count)
        axis = np.array(leaf.axis) / np.linalg.norm(leaf.axis)
        if leaf.kind == "slide":
            points[rows] += positions[leaf.joint] * axis
        else:
            turn = _about(axis, positions[leaf.joint])
            points[rows] = (points[rows] - leaf.anchor) @ turn.T + leaf.anchor
            normals[rows] = normals[rows] @ turn.T
    return structs.replace(surface, points=points.tobytes(), normals=normals.tobytes())


def _stepped(joint: Joint) -> float:
    step = _STEP[joint.kind]
    return round(round(joint.position / step) * step, 4) + 0.0


def _about(axis: NDArray[Any], angle_rad: float) -> NDArray[Any]:
    """(3, 3): the turn by an angle about a unit axis."""
    x, y, z = axis
    cross = np.array([(0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)])
    return np.asarray(np.eye(3) + np.sin(angle_rad) * cross + (1.0 - np.cos(angle_rad)) * cross @ cross)
