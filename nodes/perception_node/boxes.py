"""The box that stands around the visible points of a thing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nodes.perception_node.cloud import Floats

_YAWS_RAD = np.radians(np.arange(0.0, 90.0, 3.0))
_MOST_POINTS = 600
_TAIL = 0.01
"""The share of points beyond each side, for the sensor's flying pixels."""


@dataclass(frozen=True)
class Box:
    """An upright box: `low` and `high` (3,) [m] along the map's axes turned by `yaw_rad` about z."""

    low: Floats
    high: Floats
    yaw_rad: float

    @property
    def size_m(self) -> Floats:
        """(3,) extents along its own x, y, z."""
        return np.asarray(self.high - self.low)

    @property
    def bottom_m(self) -> Floats:
        """(3,) its bottom centre in the map frame."""
        x, y, _ = (self.low + self.high) / 2
        c, s = np.cos(self.yaw_rad), np.sin(self.yaw_rad)
        return np.array([c * x - s * y, s * x + c * y, self.low[2]])


def in_frame(points: Floats, yaw_rad: float) -> Floats:
    """(N, 3) map points along the axes of a box of this yaw."""
    c, s = np.cos(yaw_rad), np.sin(yaw_rad)
    return np.asarray(points @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]], points.dtype))


def best_yaw(points: Floats) -> float:
    """The yaw in [0, pi/2) [rad] of the smallest upright box around points (N, 3)."""
    xy = points[:: max(1, len(points) // _MOST_POINTS), :2]
    c, s = np.cos(_YAWS_RAD), np.sin(_YAWS_RAD)
    along, across = xy @ np.array([c, s]), xy @ np.array([-s, c])
    area = _extent(along) * _extent(across)
    return float(_YAWS_RAD[np.argmin(area)])


def _extent(coordinates: Floats) -> Floats:
    low, high = np.quantile(coordinates, [_TAIL, 1.0 - _TAIL], axis=0)
    return np.asarray(np.maximum(high - low, 1e-3))


def visible_box(points: Floats, support_m: float | None = None) -> Box:
    """The smallest upright box around map points (N, 3), down to the height of its support."""
    yaw = best_yaw(points)
    low, high = np.quantile(in_frame(points, yaw), [_TAIL, 1.0 - _TAIL], axis=0)
    if support_m is not None:
        low[2] = min(support_m, high[2] - 1e-3)
    return Box(low, np.maximum(high, low + 1e-3), yaw)
