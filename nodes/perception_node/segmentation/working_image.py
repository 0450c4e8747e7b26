"""The working image: an organised cloud of any size, reduced to about 320 cells across."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import Cloud

Floats = NDArray[np.float32]
Labels = NDArray[np.int32]
Mask = NDArray[np.bool_]

WIDTH = 320
"""Approximate number of cells across. The pixels of a cell are averaged, which halves a Kinect's noise."""

_BRIGHTEST = np.float32(3 * 255)
_DARK = 60.0  # colours of darker pixels are mostly noise
_SAME_SURFACE = 0.015  # of the distance: deeper pixels of a cell are background
_LOWEST = np.float32(-1e6)
_AROUND = ((0, 0), (0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1))


@dataclass(frozen=True)
class Grid:
    """Cells of the working image, (h, w), `step` pixels wide and high.

    `points`: (3, h, w) x, y and z of each cell's nearest surface, camera frame [m], NaN for no measurement.
    `weights`: (N, h, w) the shares of its pixels in that. `depth`: (H, W) the depth of the cloud, <= 0 for
    none. `colors`: the colours of the cloud.
    """

    points: Floats
    weights: Floats
    depth: Floats
    colors: NDArray[np.uint8] | None
    step: int

    def shades(self, where: Mask) -> Floats:
        """Return the colours (3, h, w) of the cells in `where`, see `shades_of`; NaN if unknown."""
        out = np.full(self.points.shape, np.nan, np.float32)
        if self.colors is None:
            return out
        cells = np.flatnonzero(where)
        row, column = np.divmod(cells, where.shape[1])
        height, width = self.depth.shape
        mean = np.zeros((len(cells), 3), np.float32)
        for weight, (down, right) in zip(self.weights, _offsets(self.step), strict=True):
            # beyond the image's edge the weight is 0
            r, c = (
                np.minimum(row * self.step + down, height - 1),
                np.minimum(column * self.step + right, width - 1),
            )
            mean += weight.ravel()[cells, None] * self.colors.reshape(-1, 3).take(r * width + c, axis=0)
        out.reshape(3, -1)[:, cells] = shades_of(mean.T)
        return out


def grid_of(cloud: Cloud) -> Grid:
    """Return the working image of an organised cloud."""
    step = max(1, round(cloud.points_camera.shape[1] / WIDTH))
    # NaN times 0 would be NaN
    axes = [np.fmax(cloud.points_camera[..., axis], _LOWEST) for axis in range(3)]
    weights = _weights(axes[2], step)
    points = np.zeros((3, *weights.shape[1:]), np.float32)
    for cells, image in zip(points, axes, strict=True):
        for weight, corner in zip(weights, _corners(image, step), strict=True):
            height, width = corner.shape
            cells[:height, :width] += weight[:height, :width] * corner
    return Grid(points, weights, axes[2], cloud.colors, step)


def _offsets(step: int) -> list[tuple[int, int]]:
    """Return the pixels of a cell that are used: at most four."""
    sides = sorted({0, step // 2})
    return list(product(sides, sides))


def _corners(image: Floats, step: int) -> list[Floats]:
    """Return views of an image (H, W): the same pixel of each cell."""
    return [image[r::step, c::step] for r, c in _offsets(step)]


def _weights(depth: Floats, step: int) -> Floats:
    """Return (N, h, w) equal weights of each cell's pixels on its nearest surface, 0 for the others.

    NaN for a cell without measurement.
    """
    corners = _corners(depth, step)
    z = np.full((len(corners), *corners[0].shape), np.inf, np.float32)
    for of, corner in zip(z, corners, strict=True):  # a cell at the image's edge may lack some
        np.copyto(of[: corner.shape[0], : corner.shape[1]], corner, where=corner > 0)
    nearest = z.min(axis=0)
    nearest[np.isinf(nearest)] = np.nan
    front = z <= nearest * np.float32(1 + _SAME_SURFACE)  # NaN is not
    with np.errstate(invalid="ignore"):
        return np.asarray(front / front.sum(axis=0, dtype=np.float32))


def shades_of(colors: NDArray[Any]) -> Floats:
    """Convert rgb (3, ...) up to 255 to brightness, red-green and yellow-blue, in about [-1, 1].

    The last two hardly depend on the illumination.
    """
    red, green, blue = colors.astype(np.float32)
    total = red + green + blue
    light = total + np.float32(_DARK)
    return np.stack([total / _BRIGHTEST, (red - green) / light, (total - 3 * blue) / light])


def spread(grid: Grid, labels: Labels) -> Labels:
    """Expand labels of the cells (h, w) to the cloud's points (H, W); 0 for no measurement.

    A point that is not on its cell's surface gets the label of the adjacent cell with the nearest surface.
    """
    height, width = grid.depth.shape
    out = _enlarged(labels, grid.step, height, width)
    row, column = np.nonzero(_borders(labels))
    inside = np.arange(grid.step)
    row = (row * grid.step + inside[:, None])[:, None]  # (step, step, N) of the cells' pixels
    column = (column * grid.step + inside[:, None])[None]
    within = (row < height) & (column < width)
    pixel, cell_width = (row * width + column)[within], labels.shape[1] + 2
    cell = ((row // grid.step + 1) * cell_width + column // grid.step + 1)[within]
    cell_z = np.pad(grid.points[2], 1, constant_values=np.nan).ravel()
    deep = grid.depth.ravel()[pixel]
    doubtful = np.abs(deep - cell_z[cell]) > _SAME_SURFACE / 2 * deep
    pixel, cell, deep = pixel[doubtful], cell[doubtful], deep[doubtful]
    around = cell + np.array([r * cell_width + c for r, c in _AROUND])[:, None]
    off = np.abs(cell_z[around] - deep)
    off[np.isnan(off)] = np.inf
    nearest = off.argmin(axis=0)
    chosen = around[nearest, np.arange(len(pixel))]
    out.ravel()[pixel] = np.pad(labels, 1).ravel()[chosen]
    out[~(grid.depth > 0)] = 0
    return out


def _borders(labels: Labels) -> Mask:
    """Return cells (h, w) next to another label."""
    border = np.zeros(labels.shape, dtype=bool)
    for shift in ((0, 1), (1, 0), (1, 1), (1, -1)):
        differs = np.not_equal(*shifted(labels, *shift))
        for side in shifted(border, *shift):
            side |= differs
    return border


def _enlarged(image: NDArray[Any], step: int, height: int, width: int) -> NDArray[Any]:
    """Return each cell as a block of pixels."""
    return image.repeat(step, axis=0)[:height].repeat(step, axis=1)[:, :width]


def shifted(image: NDArray[Any], rows: int, columns: int) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return two views of an image (h, w): cells, and those `rows` down and `columns` to the right.

    Both are empty for a smaller image.
    """
    height, width = image.shape
    rows, columns = min(rows, height), max(-width, min(columns, width))
    left, right = max(0, -columns), width - max(0, columns)
    return image[: height - rows, left:right], image[rows:, left + columns : right + columns]
