"""Polygons with holes as convex pieces, for places whose extent is not a rectangle.

The pieces are the trapezoids between the heights of corners (Chazelle and Incerpi 1984); those between the
same two edges are joined. A measure of the polygon is the sum, or the minimum, over its pieces.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Final, NamedTuple

from semmap.nodes.geometry.polygons import Point, Polygon, area, clipped, contains, distance

_Edge = tuple[Point, Point]
"""The lower end comes first."""


class Piece(NamedTuple):
    """A trapezoid with two level sides, or a triangle: counterclockwise corners, and their bounds."""

    low_x: float
    low_y: float
    high_x: float
    high_y: float
    corners: tuple[Point, ...]


class Region:
    """The area enclosed by rings on the floor plan [m]; inner rings are holes."""

    def __init__(self, rings: Sequence[Sequence[Point]]) -> None:
        self.pieces: Final[tuple[Piece, ...]] = tuple(_pieces(rings))
        """The pieces do not overlap."""
        self.area: Final = sum(area(piece.corners) for piece in self.pieces)

    def shared(self, polygon: Polygon, at: Point) -> float:
        """Return the area of the intersection with a convex polygon whose origin is `at` [m^2]."""
        return sum(area(clipped(moved, piece.corners)) for moved, piece in self._pieces_near(polygon, at))

    def contains(self, point: Point) -> bool:
        """Return whether a point lies in the region, including its borders."""
        x, y = point
        return any(
            piece.low_x <= x <= piece.high_x
            and piece.low_y <= y <= piece.high_y
            and contains(piece.corners, point)
            for piece in self.pieces
        )

    def distance(self, polygon: Polygon, at: Point) -> float:
        """Return the distance to a convex polygon whose origin is `at` [m]; 0 if they meet."""
        moved = [(x - at[0], y - at[1]) for x, y in polygon]
        return min((distance(moved, piece.corners) for piece in self.pieces), default=math.inf)

    def _pieces_near(self, polygon: Polygon, at: Point) -> list[tuple[list[Point], Piece]]:
        """Return a polygon in the region's frame, with each piece whose bounds intersect its own."""
        dx, dy = at
        moved = [(x - dx, y - dy) for x, y in polygon]
        xs, ys = zip(*moved, strict=True)
        x0, y0, x1, y1 = min(xs), min(ys), max(xs), max(ys)
        return [
            (moved, piece)
            for piece in self.pieces
            if piece.low_x < x1 and x0 < piece.high_x and piece.low_y < y1 and y0 < piece.high_y
        ]


def _pieces(rings: Sequence[Sequence[Point]]) -> list[Piece]:
    edges: list[_Edge] = []
    for ring in rings:
        for a, b in zip(ring, (*ring[1:], ring[0]), strict=True):
            if a[1] != b[1]:
                edges.append((a, b) if a[1] < b[1] else (b, a))
    edges.sort(key=lambda edge: edge[0][1])
    heights = sorted({y for ring in rings for _, y in ring})
    found: list[Piece] = []
    begun: dict[tuple[_Edge, _Edge], float] = {}
    crossing: list[_Edge] = []
    following = 0
    for low, high in pairwise(heights):
        crossing = [edge for edge in crossing if edge[1][1] > low]
        while following < len(edges) and edges[following][0][1] <= low:
            crossing.append(edges[following])
            following += 1
        middle = (low + high) / 2.0
        crossing.sort(key=lambda edge: _x_at(edge, middle))
        sides = list(zip(crossing[::2], crossing[1::2], strict=True))
        now = {pair: begun.get(pair, low) for pair in sides}
        found += [_piece(pair, start, low) for pair, start in begun.items() if pair not in now]
        begun = now
    top = heights[-1] if heights else 0.0
    return found + [_piece(pair, start, top) for pair, start in begun.items()]


def _x_at(edge: _Edge, y: float) -> float:
    (x0, y0), (x1, y1) = edge
    return x0 if y == y0 else x1 if y == y1 else x0 + (y - y0) * (x1 - x0) / (y1 - y0)


def _piece(sides: tuple[_Edge, _Edge], low: float, high: float) -> Piece:
    left, right = sides
    a, b = (_x_at(left, low), low), (_x_at(right, low), low)
    c, d = (_x_at(right, high), high), (_x_at(left, high), high)
    corners = tuple(dict.fromkeys((a, b, c, d)))
    return Piece(min(a[0], d[0]), low, max(b[0], c[0]), high, corners)
