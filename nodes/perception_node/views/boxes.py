"""Upright boxes of minimum floor area around points; the yaw is searched coarse to fine."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]

_COARSE_RAD = np.radians(np.arange(0.0, 90.0, 5.0))
_FINE_RAD = np.radians(np.arange(-4.0, 5.0, 1.0))
_LEAST_M = 1e-3


@dataclass(frozen=True)
class Box:
    """An upright box: `low` and `high` (3,) [m] along the map's axes rotated by `yaw_rad` about z."""

    low: Numbers
    high: Numbers
    yaw_rad: float

    @property
    def size_m(self) -> Numbers:
        """Return the extents (3,) along its own x, y, z."""
        return np.asarray(self.high - self.low)

    @property
    def bottom_m(self) -> Numbers:
        """Return its bottom centre (3,) in the map frame."""
        x, y, _ = (self.low + self.high) / 2
        c, s = np.cos(self.yaw_rad), np.sin(self.yaw_rad)
        return np.array([c * x - s * y, s * x + c * y, self.low[2]])

    def quarter_turned(self) -> Box:
        """Return the same box with its x axis along its former y axis."""
        low = np.array([self.low[1], -self.high[0], self.low[2]])
        high = np.array([self.high[1], -self.low[0], self.high[2]])
        return Box(low, high, self.yaw_rad + np.pi / 2)


def in_frame(points: Numbers, yaw_rad: float) -> Numbers:
    """Return map points (N, 3) along the map's axes rotated by `yaw_rad` about z."""
    c, s = np.cos(yaw_rad), np.sin(yaw_rad)
    return np.asarray(points @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))


def best_yaw(points: Numbers) -> float:
    """Return the yaw [rad] of the smallest upright box around points (N, 3), modulo a quarter turn."""
    xy = np.ascontiguousarray(points[:, :2].T)
    rough = _COARSE_RAD[np.argmin(_areas(xy, _COARSE_RAD))]
    fine = rough + _FINE_RAD
    return float(fine[np.argmin(_areas(xy, fine))])


def _areas(xy: Numbers, yaws_rad: Numbers) -> Numbers:
    c, s = np.cos(yaws_rad), np.sin(yaws_rad)
    along_across = np.stack([np.concatenate([c, -s]), np.concatenate([s, c])], axis=1) @ xy
    return np.asarray(np.ptp(along_across, axis=1).reshape(2, -1).prod(axis=0))


def box_around(points: Numbers, yaw_rad: float, bottom_m: float) -> Box:
    """Return the upright box of this yaw around map points (N, 3), down to `bottom_m`."""
    turned = np.ascontiguousarray(in_frame(points, yaw_rad).T)  # a minimum over long rows is faster
    low, high = turned.min(axis=1), turned.max(axis=1)
    low[2] = bottom_m
    return Box(low, np.maximum(high, low + _LEAST_M), yaw_rad)
