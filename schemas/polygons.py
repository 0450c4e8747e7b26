"""Polygons on the floor: the extents of places, in the format of GeoSPARQL's `wktLiteral`.

`POLYGON ((0 0, 4 0, 4 3, 0 3, 0 0), (1 1, 1 2, 2 2, 2 1, 1 1))`: metres in the map frame, the outer border
first, then holes. Polygons must be *simple*: no border crosses or touches itself or another one.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import Final, NamedTuple

from semmap.schemas.entities import REACH_M, Entity, Size
from semmap.schemas.errors import BadRequest

Point = tuple[float, float]
Ring = tuple[Point, ...]
"""Corners in order; the last one is connected to the first, which is not repeated."""
Bounds = tuple[float, float, float, float]
"""Least x and y, greatest x and y [m]."""

EXTENT: Final = "hasExtent"
"""The property of an extent."""
MOST_POINTS: Final = 500
"""The maximum number of corners of an extent, in all borders."""
HEIGHT_M: Final = 2.5
"""The default height of a place with an extent, if it has no size."""
_LEAST_AREA_M2: Final = 1e-4
_DIGITS: Final = 6
_FORM: Final = "write POLYGON ((x y, x y, x y, x y)), in metres of the map frame, ending where it begins"
_NO_AREA: Final = "a border of the extent encloses no area: it takes three corners that are not in line"
_POLYGON = re.compile(r"\s*POLYGON\s*\((.*)\)\s*", re.DOTALL | re.IGNORECASE)
_RING = re.compile(r"\s*\(([^()]*)\)\s*")


class Polygon(NamedTuple):
    """A simple polygon: its outer border counterclockwise, and its holes clockwise."""

    outer: Ring
    holes: tuple[Ring, ...] = ()

    @property
    def rings(self) -> tuple[Ring, ...]:
        """All borders, the outer one first."""
        return (self.outer, *self.holes)

    @property
    def bounds(self) -> Bounds:
        """The axis-aligned bounding rectangle."""
        xs, ys = zip(*self.outer, strict=True)
        return min(xs), min(ys), max(xs), max(ys)

    @property
    def area_m2(self) -> float:
        """The area without the holes."""
        return sum(map(signed_area, self.rings))

    def contains(self, point: Point) -> bool:
        """Return whether a point is inside; undefined for points on a border."""
        return sum(_is_in(point, ring) for ring in self.rings) % 2 == 1


def signed_area(ring: Sequence[Point]) -> float:
    """Return the area of a ring [m^2], negative if it is clockwise."""
    doubled = 0.0
    x0, y0 = ring[-1]
    for x, y in ring:
        doubled += x0 * y - x * y0
        x0, y0 = x, y
    return doubled / 2.0


@lru_cache(maxsize=1024)
def read_wkt(text: str) -> Polygon:
    """Parse a polygon in WKT. Raises BadRequest with the problem and the expected form."""
    match = _POLYGON.fullmatch(text)
    if match is None:
        if re.match(r"\s*<", text):
            raise BadRequest(
                f"an extent is in metres of the map frame and names no other reference system: {_FORM}"
            )
        kind = re.match(r"\s*([A-Za-z]+(?:\s+[ZMzm]{1,2}\b)?)", text)
        given = kind[1].upper() if kind else (text.strip()[:20] or "nothing")
        raise BadRequest(f"an extent is one POLYGON, not {given}: {_FORM}")
    rings: list[Ring] = []
    rest = match[1]
    while True:
        found = _RING.match(rest)
        if found is None:
            raise BadRequest(f"the extent has unbalanced parentheses: {_FORM}")
        rings.append(_ring(found[1]))
        rest = rest[found.end() :]
        if not rest:
            break
        if not rest.startswith(","):
            raise BadRequest(f"the borders of the extent are not separated by commas: {_FORM}")
        rest = rest[1:]
    return simple(rings)


def _ring(text: str) -> Ring:
    points: list[Point] = []
    for words in text.split(","):
        numbers = words.split()
        try:
            x, y = map(float, numbers)
        except ValueError:
            raise BadRequest(
                f"'{' '.join(numbers)[:40]}' is not a point of an extent, which is two numbers x y: {_FORM}"
            ) from None
        if not (abs(x) <= REACH_M and abs(y) <= REACH_M):  # also for NaN
            raise BadRequest(
                f"an extent lies within {REACH_M:g} m of the map's origin; ({x:g}, {y:g}) does not"
            )
        points.append((x, y))
    if points[0] != points[-1]:
        (x0, y0), (x1, y1) = points[0], points[-1]
        raise BadRequest(
            f"the border of the extent is not closed: it begins at {x0:g} {y0:g} and ends at {x1:g} {y1:g};"
            " repeat the first point at the end"
        )
    return tuple(points[:-1])


def simple(rings: Iterable[Sequence[Point]]) -> Polygon:
    """Return the polygon with these borders, the outer one first.

    Raises BadRequest if it is not simple, has no area, or has more than `MOST_POINTS` corners.
    """
    tidied = [_tidied(ring) for ring in rings]
    count = sum(map(len, tidied))
    if count > MOST_POINTS:
        raise BadRequest(f"the extent has {count} corners; the maximum is {MOST_POINTS}: simplify it")
    if any(len(ring) < 3 for ring in tidied):
        raise BadRequest(_NO_AREA)
    _require_apart(tidied)
    if any(abs(signed_area(ring)) < _LEAST_AREA_M2 for ring in tidied):
        raise BadRequest(_NO_AREA)
    outer, *holes = tidied
    for k, hole in enumerate(holes):
        if not _is_in(hole[0], outer):
            x, y = hole[0]
            raise BadRequest(f"a hole of the extent is outside of its outer border, at {x:g} {y:g}")
        if any(_is_in(hole[0], other) for other in holes[:k] + holes[k + 1 :]):
            raise BadRequest("a hole of the extent is inside another hole")
    return Polygon(_turned(outer, 1.0), tuple(_turned(hole, -1.0) for hole in holes))


def _tidied(ring: Sequence[Point]) -> Ring:
    """Return the ring without repeated corners."""
    rounded = [(round(x, _DIGITS) + 0.0, round(y, _DIGITS) + 0.0) for x, y in ring]
    return tuple(point for k, point in enumerate(rounded) if point != rounded[k - 1])


def _turned(ring: Ring, sign: float) -> Ring:
    return ring if signed_area(ring) * sign > 0.0 else ring[::-1]


class _Edge(NamedTuple):
    low_x: float
    high_x: float
    low_y: float
    high_y: float
    a: Point
    b: Point
    ring: int
    place: int


def _require_apart(rings: Sequence[Ring]) -> None:
    """Raise BadRequest if borders meet, except at common corners of adjacent edges."""
    edges = sorted(
        _Edge(min(a[0], b[0]), max(a[0], b[0]), min(a[1], b[1]), max(a[1], b[1]), a, b, number, place)
        for number, ring in enumerate(rings)
        for place, (a, b) in enumerate(zip(ring, (*ring[1:], ring[0]), strict=True))
    )
    open_: list[_Edge] = []
    for edge in edges:
        open_ = [other for other in open_ if other.high_x >= edge.low_x]
        for other in open_:
            if other.low_y <= edge.high_y and edge.low_y <= other.high_y and _meet(edge, other, rings):
                x, y = edge.a
                where = f"near {x:g} {y:g}"
                if edge.ring == other.ring:
                    raise BadRequest(f"the border of the extent crosses or touches itself {where}")
                raise BadRequest(f"two borders of the extent cross or touch {where}")
        open_.append(edge)


def _meet(one: _Edge, other: _Edge, rings: Sequence[Ring]) -> bool:
    """Return whether two edges meet at a point other than their common corner."""
    if one.ring == other.ring:
        count = len(rings[one.ring])
        step = (one.place - other.place) % count
        if step in (1, count - 1):  # adjacent edges share a corner, and overlap only if one turns back
            first, second = (other, one) if step == 1 else (one, other)
            if count == 3:
                return False
            (ax, ay), (bx, by), (cx, cy) = first.a, first.b, second.b
            ux, uy, vx, vy = bx - ax, by - ay, cx - bx, cy - by
            return ux * vy - uy * vx == 0.0 and ux * vx + uy * vy < 0.0
    p, q, r, s = one.a, one.b, other.a, other.b
    d1, d2, d3, d4 = _side(r, s, p), _side(r, s, q), _side(p, q, r), _side(p, q, s)
    if ((d1 > 0.0) != (d2 > 0.0)) and ((d3 > 0.0) != (d4 > 0.0)) and 0.0 not in (d1, d2, d3, d4):
        return True
    return any(
        side == 0.0 and _is_between(a, b, c)
        for side, a, b, c in ((d1, r, s, p), (d2, r, s, q), (d3, p, q, r), (d4, p, q, s))
    )


def _side(a: Point, b: Point, c: Point) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _is_between(a: Point, b: Point, c: Point) -> bool:
    return min(a[0], b[0]) <= c[0] <= max(a[0], b[0]) and min(a[1], b[1]) <= c[1] <= max(a[1], b[1])


def _is_in(point: Point, ring: Sequence[Point]) -> bool:
    """Return whether a point is in a ring, by the crossings of a ray along x."""
    px, py = point
    inside = False
    x0, y0 = ring[-1]
    for x, y in ring:
        if (y0 > py) != (y > py) and px < x0 + (py - y0) * (x - x0) / (y - y0):
            inside = not inside
        x0, y0 = x, y
    return inside


def wkt(polygon: Polygon) -> str:
    """Return the WKT of a polygon, with closed borders."""
    rings = (", ".join(f"{_number(x)} {_number(y)}" for x, y in (*ring, ring[0])) for ring in polygon.rings)
    return f"POLYGON ({', '.join(f'({ring})' for ring in rings)})"


def _number(value: float) -> str:
    text = f"{value:.{_DIGITS}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def extent_of(entity: Entity) -> Polygon | None:
    """Return the extent of a place that has one, or None."""
    text = entity.properties.get(EXTENT) if entity.place else None
    return known(text) if isinstance(text, str) else None


def known(text: str) -> Polygon | None:
    """Parse a polygon in WKT; None if it is invalid."""
    try:
        return read_wkt(text)
    except BadRequest:
        return None


def outline_of(entity: Entity) -> Polygon | None:
    """Return the footprint of an entity: its extent, or else the rotated rectangle of its size.

    It is None for an entity without a position or size.
    """
    if (extent := extent_of(entity)) is not None:
        return extent
    if entity.pose is None or entity.size_m is None:
        return None
    (x, y, _), (width, depth, _) = entity.pose.position_m, entity.size_m
    c, s = math.cos(entity.pose.yaw_rad), math.sin(entity.pose.yaw_rad)
    return Polygon(
        tuple(
            (x + c * u - s * w, y + s * u + c * w)
            for u, w in (
                (-width / 2, -depth / 2),
                (width / 2, -depth / 2),
                (width / 2, depth / 2),
                (-width / 2, depth / 2),
            )
        )
    )


def box_around(polygon: Polygon, z_m: float, height_m: float) -> tuple[tuple[float, float, float], Size]:
    """Return the bottom centre and the size [m] of the upright bounding box of a polygon."""
    x0, y0, x1, y1 = polygon.bounds
    centre = (round((x0 + x1) / 2, _DIGITS), round((y0 + y1) / 2, _DIGITS), z_m)
    return centre, (round(x1 - x0, _DIGITS), round(y1 - y0, _DIGITS), height_m)
