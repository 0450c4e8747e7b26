"""Triangulation of polygons on the floor, for 3-D renderers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.geometry.regions import Region
from semmap.schemas.polygons import Polygon


def triangles_of(polygon: Polygon) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Return corners (N, 2) [m] and counterclockwise triangles (M, 3) that cover a polygon without its holes.

    The corners are relative to the centre of its bounds, which is the position of a place with this extent.
    """
    x0, y0, x1, y1 = polygon.bounds
    points: list[tuple[float, float]] = []
    triangles: list[tuple[int, int, int]] = []
    for piece in Region(polygon.rings).pieces:
        first = len(points)
        points += piece.corners
        triangles += [(first, first + k, first + k + 1) for k in range(1, len(piece.corners) - 1)]
    around = np.array(points) - ((x0 + x1) / 2.0, (y0 + y1) / 2.0)
    return around.astype(np.float32), np.array(triangles, dtype=np.uint32)
