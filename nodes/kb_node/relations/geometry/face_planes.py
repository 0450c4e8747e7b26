"""Planes above and below a convex part, for the heights at which a vertical line meets it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from semmap.schemas.entities import Vector

_STEEPEST: Final = 0.02
"""The least vertical component of the normal of a plane. Walls bound no height."""
_MOST_POINTS: Final = 24
"""The largest number of points of a hull whose faces are searched."""
_AROUND: Final = 24
"""The number of directions around an axis, such as that of a tilted cylinder."""
_ROUNDING_M: Final = 1e-6

Plane = tuple[float, float, float]
"""Slope along x, slope along y, and height at the centre [m]."""
_Floats = NDArray[np.float64]


class FacePlanes(NamedTuple):
    """The planes that bound a part from above and from below, relative to its centre."""

    above: tuple[Plane, ...]
    below: tuple[Plane, ...]

    def find_heights(self, x: float, y: float) -> tuple[float, float]:
        """Return the heights at which a vertical line enters and leaves the part [m].

        They are exact for boxes and for hulls of few points, and up to a percent too far apart for round
        parts.
        """
        return (
            max([height + along * x + across * y for along, across, height in self.below]),
            min([height + along * x + across * y for along, across, height in self.above]),
        )


def find_planes(straight: Sequence[Vector], round_: Sequence[Vector], points: Sequence[Vector]) -> FacePlanes:
    """Return the planes of a part given by its segments, its ellipsoid or disc, and its points."""
    normals = np.concatenate([_UPRIGHT, *_list_normals(straight, round_, points)])
    lengths = np.sqrt((normals * normals).sum(axis=1))
    normals = normals[lengths > 1e-12] / lengths[lengths > 1e-12, None]
    normals = np.unique(np.concatenate([normals, -normals]).round(9), axis=0)
    reach = np.zeros(len(normals))
    if straight:
        reach += np.abs(normals @ np.array(straight).T).sum(axis=1)
    if round_:
        reach += np.sqrt(((normals @ np.array(round_).T) ** 2).sum(axis=1))
    if points:
        reach += (normals @ np.array(points).T).max(axis=1)
    x, y, z = normals.T
    return FacePlanes(
        _list_planes(x, y, z, reach, z > _STEEPEST), _list_planes(x, y, z, reach, z < -_STEEPEST)
    )


def _list_planes(
    x: _Floats, y: _Floats, z: _Floats, reach: _Floats, kept: NDArray[np.bool_]
) -> tuple[Plane, ...]:
    """Return the planes with the `kept` normals (x, y, z), at a distance `reach` from the centre."""
    x, y, z, reach = x[kept], y[kept], z[kept], reach[kept]
    return tuple(zip((-x / z).tolist(), (-y / z).tolist(), (reach / z).tolist(), strict=True))


def _list_normals(
    straight: Sequence[Vector], round_: Sequence[Vector], points: Sequence[Vector]
) -> list[_Floats]:
    """Return the normals of flat faces, and directions perpendicular to the segments of round parts."""
    found = [np.cross(one, other)[None] for one, other in combinations(straight, 2)]
    if len(round_) == 2:
        found.append(np.cross(round_[0], round_[1])[None])
    if round_:
        found += [_around(np.array(segment)) for segment in straight]
    if points and not straight and not round_ and len(points) <= _MOST_POINTS:
        found.append(_face_normals(np.array(points)))
    return found


def _around(axis: _Floats) -> _Floats:
    """Return directions perpendicular to an axis, with the steepest one among them."""
    level = np.cross(axis, (0.0, 0.0, 1.0))
    if not level.any():
        return np.empty((0, 3))
    level /= np.linalg.norm(level)
    upright = np.cross(level, axis)
    upright /= np.linalg.norm(upright)
    angles = np.arange(_AROUND)[:, None] * np.pi / _AROUND
    found: _Floats = np.sin(angles) * level + np.cos(angles) * upright
    return found


def _face_normals(points: _Floats) -> _Floats:
    """Return the normals (N, 3) of planes through three of the points with all points on one side."""
    triples = np.array(list(combinations(range(len(points)), 3))).reshape(-1, 3)
    a, b, c = (points[triples[:, corner]] for corner in range(3))
    normals = np.cross(b - a, c - a)
    lengths = np.sqrt((normals * normals).sum(axis=1))
    normals, a = normals[lengths > 1e-12], a[lengths > 1e-12]
    normals /= lengths[lengths > 1e-12, None]
    heights = normals @ points.T - (normals * a).sum(axis=1)[:, None]
    is_face = (heights <= _ROUNDING_M).all(axis=1) | (heights >= -_ROUNDING_M).all(axis=1)
    found: _Floats = normals[is_face]
    return found


_UPRIGHT: Final = np.array([(0.0, 0.0, 1.0)])
