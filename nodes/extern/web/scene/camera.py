"""Cameras: the initial view of a map, projection, and the selection of labels that do not overlap."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import Final

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from semmap.nodes.extern.web.scene.picking import corners_of
from semmap.nodes.geometry.outliers import find_near
from semmap.schemas.entities import Entity, Vector
from semmap.schemas.relations import ViewPoint

Floats = NDArray[np.float64]

FOV_RAD: Final = math.radians(40.0)
"""Vertical field of view of the initial view."""
_TILT_RAD: Final = math.radians(52.0)
_MARGIN: Final = 1.06
_FARTHEST_M: Final = 200.0
_UNKNOWN_SIZE_M: Final = (0.1, 0.1, 0.1)
_LABEL_PX: Final = 17.0
_LETTER_PX: Final = 7.0
_CAPITAL_PX: Final = 10.0
_NEAREST_M: Final = 0.05


class View(Struct, frozen=True):
    """A pinhole camera: position [m], orientation of the optical frame, and image size.

    In the optical frame x is right, y down, and z ahead.
    """

    position_m: Vector
    wxyz: tuple[float, float, float, float]
    fov_rad: float
    width: float
    height: float

    def project(self, points: Floats) -> Floats:
        """Return the pixel x, pixel y and depth [m] of points (N, 3) [m], as an array (N, 3)."""
        w, x, y, z = self.wxyz
        rotation = np.array(
            [
                (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
                (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
                (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
            ]
        )
        own = (points - np.array(self.position_m)) @ rotation
        focal = self.height / 2.0 / math.tan(self.fov_rad / 2.0)
        ahead = np.where(np.abs(own[:, 2]) < 1e-6, 1e-6, own[:, 2])
        return np.column_stack(
            [
                self.width / 2.0 + focal * own[:, 0] / ahead,
                self.height / 2.0 + focal * own[:, 1] / ahead,
                own[:, 2],
            ]
        )

    @property
    def viewpoint(self) -> ViewPoint:
        """The position [m] and the heading about the z axis of the map [rad]."""
        w, x, y, z = self.wxyz
        ahead = (2 * (x * z + w * y), 2 * (y * z - w * x))
        up = (-2 * (x * y - w * z), -(1 - 2 * (x * x + z * z)))
        east, north = ahead if math.hypot(*ahead) > 0.05 else up  # straight down: the upper edge of the image
        px, py, pz = self.position_m
        return (px, py, pz, math.atan2(north, east))


def extent(entities: Iterable[Entity]) -> Floats:
    """Return the corners (N, 3) [m] of all entities with a pose, without distant outliers."""
    points = np.array(
        [
            corners_of(entity.pose, entity.size_m or _UNKNOWN_SIZE_M)
            for entity in entities
            if entity.pose is not None
        ]
    ).reshape(-1, 8, 3)
    return np.asarray(points[find_near(points.mean(axis=1))].reshape(-1, 3))


def first_view(points: Floats, aspect: float) -> tuple[Vector, Vector]:
    """Return the position and the target [m] of a view of all `points` (N, 3), from the south and above.

    `aspect` is the width of the image divided by its height.
    """
    if not len(points):
        points = np.array([(-2.0, -2.0, 0.0), (2.0, 2.0, 1.0)])
    return fit_view(points, aspect, (0.0, -math.cos(_TILT_RAD), math.sin(_TILT_RAD)))


def fit_view(points: Floats, aspect: float, back: Vector) -> tuple[Vector, Vector]:
    """Return the position and the target [m] of a view of all `points` (N, 3), at least one.

    `back` points from the target to the camera; its length does not matter. `aspect` is as in `first_view`.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (low + high) / 2.0
    back_axis = np.array(back) / max(float(np.linalg.norm(back)), _NEAREST_M)
    x, y, _ = back_axis
    level = math.hypot(x, y)
    right = np.array((-y / level, x / level, 0.0)) if level > 1e-6 else np.array((1.0, 0.0, 0.0))
    up = np.cross(back_axis, right)
    own = np.array(list(itertools.product(*zip(low, high, strict=True)))) - middle
    slope = math.tan(FOV_RAD / 2.0)
    distances = own @ back_axis + np.maximum(np.abs(own @ up), np.abs(own @ right) / aspect) / slope
    distance = min(_FARTHEST_M, max(1.5, float(distances.max()) * _MARGIN))
    eye = middle + distance * back_axis
    return _vector(eye), _vector(middle)


def select_labels(
    view: View, labels: Mapping[str, tuple[str, Vector]], first: Iterable[str] = (), most: int = 40
) -> list[str]:
    """Return the keys of at most `most` labels that do not overlap in the image.

    A label is a text and its position [m]. Those in `first` have precedence, in their order, and then the
    nearest.
    """
    if not labels:
        return []
    keys, ranks = list(labels), {key: rank for rank, key in enumerate(first)}
    at = view.project(np.array([place for _, place in labels.values()], dtype=float))
    x, y, ahead = at.T
    halves = np.array([_width_px(text) / 2.0 + 5.0 for text, _ in labels.values()])
    is_whole = (x >= halves) & (x <= view.width - halves)  # not cut off at the edge
    rows = np.flatnonzero((ahead > _NEAREST_M) & is_whole & (y >= 0.0) & (y <= view.height))
    order = [ranks.get(keys[row], len(ranks)) for row in rows]
    rows = rows[np.lexsort((ahead[rows], order))]
    half = halves[rows]
    left, right, top = x[rows] - half, x[rows] + half, y[rows] - _LABEL_PX
    chosen: list[str] = []
    is_free = np.ones(len(rows), dtype=bool)
    while is_free.any() and len(chosen) < most:
        this = int(is_free.argmax())
        chosen.append(keys[rows[this]])
        is_separate_x = (left >= right[this]) | (right <= left[this])
        is_separate_y = np.abs(top - top[this]) >= _LABEL_PX  # all labels have the same height
        is_free &= is_separate_x | is_separate_y
        is_free[this] = False
    return chosen


@lru_cache(maxsize=8192)
def _width_px(text: str) -> float:
    """Return the approximate width of a text [pixel]; names of rooms are in capitals."""
    return sum(_CAPITAL_PX if letter.isupper() else _LETTER_PX for letter in text)


def _vector(row: Floats) -> Vector:
    x, y, z = (float(value) for value in row)
    return (x, y, z)
