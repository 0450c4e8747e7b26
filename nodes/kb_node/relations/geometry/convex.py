"""Convex parts in the map, with the signed distance and contact normal of two of them.

Box, ball, cylinder and capsule have one representation. It is a Minkowski sum, around a centre, of segments
(`straight`), of an ellipsoid or disc (`round`) and, for meshes, of the hull of `points`. A part is rotated
or stretched by its vectors, and its support function along n has a closed form,

h(n) = n . centre + sum |n . straight_i| + sqrt(sum (n . round_j)^2) + max (n . point_k).

Along a unit vector n, a is -h_a(-n) - h_b(n) above b. The maximum over all n is the signed distance, and
the n of the maximum is the contact normal. This is the separating axis theorem (Gottschalk et al. 1996),
extended from boxes to round shapes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.geometry.polygons import Point, contains, hull
from semmap.nodes.kb_node.relations.geometry.face_planes import FacePlanes, find_planes
from semmap.nodes.kb_node.relations.geometry.lazy_property import lazy_property
from semmap.nodes.kb_node.relations.geometry.projections import Projection, overlap_depth, project
from semmap.schemas.entities import Vector

Floats = NDArray[np.float64]

DEEPEST_M = 0.005
"""A point deeper inside a flat top may be nearer to one of its sides."""


@dataclass(eq=False)
class Convex:
    """A convex part in the map frame [m], with its axis-aligned bounding box."""

    centre: Vector
    straight: tuple[Vector, ...]
    round: tuple[Vector, ...]
    points: tuple[Vector, ...]
    low: Vector
    high: Vector

    @lazy_property
    def contacts(self) -> dict[tuple[Convex, float], Contact]:
        """Return the cached contacts. Objects in a heap are compared again at every change of it."""
        return {}

    @lazy_property
    def lowest(self) -> Point:
        """Return the position of the lowest point on the floor plan, or the centre of a flat underside."""
        x, y, _ = self.centre
        for vx, vy, vz in self.straight:
            if abs(vz) > _LEVEL:
                side = 1.0 if vz > 0.0 else -1.0
                x, y = x - side * vx, y - side * vy
        if self.round and (reach := math.sqrt(sum(v[2] * v[2] for v in self.round))) > _LEVEL:
            x -= sum(v[0] * v[2] for v in self.round) / reach
            y -= sum(v[1] * v[2] for v in self.round) / reach
        if self.points:
            px, py, _ = min(self.points, key=lambda point: point[2])
            x, y = x + px, y + py
        return x, y

    @lazy_property
    def has_flat_top(self) -> bool:
        """Return whether the top is a level face that covers the whole projection."""
        upright = [v for v in self.straight if abs(v[2]) > _LEVEL]
        if len(upright) != 1 or self.points or any(abs(v[2]) > _LEVEL for v in self.round):
            return False
        return abs(upright[0][0]) < _LEVEL and abs(upright[0][1]) < _LEVEL

    @lazy_property
    def upright_projection(self) -> Projection | None:
        """Return the projection of an upright box or cylinder, or None."""
        if not self.has_flat_top:
            return None
        return project([v for v in self.straight if abs(v[2]) <= _LEVEL], self.round)

    @lazy_property
    def is_square(self) -> bool:
        """Return whether it is an axis-aligned box."""
        return (
            self.has_flat_top
            and not self.round
            and sum(abs(x) > _LEVEL for v in self.straight for x in v) == 3
        )

    @lazy_property
    def projection(self) -> tuple[Point, ...]:
        """Return the outline on the floor plan, counterclockwise. Round shapes become octagons.

        So do hulls of many corners.
        """
        cx, cy, _ = self.centre
        flat = [v for v in self.straight if abs(v[0]) > _LEVEL or abs(v[1]) > _LEVEL]
        if len(flat) == 2 and not self.round and not self.points:
            (ax, ay, _), (bx, by, _) = (
                flat if flat[0][0] * flat[1][1] > flat[0][1] * flat[1][0] else flat[::-1]
            )
            return (
                (cx - ax - bx, cy - ay - by),
                (cx + ax - bx, cy + ay - by),
                (cx + ax + bx, cy + ay + by),
                (cx - ax + bx, cy - ay + by),
            )
        if not flat and not self.points and self.round and all(abs(v[2]) < _LEVEL for v in self.round):
            (ax, ay, _), (bx, by, _) = self.round
            if ax * by < ay * bx:
                bx, by = -bx, -by
            return tuple((cx + c * ax + s * bx, cy + c * ay + s * by) for c, s in OCTAGON)
        if self.points and not (self.straight or self.round):
            corners = hull([(cx + x, cy + y) for x, y, _ in self.points])
            if len(corners) <= _MOST_CORNERS:
                return tuple(corners)
        return tuple(hull([self._find_furthest(x, y) for x, y in _COMPASS]))

    @lazy_property
    def lowest_top(self) -> float:
        """Return a height [m] below which no part of its upper side is: its top if that is level.

        A ball counts as level, because an object that stands on it is near its highest point.
        """
        return self.high[2] if self.has_flat_top or len(self.round) == 3 else self.low[2]

    @lazy_property
    def face_planes(self) -> FacePlanes:
        """Return the planes that bound it from above and from below."""
        return find_planes(self.straight, self.round, self.points)

    def find_heights(self, point: Point) -> tuple[float, float]:
        """Return the heights at which a vertical line enters and leaves the part [m].

        They are those of the whole part for a hull of many points, else those at the line, such as on the
        slope of a roof or a ramp.
        """
        low, high = self.low[2], self.high[2]
        if self.has_flat_top:
            return low, high
        cx, cy, cz = self.centre
        bottom, top = self.face_planes.find_heights(point[0] - cx, point[1] - cy)
        return max(low, cz + bottom), min(high, cz + top)

    def _find_furthest(self, nx: float, ny: float) -> Point:
        """Return the point on the floor plan that is furthest in a direction."""
        x, y, _ = self.centre
        for vx, vy, _ in self.straight:
            side = nx * vx + ny * vy
            if abs(side) > _LEVEL:
                x, y = x + math.copysign(vx, vx * side), y + math.copysign(vy, vy * side)
        along = [nx * v[0] + ny * v[1] for v in self.round]
        if self.round and (reach := math.hypot(*along)) > _LEVEL:
            x += _EQUAL_AREA * sum(share * v[0] for share, v in zip(along, self.round, strict=True)) / reach
            y += _EQUAL_AREA * sum(share * v[1] for share, v in zip(along, self.round, strict=True)) / reach
        if self.points:
            px, py, _ = max(self.points, key=lambda point: nx * point[0] + ny * point[1])
            x, y = x + px, y + py
        return x, y


@dataclass(eq=False)
class _Translated(Convex):
    """A translated copy of a part."""

    original: Convex
    x: float
    y: float

    @lazy_property
    def lowest(self) -> Point:
        x, y = self.original.lowest
        return self.x + x, self.y + y

    @property
    def face_planes(self) -> FacePlanes:
        return self.original.face_planes

    @property
    def has_flat_top(self) -> bool:
        return self.original.has_flat_top

    @property
    def upright_projection(self) -> Projection | None:
        return self.original.upright_projection

    @property
    def is_square(self) -> bool:
        return self.original.is_square

    @lazy_property
    def projection(self) -> tuple[Point, ...]:
        own_x, own_y = self.x, self.y
        return tuple([(own_x + x, own_y + y) for x, y in self.original.projection])


def translate(part: Convex, by: Vector) -> Convex:
    """Return the part translated by a vector."""
    x, y, z = by
    cx, cy, cz = part.centre
    x0, y0, z0 = part.low
    x1, y1, z1 = part.high
    return _Translated(
        (x + cx, y + cy, z + cz),
        part.straight,
        part.round,
        part.points,
        (x + x0, y + y0, z + z0),
        (x + x1, y + y1, z + z1),
        part,
        x,
        y,
    )


_LEVEL = 1e-6
_MOST_CORNERS = 16
_COMPASS = tuple((math.cos(k * math.pi / 4), math.sin(k * math.pi / 4)) for k in range(8))
_EQUAL_AREA = math.sqrt(math.pi / (2.0 * math.sqrt(2.0)))
"""Scales the corners of an octagon so that it has the area of the disc."""
OCTAGON = tuple((_EQUAL_AREA * x, _EQUAL_AREA * y) for x, y in _COMPASS)
"""Stands for a unit disc, counterclockwise."""


class Contact(NamedTuple):
    """The signed distance of two parts [m], negative if they overlap, and the unit contact normal."""

    distance: float
    normal: Vector


def _shift(point: Vector, vectors: tuple[Vector, ...], shares: tuple[float, ...]) -> Vector:
    x, y, z = point
    for share, (vx, vy, vz) in zip(shares, vectors, strict=True):
        x, y, z = x + share * vx, y + share * vy, z + share * vz
    return x, y, z


def find_face(part: Convex, direction: Vector, slack: float) -> list[Vector]:
    """Return the corners of the face, edge or vertex that is furthest in a direction (a unit vector).

    Edges and discs whose angle to the face has at most the sine `slack` belong to it. A disc becomes an
    octagon.
    """
    nx, ny, nz = direction
    corners = [part.centre]
    for vx, vy, vz in part.straight:
        along = nx * vx + ny * vy + nz * vz
        signs = (1.0, -1.0) if abs(along) <= slack * math.hypot(vx, vy, vz) else (math.copysign(1.0, along),)
        corners = [(x + k * vx, y + k * vy, z + k * vz) for x, y, z in corners for k in signs]
    if part.round:
        along_each = [nx * x + ny * y + nz * z for x, y, z in part.round]
        reach = math.hypot(*along_each)
        shares: list[tuple[float, ...]]
        if len(part.round) == 2 and reach <= slack * max(math.hypot(*vector) for vector in part.round):
            shares = [(math.cos(k * math.pi / 4), math.sin(k * math.pi / 4)) for k in range(8)]
        else:
            shares = [tuple(along / reach for along in along_each)]
        corners = [_shift(corner, part.round, share) for corner in corners for share in shares]
    if part.points:
        heights = [nx * x + ny * y + nz * z for x, y, z in part.points]
        most = max(heights)
        furthest = part.points[heights.index(most)]
        kept = [
            point
            for point, height in zip(part.points, heights, strict=True)
            if most - height <= slack * math.dist(point, furthest) + _LEVEL
        ]
        corners = [(x + a, y + b, z + c) for x, y, z in corners for a, b, c in kept]
    return corners


UP: Vector = (0.0, 0.0, 1.0)
DOWN: Vector = (0.0, 0.0, -1.0)
_SURE_M = 1e-6
"""Smaller differences of depth are ignored."""


def make_convex(
    centre: Vector, straight: tuple[Vector, ...], round_: tuple[Vector, ...], points: tuple[Vector, ...] = ()
) -> Convex:
    """Return a part with its bounding box."""
    cx, cy, cz = centre
    rx = ry = rz = 0.0
    for x, y, z in straight:
        rx += abs(x)
        ry += abs(y)
        rz += abs(z)
    if round_:
        sx = sy = sz = 0.0
        for x, y, z in round_:
            sx += x * x
            sy += y * y
            sz += z * z
        rx += math.sqrt(sx)
        ry += math.sqrt(sy)
        rz += math.sqrt(sz)
    low, high = (cx - rx, cy - ry, cz - rz), (cx + rx, cy + ry, cz + rz)
    if points:
        ends = [(min(along), max(along)) for along in zip(*points, strict=True)]
        low = tuple(a + end[0] for a, end in zip(low, ends, strict=True))
        high = tuple(a + end[1] for a, end in zip(high, ends, strict=True))
    return Convex(centre, straight, round_, points, low, high)


def over_flat_top(upper: Convex, lower: Convex) -> bool:
    """Return whether the lowest point of one part is over the flat top of another.

    Then the normal is vertical.
    """
    if upper.low[2] < lower.high[2] - DEEPEST_M or not lower.has_flat_top:
        return False
    if not lower.is_square:
        return contains(lower.projection, upper.lowest)
    x, y = upper.lowest
    return lower.low[0] <= x <= lower.high[0] and lower.low[1] <= y <= lower.high[1]


def contact(one: Convex, other: Convex, most: float = math.inf) -> Contact:
    """Return the signed distance of two parts [m], and the normal from `other` to `one`.

    If they are further apart than `most`, the distance is only a lower bound above `most`.
    """
    if one.is_square and other.is_square:
        return _compare_boxes(one, other)
    if (upright := _find_vertical_contact(one, other)) is not None:
        return upright
    known = one.contacts.get((other, most))
    if known is None:
        known = one.contacts[other, most] = _search_contact(one, other, most)
    return known


def _find_vertical_contact(one: Convex, other: Convex) -> Contact | None:
    """Return the contact of two upright parts if its normal is vertical, else None.

    It is vertical if the projections overlap more deeply. For prisms, a tilted normal never gives a greater
    distance than the vertical and the horizontal one.
    """
    its, their = one.upright_projection, other.upright_projection
    if its is None or their is None:
        return None
    (x, y, z), (a, b, c) = one.centre, other.centre
    gap = one.low[2] - other.high[2] if z >= c else other.low[2] - one.high[2]
    if overlap_depth(x - a, y - b, its, their) < max(-gap, 0.0) + _SURE_M:
        return None
    return Contact(gap, UP if z >= c else DOWN)


def _search_contact(one: Convex, other: Convex, most: float) -> Contact:
    """Return the contact of any two parts, by search along ever finer directions around the best one."""
    offset = np.subtract(one.centre, other.centre)
    straight = np.array([*one.straight, *other.straight]).reshape(-1, 3).T
    rounds = [np.array(r).T for r in (one.round, other.round) if r]
    hulls = [sign * np.array(p).T for sign, p in ((-1.0, one.points), (1.0, other.points)) if p]

    def apart(normals: Floats) -> Floats:
        """Return the (N,) distances along (N, 3) unit normals."""
        found: Floats = normals @ offset - np.abs(normals @ straight).sum(axis=1)
        for vectors in rounds:
            found -= np.sqrt(((normals @ vectors) ** 2).sum(axis=1))
        for points in hulls:
            found -= (normals @ points).max(axis=1)
        return found

    normals = np.concatenate([_SPHERE, _exact_normals(one, other)])
    distances = apart(normals)
    best = int(distances.argmax())
    normal, distance = normals[best], float(distances[best])
    for width in _WIDTHS:
        if distance > most:
            break
        tried = normal + width * (_PATCH @ _perpendiculars(normal))
        tried /= np.sqrt((tried * tried).sum(axis=1))[:, None]
        distances = apart(tried)
        best = int(distances.argmax())
        if distances[best] > distance:
            normal, distance = tried[best], float(distances[best])
    return Contact(distance, (float(normal[0]), float(normal[1]), float(normal[2])))


def _perpendiculars(normal: Floats) -> Floats:
    """Return two unit vectors perpendicular to a unit normal and to each other: (2, 3)."""
    x, y, z = normal.tolist()
    if abs(x) <= abs(y) and abs(x) <= abs(z):
        ax, ay, az = 0.0, z, -y
    elif abs(y) <= abs(z):
        ax, ay, az = -z, 0.0, x
    else:
        ax, ay, az = y, -x, 0.0
    length = math.sqrt(ax * ax + ay * ay + az * az)
    ax, ay, az = ax / length, ay / length, az / length
    return np.array([(ax, ay, az), (y * az - z * ay, z * ax - x * az, x * ay - y * ax)])


def _compare_boxes(one: Convex, other: Convex) -> Contact:
    """Return the contact of two axis-aligned boxes."""
    (x0, y0, z0), (x1, y1, z1), (x, y, z) = one.low, one.high, one.centre
    (a0, b0, c0), (a1, b1, c1), (a, b, c) = other.low, other.high, other.centre
    dx, dy, dz = max(x0 - a1, a0 - x1), max(y0 - b1, b0 - y1), max(z0 - c1, c0 - z1)
    least = max(dx, dy, dz)
    if least > 0.0:
        dx, dy, dz = max(dx, 0.0), max(dy, 0.0), max(dz, 0.0)
        distance = length = math.hypot(dx, dy, dz)
    else:
        along = 0 if dx == least else 1 if dy == least else 2
        dx, dy, dz = float(along == 0), float(along == 1), float(along == 2)
        distance, length = least, 1.0
    away = math.copysign
    return Contact(distance, (away(dx / length, x - a), away(dy / length, y - b), away(dz / length, z - c)))


def _exact_normals(one: Convex, other: Convex) -> Floats:
    """Return the candidate normals of faces and pairs of straight edges: (N, 3)."""
    first = [*_faces(one), *_faces(other), *((a, b) for a in one.straight for b in other.straight)]
    if not first:
        return _AXES
    ax, ay, az, bx, by, bz = np.array(first).reshape(-1, 6).T
    found = np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=1)
    lengths = np.sqrt((found * found).sum(axis=1))
    kept = lengths > 1e-12
    found = found[kept] / lengths[kept, None]
    return np.concatenate([found, -found])


def _faces(part: Convex) -> list[tuple[Vector, Vector]]:
    """Return two vectors in each flat face."""
    if len(part.straight) == 3:
        a, b, c = part.straight
        return [(a, b), (b, c), (c, a)]
    return [(part.round[0], part.round[1])] if len(part.round) == 2 else []


def _sphere(count: int) -> Floats:
    """Return evenly spread unit vectors (golden spiral): (count, 3)."""
    k = np.arange(count)
    z = 1.0 - (2.0 * k + 1.0) / count
    turn = k * math.pi * (3.0 - math.sqrt(5.0))
    ring = np.sqrt(1.0 - z * z)
    return np.stack([ring * np.cos(turn), ring * np.sin(turn), z], axis=1)


_AXES = np.eye(3)
_SPHERE = np.concatenate([_sphere(324), _AXES, -_AXES])
"""Start directions of the search, at most 11 degrees apart."""
_WIDTHS = tuple(math.tan(math.radians(degrees)) for degrees in (8.0, 2.5, 0.8, 0.25, 0.08, 0.025))
"""Successive search widths around the best normal."""
_PATCH = np.array([(a / 3.0, b / 3.0) for a in range(-3, 4) for b in range(-3, 4)])
