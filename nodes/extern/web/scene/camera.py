"""Where a viewer stands: the way from what the map holds to a first view, and from a view to what is seen."""

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
from semmap.schemas.entities import Entity, Vector
from semmap.schemas.relations import ViewPoint

Floats = NDArray[np.float64]

FOV_RAD: Final = math.radians(40.0)
"""Of the first view, from top to bottom."""
_TILT_RAD: Final = math.radians(52.0)
_MARGIN: Final = 1.06
_FARTHEST_M: Final = 200.0
_FAR_M: Final = 100.0
_UNKNOWN_SIZE_M: Final = (0.1, 0.1, 0.1)
_LABEL_PX: Final = 17.0
_LETTER_PX: Final = 7.0
_CAPITAL_PX: Final = 10.0
_NEAREST_M: Final = 0.05


class View(Struct, frozen=True):
    """A pinhole: where it is [m], its optical frame (x right, y down, z ahead) as wxyz, and its picture."""

    position_m: Vector
    wxyz: tuple[float, float, float, float]
    fov_rad: float
    width: float
    height: float

    def project(self, points: Floats) -> Floats:
        """(N, 3): pixels from the left, pixels from the top, and metres ahead of points (N, 3) [m]."""
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
        """Who asks what is left or behind from here: position [m] and heading [rad] about the map's z."""
        w, x, y, z = self.wxyz
        ahead = (2 * (x * z + w * y), 2 * (y * z - w * x))
        up = (-2 * (x * y - w * z), -(1 - 2 * (x * x + z * z)))
        east, north = ahead if math.hypot(*ahead) > 0.05 else up  # straight down: what is up in the picture
        px, py, pz = self.position_m
        return (px, py, pz, math.atan2(north, east))


def extent(entities: Iterable[Entity]) -> Floats:
    """(N, 3) [m]: points around what has a place, for a view of all of it; what is far off is left out."""
    points = [
        corners_of(entity.pose, entity.size_m or _UNKNOWN_SIZE_M)
        for entity in entities
        if entity.pose is not None
    ]
    if not points:
        return np.empty((0, 3))
    found = np.concatenate(points)
    return np.asarray(found[np.abs(found - np.median(found, axis=0)).max(axis=1) < _FAR_M])


def first_view(points: Floats, aspect: float) -> tuple[Vector, Vector]:
    """Position and target [m] from which all of `points` (N, 3) is seen, from the south and above.

    `aspect` is how much wider than high the picture is.
    """
    if not len(points):
        points = np.array([(-2.0, -2.0, 0.0), (2.0, 2.0, 1.0)])
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (low + high) / 2.0
    back = np.array((0.0, -math.cos(_TILT_RAD), math.sin(_TILT_RAD)))
    up = np.array((0.0, math.sin(_TILT_RAD), math.cos(_TILT_RAD)))
    own = np.array(list(itertools.product(*zip(low, high, strict=True)))) - middle
    slope = math.tan(FOV_RAD / 2.0)
    distances = own @ back + np.maximum(np.abs(own @ up) / slope, np.abs(own[:, 0]) / slope / aspect)
    distance = min(_FARTHEST_M, max(1.5, float(distances.max()) * _MARGIN))
    eye = middle + distance * back
    return _vector(eye), _vector(middle)


def uncrowded(
    view: View, labels: Mapping[str, tuple[str, Vector]], first: Iterable[str] = (), most: int = 40
) -> list[str]:
    """The keys of those `labels` (a text and its place [m]) that fit into the picture side by side.

    The `first` have precedence in their order, then the nearest; at most so many.
    """
    if not labels:
        return []
    keys, ranks = list(labels), {key: rank for rank, key in enumerate(first)}
    at = view.project(np.array([place for _, place in labels.values()], dtype=float))
    x, y, ahead = at.T
    halves = np.array([_width_px(text) / 2.0 + 5.0 for text, _ in labels.values()])
    is_whole = (x >= halves) & (x <= view.width - halves)  # not cut off at an edge
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
        beside = (left >= right[this]) | (right <= left[this])
        above = np.abs(top - top[this]) >= _LABEL_PX  # or below: all are as high
        is_free &= beside | above
        is_free[this] = False
    return chosen


@lru_cache(maxsize=8192)
def _width_px(text: str) -> float:
    """About how wide a text is written; rooms have capitals, and larger ones."""
    return sum(_CAPITAL_PX if letter.isupper() else _LETTER_PX for letter in text)


def _vector(row: Floats) -> Vector:
    x, y, z = (float(value) for value in row)
    return (x, y, z)
