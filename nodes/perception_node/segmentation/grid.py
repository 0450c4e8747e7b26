"""The working picture: an organised cloud, small or huge, as a picture of about 320 cells across."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nodes.perception_node.cloud import Cloud

Floats = NDArray[np.float32]
Labels = NDArray[np.int32]
Mask = NDArray[np.bool_]

WIDTH = 320
"""About how many cells there are across. The pixels of a cell are averaged, which halves a Kinect's noise."""

_BRIGHTEST = np.float32(3 * 255)
_DARK = 60.0  # colours of what is darker are mostly noise
_SAME_SURFACE = 0.015  # of the distance: pixels of one cell that lie deeper belong to what is behind
_AROUND = ((0, 0), (0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1))


@dataclass(frozen=True)
class Grid:
    """Cells of the working picture, (h, w), `step` pixels wide and high.

    `points`: (h, w, 3), camera frame [m], NaN where nothing was seen: of each cell the nearest surface.
    `shades`: (h, w, 3) see `shades_of`; NaN where the camera sees no colours. `source`: the cloud's points
    (H, W, 3).
    """

    points: Floats
    shades: Floats
    source: Floats
    step: int


def grid_of(cloud: Cloud) -> Grid:
    """The working picture of an organised cloud."""
    source = cloud.points_camera
    step = max(1, round(source.shape[1] / WIDTH))
    if step == 1:
        points = np.where(source[..., 2:] > 0, source, np.float32(np.nan))
        return Grid(points, _shades(cloud, points.shape, lambda colors: colors), source, step)
    planes = _corners(source, step)
    z = planes[:, 2]
    nearest = np.fmin(np.fmin(z[0], z[1]), np.fmin(z[2], z[3]))
    nearest[~(nearest > 0)] = np.nan
    front = z <= nearest * np.float32(1 + _SAME_SURFACE)  # NaN is not
    count = front.sum(axis=0, dtype=np.float32)
    count[count == 0] = np.nan

    def averaged(corners: Floats) -> Floats:
        """Cells as the mean of those of their pixels (at most four) that show the nearest surface."""
        sums = np.where(front[:, None], corners, np.float32(0)).sum(axis=0)
        return np.ascontiguousarray(np.moveaxis(sums / count, 0, -1))

    points = averaged(planes)
    return Grid(points, _shades(cloud, points.shape, lambda c: averaged(_corners(c, step))), source, step)


def _corners(picture: NDArray[Any], step: int) -> Floats:
    """(4, 3, h, w) of a picture (H, W, 3): four pixels of each cell, NaN beyond the picture's edge."""
    height, width = (-(-side // step) for side in picture.shape[:2])
    corners = [picture[r::step, c::step] for r in (0, step // 2) for c in (0, step // 2)]
    planes = np.full((4, 3, height, width), np.nan, np.float32)
    for corner, plane in zip(corners, planes, strict=True):
        plane[:, : corner.shape[0], : corner.shape[1]] = np.moveaxis(corner, -1, 0)
    return planes


def _shades(cloud: Cloud, shape: tuple[int, ...], reduce: Callable[[NDArray[Any]], NDArray[Any]]) -> Floats:
    if cloud.colors is None:
        return np.full(shape, np.nan, np.float32)
    return shades_of(reduce(cloud.colors))


def shades_of(colors: NDArray[Any]) -> Floats:
    """Of rgb (..., 3) up to 255: brightness, red against green, and yellow against blue, in about [-1, 1].

    The last two hardly change with the light.
    """
    red, green, blue = np.moveaxis(colors.astype(np.float32), -1, 0)
    total = red + green + blue
    light = total + np.float32(_DARK)
    return np.stack([total / _BRIGHTEST, (red - green) / light, (total - 3 * blue) / light], axis=-1)


def spread(grid: Grid, labels: Labels) -> Labels:
    """Labels of the cells (h, w) as labels of the cloud's points (H, W); 0 where nothing was seen.

    A point that is not on its cell's surface has the label of the cell around whose surface it is nearest to.
    """
    height, width = grid.source.shape[:2]
    z = grid.source[..., 2]
    out = _enlarged(labels, grid.step, height, width)
    out[~(z > 0)] = 0
    if grid.step == 1:
        return out
    border = np.zeros(labels.shape, dtype=bool)
    for shift in ((0, 1), (1, 0), (1, 1), (1, -1)):
        here, there = shifted(labels, *shift)
        differs = here != there
        for side in shifted(border, *shift):
            side |= differs
    row, column = np.nonzero(_enlarged(border, grid.step, height, width))
    cell_row, cell_column = row // grid.step, column // grid.step
    deep = z[row, column]
    doubtful = np.abs(deep - grid.points[cell_row, cell_column, 2]) > _SAME_SURFACE / 2 * deep
    row, column, deep = row[doubtful], column[doubtful], deep[doubtful]
    padded_z = np.pad(grid.points[..., 2], 1, constant_values=np.nan)
    padded = np.pad(labels, 1)
    best = np.full(len(row), np.inf, np.float32)
    for dr, dc in _AROUND:
        r, c = row // grid.step + 1 + dr, column // grid.step + 1 + dc
        off = np.abs(padded_z[r, c] - deep)
        closer = off < best  # NaN is not
        best[closer] = off[closer]
        out[row[closer], column[closer]] = padded[r[closer], c[closer]]
    return out


def _enlarged(picture: NDArray[Any], step: int, height: int, width: int) -> NDArray[Any]:
    """Each cell as a block of pixels."""
    return picture.repeat(step, axis=0)[:height].repeat(step, axis=1)[:, :width]


def shifted(picture: NDArray[Any], rows: int, columns: int) -> tuple[NDArray[Any], NDArray[Any]]:
    """Two views of a picture: its pixels, and those `rows` down and `columns` to the right of each."""
    height, width = picture.shape[:2]
    left, right = max(0, -columns), width - max(0, columns)
    return picture[: height - rows, left:right], picture[rows:, left + columns : right + columns]
