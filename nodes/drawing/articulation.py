"""Surfaces with joints at their current positions: open doors, pulled-out drawers."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final

import numpy as np
from msgspec import structs
from numpy.typing import NDArray

from semmap.schemas.joints import Joint
from semmap.schemas.scenes import Surface

JointPositions = tuple[tuple[str, float], ...]
"""Names and positions [rad, m] of the joints that are not at 0, as which a model is drawn."""

_STEP: Final = {"hinge": 0.05, "slide": 0.01}
"""Positions are rounded to this step [rad, m], so an opening door is drawn about thirty times."""


def joint_positions_of(joints: Iterable[Joint]) -> JointPositions:
    """Return the rounded positions of joints; empty if all are at 0."""
    found = ((joint.name, _stepped(joint)) for joint in joints if joint.kind in _STEP)
    return tuple((name, position) for name, position in found if position)


def articulated(surface: Surface, joints: JointPositions) -> Surface:
    """Return a surface with these joints moved; unknown names are ignored."""
    positions = dict(joints)
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
    """Return the rotation (3, 3) by an angle about a unit axis."""
    x, y, z = axis
    cross = np.array([(0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)])
    return np.asarray(np.eye(3) + np.sin(angle_rad) * cross + (1.0 - np.cos(angle_rad)) * cross @ cross)
