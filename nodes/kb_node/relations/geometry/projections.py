"""Projections of upright parts onto the floor plan, and a lower bound of their overlap depth.

A projection is a disc or a parallelogram. An ellipse is replaced by its inscribed disc.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from semmap.nodes.geometry.polygons import Point
from semmap.schemas.entities import Vector

_SQUARE = 1e-9
"""The largest cosine of an angle that counts as right."""


class Projection(NamedTuple):
    """A parallelogram by half of each side [m], or a disc by its radius [m]."""

    sides: tuple[Point, ...]
    radius: float = 0.0


def project(level: Sequence[Vector], round_: Sequence[Vector]) -> Projection | None:
    """Return the projection of a part with these level vectors and an upright one.

    None if both or neither.
    """
    sides = tuple([(x, y) for x, y, _ in level])
    if len(sides) == 2 and not round_:
        return Projection(sides)
    if len(round_) != 2 or sides:
        return None
    (ax, ay, _), (bx, by, _) = round_
    squares, area = ax * ax + ay * ay + bx * bx + by * by, abs(ax * by - ay * bx)
    return Projection(
        (), math.sqrt(max(squares - math.sqrt(max(squares**2 - 4.0 * area**2, 0.0)), 0.0) / 2.0)
    )


def overlap_depth(x: float, y: float, one: Projection, other: Projection) -> float:
    """Return a lower bound of the distance by which two projections must be moved apart [m].

    `x` and `y` lead from the centre of `other` to that of `one`. Negative if they may be apart.
    """
    if one.sides and other.sides:
        return -max(_gap(x, y, side, (*one.sides, *other.sides)) for side in (*one.sides, *other.sides))
    if one.sides or other.sides:
        box, radius = (one, other.radius) if one.sides else (other, one.radius)
        (ux, uy), (vx, vy) = box.sides
        long, wide = math.hypot(ux, uy), math.hypot(vx, vy)
        if not abs(ux * vx + uy * vy) <= _SQUARE * long * wide or not long * wide:
            return -math.inf
        s = abs(x * ux + y * uy) / long - long
        t = abs(x * vx + y * vy) / wide - wide
        return radius - (math.hypot(max(s, 0.0), max(t, 0.0)) if s > 0.0 or t > 0.0 else max(s, t))
    return one.radius + other.radius - math.hypot(x, y)


def _gap(x: float, y: float, side: Point, sides: Sequence[Point]) -> float:
    """Return the gap of two parallelograms across one of their half sides."""
    nx, ny = -side[1], side[0]
    length = math.hypot(nx, ny)
    if not length:
        return math.inf
    return (abs(nx * x + ny * y) - sum([abs(nx * vx + ny * vy) for vx, vy in sides])) / length
