"""Surface normals from the picture's neighbourhoods."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nodes.perception_node.segmentation.grid import Floats, Mask

RADIUS = 2
"""Cells to each side of the middle: a window of 5 x 5."""

_GATE_M = 0.02  # deeper neighbours belong to something else
_FEWEST = 6


def normals(points: Floats, where: Mask) -> Floats:
    """(h, w, 3) unit normals towards the camera of the points (h, w, 3) [m] in `where`, elsewhere NaN.

    On a plane 1/z is linear in x/z and y/z, and a camera's noise is about even in 1/z: so the plane is
    fitted there, to the cells of the window that are about as deep as its middle.
    """
    out = np.full(points.shape, np.nan, np.float32)
    width = points.shape[1] + 2 * RADIUS
    padded = np.pad(points, ((RADIUS, RADIUS), (RADIUS, RADIUS), (0, 0)), constant_values=np.nan)
    z = padded[..., 2].ravel()
    inverse = 1 / z
    ray_x, ray_y = padded[..., 0].ravel() * inverse, padded[..., 1].ravel() * inverse
    row, column = np.nonzero(where)
    middle = (row + RADIUS) * width + column + RADIUS
    reach = np.arange(-RADIUS, RADIUS + 1)
    window = middle[:, None] + (reach[:, None] * width + reach[None, :]).ravel()  # (N, 25)
    near = np.abs(z[window] - z[middle, None]) < _GATE_M * np.maximum(1, z[middle, None] ** 2)
    x = _masked(ray_x[window] - ray_x[middle, None], near)
    y = _masked(ray_y[window] - ray_y[middle, None], near)
    q = _masked(inverse[window] - inverse[middle, None], near)
    count = np.maximum(near.sum(axis=1), 1)
    mean_x, mean_y, mean_q = x.sum(axis=1) / count, y.sum(axis=1) / count, q.sum(axis=1) / count

    def moment(a: Floats, b: Floats, mean_a: Floats, mean_b: Floats) -> Floats:
        return np.einsum("ij,ij->i", a, b) / count - mean_a * mean_b

    xx, yy, xy = moment(x, x, mean_x, mean_x), moment(y, y, mean_y, mean_y), moment(x, y, mean_x, mean_y)
    xq, yq = moment(x, q, mean_x, mean_q), moment(y, q, mean_y, mean_q)
    determinant = xx * yy - xy * xy
    good = (count >= _FEWEST) & (determinant > 1e-3 * np.maximum(xx, yy) ** 2)
    determinant = np.where(good, determinant, 1)
    slope_x, slope_y = (xq * yy - yq * xy) / determinant, (yq * xx - xq * xy) / determinant
    # the plane in rays from the camera: slope_x * x/z + slope_y * y/z + rest = 1/z
    rest = mean_q - slope_x * mean_x - slope_y * mean_y + inverse[middle]
    rest = rest - slope_x * ray_x[middle] - slope_y * ray_y[middle]
    found = -np.stack([slope_x, slope_y, rest], axis=-1)
    found /= np.linalg.norm(found, axis=-1, keepdims=True)
    out[row[good], column[good]] = found[good]
    return out


def _masked(values: Floats, mask: Mask) -> Floats:
    return np.where(mask, values, np.float32(0))


def angle_between(a: NDArray[np.floating], b: NDArray[np.floating]) -> NDArray[np.floating]:
    """Angles [rad] between unit vectors (..., 3)."""
    return np.arccos(np.clip(np.einsum("...i,...i->...", a, b), -1, 1))
