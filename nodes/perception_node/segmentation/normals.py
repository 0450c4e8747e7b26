"""Surface normals from the picture's neighbourhoods."""

from __future__ import annotations

import numpy as np

from nodes.perception_node.segmentation.grid import Floats, Mask

RADIUS = 2
"""Cells to each side of the middle: a window of 5 x 5."""

_GATE_M = 0.02  # deeper neighbours belong to something else
_FEWEST = 6
_SOME = 8  # every so many rows tell how far rays are from one another
_REACH = np.arange(-RADIUS, RADIUS + 1, dtype=np.float32)
_DOWN, _ACROSS = (offset.ravel() for offset in np.meshgrid(_REACH, _REACH, indexing="ij"))
_ONE = np.ones_like(_DOWN)
_MOMENTS = np.stack([_ONE, _ACROSS, _DOWN, _ACROSS**2, _DOWN**2, _ACROSS * _DOWN], axis=1)


def normals(points: Floats, where: Mask) -> Floats:
    """(h, w, 3) unit normals towards the camera of the points (h, w, 3) [m] in `where`, elsewhere NaN.

    On a plane 1/z is linear in the pixel, and a camera's noise is about even in 1/z: so the plane is fitted
    there, to the cells of the window that are about as deep as its middle.
    """
    out = np.full(points.shape, np.nan, np.float32)
    row, column = np.nonzero(where)
    nearness = np.pad(1 / points[..., 2], RADIUS, constant_values=np.nan)
    width = nearness.shape[1]
    middle = ((row + RADIUS) * width + column + RADIUS).astype(np.int32)
    own = nearness.ravel()[middle]
    inverse = nearness.ravel()[middle[:, None] + (_DOWN * width + _ACROSS).astype(np.int32)]  # (N, 25)
    inverse -= own[:, None]
    near = np.abs(inverse) < _GATE_M * np.maximum(1, own**2)[:, None]  # NaN is not
    inverse[~near] = 0
    count, x, y, xx, yy, xy = (near.astype(np.float32) @ _MOMENTS).T
    q, xq, yq = (inverse @ _MOMENTS[:, :3]).T
    count = np.maximum(count, 1)
    x, y, q = x / count, y / count, q / count
    xx, yy, xy = xx / count - x * x, yy / count - y * y, xy / count - x * y
    xq, yq = xq / count - x * q, yq / count - y * q
    determinant = xx * yy - xy * xy
    good = (count >= _FEWEST) & (determinant > 0.02)
    determinant = np.where(good, determinant, 1)
    across, down = (xq * yy - yq * xy) / determinant, (yq * xx - xq * xy) / determinant
    # as a plane of rays: slope_x * x/z + slope_y * y/z + rest = 1/z
    rays = points[..., :2] / points[..., 2:]
    slope_x, slope_y = across / _pitch(rays[..., 0], axis=1), down / _pitch(rays[..., 1], axis=0)
    ray_x, ray_y = rays[row, column].T
    rest = own + q - across * x - down * y - slope_x * ray_x - slope_y * ray_y
    found = -np.stack([slope_x, slope_y, rest], axis=-1)
    found /= np.linalg.norm(found, axis=-1, keepdims=True)
    out[row[good], column[good]] = found[good]
    return out


def _pitch(rays: Floats, axis: int) -> np.float32:
    """From one cell's ray to the next: (h, w) along `axis`."""
    steps = np.diff(rays[::_SOME] if axis else rays[:, ::_SOME], axis=axis)
    steps = steps[np.isfinite(steps) & (steps != 0)]
    return np.median(steps) if steps.size else np.float32(1)
