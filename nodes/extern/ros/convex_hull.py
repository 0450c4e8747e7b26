"""The convex hull of points in space, as triangles."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_FLAT: Final = 1e-6
"""Share of the extent by which a flat set of points is thickened, and within which a point is on a face."""


def hull_triangles(points: Floats) -> tuple[Floats, NDArray[Any]]:
    """Return the corners (N, 3) of the hull and its triangles (M, 3), counterclockwise from outside.

    Points in one plane, on one line or at one place get a thickness of a millionth of their extent.
    """
    points = np.unique(np.asarray(points, dtype=float), axis=0)
    extent = max(float(np.ptp(points, axis=0).max()), _FLAT)
    points, start = _add_thickness(points, _FLAT * extent)
    faces = _grow(points, start, 0.01 * _FLAT * extent)
    used, rows = np.unique(faces, return_inverse=True)
    return points[used], rows.reshape(-1, 3)


def _add_thickness(points: Floats, least: float) -> tuple[Floats, list[int]]:
    """Return the points and the rows of four that span a volume, adding points where all are in a plane."""
    rows = [int(np.argmin(points[:, 0]))]
    axes: list[Floats] = []
    for _ in range(3):
        rest = points - points[rows[0]]
        for axis in axes:
            rest = rest - np.outer(rest @ axis, axis)
        lengths = np.linalg.norm(rest, axis=1)
        furthest = int(np.argmax(lengths))
        if lengths[furthest] > least:
            axes.append(rest[furthest] / lengths[furthest])
        else:
            axes.append(_across(axes))
            points = np.vstack((points, points[rows[0]] + 2.0 * least * axes[-1]))
            furthest = len(points) - 1
        rows.append(furthest)
    return points, rows


def _across(axes: list[Floats]) -> Floats:
    """Return a unit vector at right angles to these."""
    candidates = [axis - sum((axis @ a) * a for a in axes) for axis in np.eye(3)]
    longest = max(candidates, key=lambda vector: float(vector @ vector))
    found: Floats = longest / np.linalg.norm(longest)
    return found


def _grow(points: Floats, start: list[int], within: float) -> NDArray[Any]:
    """Return the faces of the hull: each point outside replaces the faces that it sees by a cone."""
    middle = points[start].mean(axis=0)
    a, b, c, d = start
    faces = np.array(
        [_outward(points, middle, face) for face in ((a, b, c), (a, b, d), (a, c, d), (b, c, d))]
    )
    for row in range(len(points)):
        corners = points[faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        lengths = np.linalg.norm(normals, axis=1)
        heights = np.einsum("ij,ij->i", normals, points[row] - corners[:, 0])
        seen = heights > within * lengths
        if not seen.any():
            continue
        edges = {(int(face[k]), int(face[(k + 1) % 3])) for face in faces[seen] for k in range(3)}
        rim = [(first, last) for first, last in edges if (last, first) not in edges]
        cone = np.array([(first, last, row) for first, last in rim])
        faces = np.vstack((faces[~seen], cone))
    return faces


def _outward(points: Floats, middle: Floats, face: tuple[int, int, int]) -> tuple[int, int, int]:
    a, b, c = face
    normal = np.cross(points[b] - points[a], points[c] - points[a])
    return face if normal @ (points[a] - middle) > 0.0 else (a, c, b)
