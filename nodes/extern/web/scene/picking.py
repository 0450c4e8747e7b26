"""Ray casting against the objects of the scene, for picking and for finding supports."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from semmap.schemas.entities import Pose, Size, Vector
from semmap.schemas.scenes import Surface

Floats = NDArray[np.float64]

_UPWARD: Final = 0.5
"""A surface supports objects if its normal is within 60 degrees of the vertical."""
_EPSILON: Final = 1e-9


class Solid(Struct, frozen=True):
    """An object that can be picked: its box, and its surface if it is known."""

    name: str
    pose: Pose
    size_m: Size
    surface: Surface | None = None


class Hit(Struct, frozen=True):
    """The point where a ray hits an object, or the floor (empty name), and the outward normal; map frame."""

    name: str
    at: Vector
    normal: Vector


def first_hit(origin: Vector, direction: Vector, solids: Iterable[Solid]) -> Hit | None:
    """Return the first hit of a ray with an object or the floor (z = 0); None without a hit."""
    start, ray = np.array(origin, dtype=float), np.array(direction, dtype=float)
    ray /= np.linalg.norm(ray)
    found: tuple[float, str, Floats] | None = None
    if ray[2] < -_EPSILON and start[2] > 0.0:
        found = (-start[2] / ray[2], "", np.array((0.0, 0.0, 1.0)))
    for solid in _candidates(start, ray, list(solids)):
        hit = _intersect(start, ray, solid)
        if hit is not None and (found is None or hit[0] < found[0]):
            found = (hit[0], solid.name, hit[1])
    if found is None:
        return None
    at = start + found[0] * ray
    return Hit(found[1], _vector(at), _vector(found[2]))


def is_level(hit: Hit) -> bool:
    """Return whether an object can be placed at the hit."""
    return hit.normal[2] > _UPWARD


def support_m(at: Vector, solids: Iterable[Solid]) -> float:
    """Return the height [m] of the surface below a point; 0 for the floor."""
    hit = first_hit(at, (0.0, 0.0, -1.0), solids)
    return 0.0 if hit is None else hit.at[2]


def _candidates(origin: Floats, direction: Floats, solids: list[Solid]) -> list[Solid]:
    """Return the objects whose bounding sphere the ray hits, computed for all objects together."""
    if not solids:
        return []
    sizes = np.array([solid.size_m for solid in solids])
    offsets = np.array([solid.pose.position_m for solid in solids]) - origin
    along = np.maximum(0.0, offsets @ direction)
    apart = np.linalg.norm(offsets - along[:, None] * direction, axis=1)
    reach = np.linalg.norm(sizes / (2.0, 2.0, 1.0), axis=1)  # from the bottom centre
    return [solids[row] for row in np.flatnonzero(apart <= reach).tolist()]


def _intersect(origin: Floats, direction: Floats, solid: Solid) -> tuple[float, Floats] | None:
    """Return the distance along the ray to an object, and the outward normal there in the map frame."""
    rotation = rotation_of(solid.pose)
    start = (origin - np.array(solid.pose.position_m)) @ rotation
    ray = direction @ rotation
    hit = _intersect_box(start, ray, np.array(solid.size_m))
    if hit is None:
        return None
    if solid.surface is not None:
        hit = _intersect_surface(start, ray, solid.surface)
        if hit is None:
            return None
    return hit[0], rotation @ hit[1]


def _intersect_box(start: Floats, ray: Floats, size: Floats) -> tuple[float, Floats] | None:
    """Return distance and normal for a box with the origin at its bottom centre, in its own frame."""
    low, high = np.array((-size[0] / 2, -size[1] / 2, 0.0)), np.array((size[0] / 2, size[1] / 2, size[2]))
    safe = np.where(np.abs(ray) < _EPSILON, _EPSILON, ray)
    distances = np.stack([(low - start) / safe, (high - start) / safe])
    enters, leaves = distances.min(axis=0), distances.max(axis=0)
    axis = int(enters.argmax())
    distance = float(enters[axis])
    if distance > leaves.min() or leaves.min() < 0.0:
        return None
    normal = np.zeros(3)
    normal[axis] = -np.sign(ray[axis])
    return max(0.0, distance), normal


def _intersect_surface(start: Floats, ray: Floats, surface: Surface) -> tuple[float, Floats] | None:
    """Return distance and normal for triangles, by the Möller-Trumbore algorithm, vectorized."""
    points = np.frombuffer(surface.points, "<f4").reshape(-1, 3).astype(float)
    corners = points[np.frombuffer(surface.triangles, "<u4").reshape(-1, 3)]
    a, ab, ac = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    across = np.cross(ray, ac)
    volume = np.einsum("ij,ij->i", ab, across)
    flat = np.abs(volume) < 1e-15
    inverse = 1.0 / np.where(flat, 1.0, volume)
    offset = start - a
    u = np.einsum("ij,ij->i", offset, across) * inverse
    along = np.cross(offset, ab)
    v = (along @ ray) * inverse
    distance = np.einsum("ij,ij->i", ac, along) * inverse
    is_hit = ~flat & (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (distance > _EPSILON)
    if not is_hit.any():
        return None
    row = int(np.where(is_hit, distance, np.inf).argmin())
    normal = np.cross(ab[row], ac[row])
    normal /= max(float(np.linalg.norm(normal)), _EPSILON)
    return float(distance[row]), normal if normal @ ray < 0.0 else -normal


def rotation_of(pose: Pose) -> Floats:
    """Return the rotation matrix (3, 3) from the frame of the object to the map frame."""
    w, x, y, z = pose.orientation_wxyz
    return np.array(
        [
            (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
        ]
    )


def corners_of(pose: Pose, size_m: Size) -> Floats:
    """Return the corners of the box of an object in the map frame, (8, 3) [m], the bottom ones first."""
    x, y, z = size_m
    own = np.array([(sx * x / 2, sy * y / 2, sz * z) for sz in (0, 1) for sx, sy in _ROUND])
    return np.asarray(own @ rotation_of(pose).T + np.array(pose.position_m))


_ROUND = ((-1, -1), (1, -1), (1, 1), (-1, 1))
_RING = ((0, 1), (1, 2), (2, 3), (3, 0))
_EDGES = np.array([*_RING, *((4 + a, 4 + b) for a, b in _RING), *((a, 4 + a) for a in range(4))])


def edges_of(pose: Pose, size_m: Size) -> NDArray[np.float32]:
    """Return the edges of the box of an object in the map frame, of shape (12, 2, 3) [m]."""
    return np.asarray(corners_of(pose, size_m)[_EDGES], dtype=np.float32)


def _vector(row: Floats) -> Vector:
    x, y, z = (float(value) for value in row)
    return (x, y, z)
