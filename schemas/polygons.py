"""Polygons on the floor: the extents of places, as GeoSPARQL's `wktLiteral` writes them.

`POLYGON ((0 0, 4 0, 4 3, 0 3, 0 0), (1 1, 1 2, 2 2, 2 1, 1 1))`: metres in the map frame, the outer border
first, then holes. What is read here is *simple*: no border crosses or touches itself or another.
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
"""Corners one after another; the last one is joined to the first, which is not repeated."""
Bounds = tuple[float, float, float, float]
"""Least x and y, greatest x and y [m]."""

EXTENT: Final = "hasExtent"
"""The property that an extent is stated by."""
MOST_POINTS: Final = 500
"""Corners that an extent may have, all borders together."""
HEIGHT_M: Final = 2.5
"""Of a place whose extent is a polygon, unless its size says how high it is."""
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
        """The smallest rectangle along the axes around it."""
        xs, ys = zip(*self.outer, strict=True)
        return min(xs), min(ys), max(xs), max(ys)

    @property
    def area_m2(self) -> float:
        """Without the holes."""
        return sum(map(signed_area, self.rings))

    def contains(self, point: Point) -> bool:
        """Whether a point lies in it; of one on a border that is not defined."""
        return sum(_is_in(point, ring) for ring in self.rings) % 2 == 1


def signed_area(ring: Sequence[Point]) -> float:
    """Area of a ring [m^2], negative if it is clockwise."""
    doubled = 0.0
    x0, y0 = ring[-1]
    for x, y in ring:
        doubled += x0 * y - x * y0
        x0, y0 = x, y
    return doubled / 2.0


@lru_cache(maxsize=1024)
def read_wkt(text: str) -> Polygon:
    """The polygon that WKT describes. Raises BadRequest, with what is wrong and how it is written."""
    match = _POLYGON.fullmatch(text)
    if match is None:
        if re.match(r"\s*<", text):
            raise BadRequest(
                f"an extent is in metres of the map frame and names no other reference system: {_FORM}"
            )
        kind = re.match(r"\s*([A-Za-z]+(?:\s+[ZMzm]{1,2}\b)?)", text)
        said = kind[1].upper() if kind else (text.strip()[:20] or "nothing")
        raise BadRequest(f"an extent is one POLYGON, not {said}: {_FORM}")
    rings: list[Ring] = []
    rest = match[1]
    while True:
        found = _RING.match(rest)
        if found is None:
            raise BadRequest(f"the parentheses of the extent do not match: {_FORM}")
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
        if not (abs(x) <= REACH_M and abs(y) <= REACH_M):  # nor is NaN
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
    """The polygon with these borders, the outer one first.

    Raises BadRequest unless it is simple, has an area, and is within `MOST_POINTS`.
    """
    tidied = [_tidied(ring) for ring in rings]
    count = sum(map(len, tidied))
    if count > MOST_POINTS:
        raise BadRequest(f"an extent has at most {MOST_POINTS} corners, and this one {count}; simplify it")
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
    """Without corners that repeat the one before."""
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
    """Raises BadRequest where borders meet, but for the corners that two edges of a ring have in common."""
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
    """Whether two edges have a point in common that they need not have."""
    if one.ring == other.ring:
        count = len(rings[one.ring])
        step = (one.place - other.place) % count
        if step in (1, count - 1):  # neighbours have a corner in common, and no more unless one turns back
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
    """By the crossings of a ray along x."""
    px, py = point
    inside = False
    x0, y0 = ring[-1]
    for x, y in ring:
        if (y0 > py) != (y > py) and px < x0 + (py - y0) * (x - x0) / (y - y0):
            inside = not inside
        x0, y0 = x, y
    return inside


def wkt(polygon: Polygon) -> str:
    """The WKT of a polygon, each border ending where it begins."""
    rings = (", ".join(f"{_number(x)} {_number(y)}" for x, y in (*ring, ring[0])) for ring in polygon.rings)
    return f"POLYGON ({', '.join(f'({ring})' for ring in rings)})"


def _number(value: float) -> str:
    text = f"{value:.{_DIGITS}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def extent_of(entity: Entity) -> Polygon | None:
    """The extent of a place whose extent is a polygon; None for any other entity."""
    text = entity.properties.get(EXTENT) if entity.place else None
    return known(text) if isinstance(text, str) else None


def known(text: str) -> Polygon | None:
    """The polygon that WKT describes; None for what does not describe one."""
    try:
        return read_wkt(text)
    except BadRequest:
        return None


def outline_of(entity: Entity) -> Polygon | None:
    """What an entity covers on the floor: its polygon, or else the rectangle of its size as it is turned.

    None for what has no position or no size.
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
    """The bottom centre and the size [m] of the upright box around a polygon."""
    x0, y0, x1, y1 = polygon.bounds
    centre = (round((x0 + x1) / 2, _DIGITS), round((y0 + y1) / 2, _DIGITS), z_m)
    return centre, (round(x1 - x0, _DIGITS), round(y1 - y0, _DIGITS), height_m)
