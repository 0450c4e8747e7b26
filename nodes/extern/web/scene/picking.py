"""Where a ray meets what is in the scene: places that are pointed at, and what is under a point."""

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
"""A surface is one to put things on if its normal is within 60 degrees of the vertical."""
_EPSILON: Final = 1e-9


class Solid(Struct, frozen=True):
    """A thing that may be pointed at: its box, and its surface where that is known."""

    name: str
    pose: Pose
    size_m: Size
    surface: Surface | None = None


class Hit(Struct, frozen=True):
    """Where a ray meets a thing (with an empty name: the floor), and the outward normal there, map frame."""

    name: str
    at: Vector
    normal: Vector


def first_hit(origin: Vector, direction: Vector, solids: Iterable[Solid]) -> Hit | None:
    """What a ray meets first, the floor (z = 0) included; None for one that goes up into the open."""
    start, way = np.array(origin, dtype=float), np.array(direction, dtype=float)
    way /= np.linalg.norm(way)
    found: tuple[float, str, Floats] | None = None
    if way[2] < -_EPSILON and start[2] > 0.0:
        found = (-start[2] / way[2], "", np.array((0.0, 0.0, 1.0)))
    for solid in _near(start, way, list(solids)):
        met = _meets(start, way, solid)
        if met is not None and (found is None or met[0] < found[0]):
            found = (met[0], solid.name, met[1])
    if found is None:
        return None
    at = start + found[0] * way
    return Hit(found[1], _vector(at), _vector(found[2]))


def is_level(hit: Hit) -> bool:
    """May a thing be put down there?"""
    return hit.normal[2] > _UPWARD


def support_m(at: Vector, solids: Iterable[Solid]) -> float:
    """The height [m] of what is straight below a point: a thing's surface, or the floor at 0."""
    hit = first_hit(at, (0.0, 0.0, -1.0), solids)
    return 0.0 if hit is None else hit.at[2]


def _near(origin: Floats, direction: Floats, solids: list[Solid]) -> list[Solid]:
    """Those whose bounding ball a ray meets; a few of many, told by a few operations on all."""
    if not solids:
        return []
    sizes = np.array([solid.size_m for solid in solids])
    offsets = np.array([solid.pose.position_m for solid in solids]) - origin
    along = np.maximum(0.0, offsets @ direction)
    apart = np.linalg.norm(offsets - along[:, None] * direction, axis=1)
    reach = np.linalg.norm(sizes / (2.0, 2.0, 1.0), axis=1)  # from the bottom centre
    return [solids[row] for row in np.flatnonzero(apart <= reach).tolist()]


def _meets(origin: Floats, direction: Floats, solid: Solid) -> tuple[float, Floats] | None:
    """How far along a ray it meets a solid, and the outward normal there, in the map frame."""
    rotation = rotation_of(solid.pose)
    start = (origin - np.array(solid.pose.position_m)) @ rotation
    way = direction @ rotation
    box = _meets_box(start, way, np.array(solid.size_m))
    if box is None:
        return None
    if solid.surface is not None:
        box = _meets_surface(start, way, solid.surface)
        if box is None:
            return None
    return box[0], rotation @ box[1]


def _meets_box(start: Floats, way: Floats, size: Floats) -> tuple[float, Floats] | None:
    """The same of a box that stands on the origin, in its own frame."""
    low, high = np.array((-size[0] / 2, -size[1] / 2, 0.0)), np.array((size[0] / 2, size[1] / 2, size[2]))
    safe = np.where(np.abs(way) < _EPSILON, _EPSILON, way)
    ways = np.stack([(low - start) / safe, (high - start) / safe])
    enters, leaves = ways.min(axis=0), ways.max(axis=0)
    axis = int(enters.argmax())
    distance = float(enters[axis])
    if distance > leaves.min() or leaves.min() < 0.0:
        return None
    normal = np.zeros(3)
    normal[axis] = -np.sign(way[axis])
    return max(0.0, distance), normal


def _meets_surface(start: Floats, way: Floats, surface: Surface) -> tuple[float, Floats] | None:
    """The same of triangles, by Möller and Trumbore's test, all at once."""
    points = np.frombuffer(surface.points, "<f4").reshape(-1, 3).astype(float)
    corners = points[np.frombuffer(surface.triangles, "<u4").reshape(-1, 3)]
    a, ab, ac = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    across = np.cross(way, ac)
    volume = np.einsum("ij,ij->i", ab, across)
    flat = np.abs(volume) < 1e-15
    inverse = 1.0 / np.where(flat, 1.0, volume)
    offset = start - a
    u = np.einsum("ij,ij->i", offset, across) * inverse
    along = np.cross(offset, ab)
    v = (along @ way) * inverse
    distance = np.einsum("ij,ij->i", ac, along) * inverse
    met = ~flat & (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (distance > _EPSILON)
    if not met.any():
        return None
    row = int(np.where(met, distance, np.inf).argmin())
    normal = np.cross(ab[row], ac[row])
    normal /= max(float(np.linalg.norm(normal)), _EPSILON)
    return float(distance[row]), normal if normal @ way < 0.0 else -normal


def rotation_of(pose: Pose) -> Floats:
    """(3, 3): the map from the thing's frame."""
    w, x, y, z = pose.orientation_wxyz
    return np.array(
        [
            (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
        ]
    )


def corners_of(pose: Pose, size_m: Size) -> Floats:
    """(8, 3) [m]: the corners of a thing's box in the map frame, the four at the bottom first."""
    x, y, z = size_m
    own = np.array([(sx * x / 2, sy * y / 2, sz * z) for sz in (0, 1) for sx, sy in _ROUND])
    return np.asarray(own @ rotation_of(pose).T + np.array(pose.position_m))


_ROUND = ((-1, -1), (1, -1), (1, 1), (-1, 1))
_RING = ((0, 1), (1, 2), (2, 3), (3, 0))
_EDGES = np.array([*_RING, *((4 + a, 4 + b) for a, b in _RING), *((a, 4 + a) for a in range(4))])


def edges_of(pose: Pose, size_m: Size) -> NDArray[np.float32]:
    """(12, 2, 3) [m]: the edges of a thing's box in the map frame."""
    return np.asarray(corners_of(pose, size_m)[_EDGES], dtype=np.float32)


def _vector(row: Floats) -> Vector:
    x, y, z = (float(value) for value in row)
    return (x, y, z)
