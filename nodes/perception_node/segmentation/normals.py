"""Surface normals from image neighbourhoods: least-squares planes in disparity."""

from __future__ import annotations

import numpy as np

from semmap.nodes.perception_node.segmentation.working_image import Floats, Mask

RADIUS = 2
"""Cells to each side of the centre: a window of 5 x 5."""

_GATE_M = 0.02  # deeper neighbours belong to something else
_FEWEST = 6
_SOME = 8  # step between the rows that are used to measure the pitch of rays
_SIDE = 2 * RADIUS + 1
_ROWS, _COLUMNS = np.indices((_SIDE, _SIDE)).reshape(2, -1) - RADIUS
_DOWN, _ACROSS = _ROWS.astype(np.float32), _COLUMNS.astype(np.float32)
_MOMENTS = np.stack([np.ones_like(_DOWN), _ACROSS, _DOWN, _ACROSS**2, _DOWN**2, _ACROSS * _DOWN])


def normals(points: Floats, where: Mask) -> Floats:
    """Return (3, h, w) unit normals towards the camera of the points (3, h, w) [m] in `where`, elsewhere NaN.

    On a plane 1/z is linear in the pixel, and a camera's noise is nearly uniform in 1/z. The plane is fitted
    in that space, to the cells of the window at a similar depth.
    """
    out = np.full(points.shape, np.nan, np.float32)
    cells = np.flatnonzero(where)
    row, column = np.divmod(cells, where.shape[1])
    nearness = np.pad(1 / points[2], RADIUS, constant_values=np.nan)
    width = nearness.shape[1]
    middle = (row + RADIUS) * width + column + RADIUS
    own = nearness.ravel()[middle]
    inverse = nearness.ravel().take((_ROWS * width + _COLUMNS)[:, None] + middle)  # (25, N)
    inverse -= own
    near = np.abs(inverse) < _GATE_M * np.maximum(1, own**2)  # NaN is not
    inverse[~near] = 0
    # a matrix product would use threads, which wait for each other on a busy machine
    count, x, y, xx, yy, xy = np.einsum("mk,kn->mn", _MOMENTS, near.astype(np.float32))
    q, xq, yq = np.einsum("mk,kn->mn", _MOMENTS[:3], inverse)
    count = np.maximum(count, 1)
    x, y, q = x / count, y / count, q / count
    xx, yy, xy = xx / count - x * x, yy / count - y * y, xy / count - x * y
    xq, yq = xq / count - x * q, yq / count - y * q
    determinant = xx * yy - xy * xy
    good = (count >= _FEWEST) & (determinant > 0.02)
    determinant = np.where(good, determinant, 1)
    across, down = (xq * yy - yq * xy) / determinant, (yq * xx - xq * xy) / determinant
    # as a plane of rays: slope_x * x/z + slope_y * y/z + rest = 1/z
    slope_x, slope_y = across / _pitch(points[0], points[2]), down / _pitch(points[1].T, points[2].T)
    ray_x, ray_y = points.reshape(3, -1)[:2].take(cells, axis=1) * own
    rest = own + q - across * x - down * y - slope_x * ray_x - slope_y * ray_y
    found = -np.stack([slope_x, slope_y, rest])
    found /= np.sqrt((found * found).sum(axis=0))
    out.reshape(3, -1)[:, cells] = np.where(good, found, np.float32(np.nan))
    return out


def _pitch(along: Floats, depth: Floats) -> np.float32:
    """Return the step between rays of adjacent cells in a row of (h, w)."""
    steps = np.diff(along[::_SOME] / depth[::_SOME])
    steps = steps[np.isfinite(steps) & (steps != 0)]
    return np.median(steps) if steps.size else np.float32(1)
