"""The convex parts of a shape as the primitives and meshes of `shape_msgs`."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.extern.ros.convex_hull import Floats, hull_triangles
from semmap.nodes.extern.ros.things import pose_of
from semmap.nodes.extern.ros.types import new
from semmap.ontology.model_shapes import ConvexPart, Corner
from semmap.schemas.entities import Pose, Quaternion

_BOX, _SPHERE, _CYLINDER = 1, 2, 3
_THINNEST_M: Final = 0.001
"""Planners reject a primitive without extent, so a thinner one becomes this thick."""
_TOLERANCE: Final = 1e-3
_RINGS: Final = 4
"""Circles of points on each half of a rounded form."""


class Solids(NamedTuple):
    """The shapes of a collision object, in its frame, as fields of the message."""

    primitives: list[Any]
    primitive_poses: list[Any]
    meshes: list[Any]
    mesh_poses: list[Any]


def solids_of(parts: Iterable[ConvexPart]) -> Solids:
    """Return primitives for boxes, balls, cylinders and capsules, and meshes of the hulls of others."""
    made = Solids([], [], [], [])
    for part in parts:
        if (primitives := _primitives_of(part)) is None:
            made.meshes.append(mesh_message(*_hull_of(part)))
            made.mesh_poses.append(new("geometry_msgs/msg/Pose"))
            continue
        for kind, dimensions, pose in primitives:
            primitive = new("shape_msgs/msg/SolidPrimitive", type=kind, dimensions=np.array(dimensions))
            made.primitives.append(primitive)
            made.primitive_poses.append(pose_of(pose))
    return made


def box_of(size_m: Corner) -> Solids:
    """Return a box of this size that stands on its frame."""
    x, y, z = (length / 2.0 for length in size_m)
    sides = ((x, 0.0, 0.0), (0.0, y, 0.0), (0.0, 0.0, z))
    return solids_of([ConvexPart(centre=(0.0, 0.0, z), straight=sides)])


def mesh_message(points: Floats, triangles: NDArray[Any]) -> Any:
    """Return a `shape_msgs/Mesh` of corners (N, 3) [m] and triangles (M, 3) of their rows."""
    return new(
        "shape_msgs/msg/Mesh",
        triangles=[
            new("shape_msgs/msg/MeshTriangle", vertex_indices=row)
            for row in np.asarray(triangles, dtype=np.uint32)
        ],
        vertices=[new("geometry_msgs/msg/Point", x=x, y=y, z=z) for x, y, z in points.tolist()],
    )


_Primitive = tuple[int, tuple[float, ...], Pose]


def _primitives_of(part: ConvexPart) -> list[_Primitive] | None:
    """Return the types, dimensions [m] and poses of the primitives that are a part; None for other parts."""
    straight, rounded = np.array(part.straight).reshape(-1, 3), np.array(part.round).reshape(-1, 3)
    if part.points or not (_is_orthogonal(straight) and _is_orthogonal(rounded)):
        return None
    radii = np.linalg.norm(rounded, axis=1)
    if len(rounded) and np.ptp(radii) > _TOLERANCE * radii.max():
        return None
    match len(straight), len(rounded):
        case 3, 0:
            lengths = np.linalg.norm(straight, axis=1)
            sides = tuple(max(2.0 * length, _THINNEST_M) for length in lengths.tolist())
            return [(_BOX, sides, _pose(part.centre, straight))]
        case 0, 3:
            return [(_SPHERE, (float(radii[0]),), Pose(position_m=part.centre))]
        case 1, 2 if _is_orthogonal(np.vstack((rounded, straight))):
            return [_cylinder(part.centre, straight[0], float(radii[0]))]
        case 1, 3:
            ends = [tuple((np.array(part.centre) + side * straight[0]).tolist()) for side in (-1.0, 1.0)]
            balls = [(_SPHERE, (float(radii[0]),), Pose(position_m=(x, y, z))) for x, y, z in ends]
            return [_cylinder(part.centre, straight[0], float(radii[0])), *balls]
    return None


def _cylinder(centre: Corner, along: Floats, radius_m: float) -> _Primitive:
    length = float(np.linalg.norm(along))
    other = np.eye(3)[np.argmin(np.abs(along))]
    across = np.cross(along, other) if length else np.eye(3)[0]
    axes = np.array([across, np.cross(along, across), along]) if length else np.eye(3)
    return _CYLINDER, (max(2.0 * length, _THINNEST_M), radius_m), _pose(centre, axes)


def _is_orthogonal(vectors: Floats) -> bool:
    for one, other in itertools.combinations(vectors, 2):
        lengths = float(np.linalg.norm(one) * np.linalg.norm(other))
        if abs(float(one @ other)) > _TOLERANCE * lengths:
            return False
    return True


def _pose(centre: Corner, axes: Floats) -> Pose:
    """Return the pose of a form with these axes, which need not be of unit length; one may be 0."""
    lengths = np.linalg.norm(axes, axis=1)
    unit = axes / np.where(lengths > 0.0, lengths, 1.0)[:, None]
    for k in range(3):
        if not lengths[k] and lengths[k - 1] and lengths[k - 2]:
            unit[k] = np.cross(unit[k - 2], unit[k - 1])
    if (lengths > 0.0).sum() < 2:
        return Pose(position_m=centre)
    if np.linalg.det(unit) < 0.0:
        unit[2] = -unit[2]
    return Pose(position_m=centre, orientation_wxyz=_quaternion(unit.T))


def _quaternion(turn: Floats) -> Quaternion:
    """Return the quaternion of a rotation matrix, from the largest of its components."""
    (a, b, c), (d, e, f), (g, h, i) = turn.tolist()
    candidates = (
        (1.0 + a + e + i, h - f, c - g, d - b),
        (h - f, 1.0 + a - e - i, b + d, c + g),
        (c - g, b + d, 1.0 - a + e - i, f + h),
        (d - b, c + g, f + h, 1.0 - a - e + i),
    )
    w, x, y, z = candidates[max(range(4), key=lambda k: candidates[k][k])]
    length = math.sqrt(w * w + x * x + y * y + z * z)
    return w / length, x / length, y / length, z / length


def _hull_of(part: ConvexPart) -> tuple[Floats, NDArray[Any]]:
    """Return corners (N, 3) [m] and outward triangles (M, 3) around the corners of a part."""
    points = np.array(part.points or [(0.0, 0.0, 0.0)]) + part.centre
    for vector in part.straight:
        points = np.vstack((points - vector, points + vector))
    if part.round:
        points = (points[:, None, :] + _directions(len(part.round)) @ np.array(part.round)).reshape(-1, 3)
    return hull_triangles(points)


def _directions(dimensions: int) -> Floats:
    """Return unit vectors (N, dimensions) that are spread over a circle or a ball."""
    around = [2.0 * math.pi * k / (4 * _RINGS) for k in range(4 * _RINGS)]
    if dimensions < 3:
        return np.array([(math.cos(angle), math.sin(angle))[:dimensions] for angle in around])
    levels = [math.pi * k / (2 * _RINGS) for k in range(1, 2 * _RINGS)]
    ring = [
        (math.sin(t) * math.cos(p), math.sin(t) * math.sin(p), math.cos(t)) for t in levels for p in around
    ]
    return np.array([*ring, (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)])
