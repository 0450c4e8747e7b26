"""The working picture: any cloud, organised or not, small or huge, as a picture of about 320 x 240 cells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nodes.perception_node.cloud import Cloud

Floats = NDArray[np.float32]
Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]

WIDTH = 320
"""Cells across; the pixels of a cell are averaged, which halves the noise of 640 pixels."""

_SAME_SURFACE = 0.015  # of the distance: pixels of one cell that lie deeper belong to what is behind


@dataclass(frozen=True)
class Grid:
    """Cells of the working picture, (h, w).

    `points`: (h, w, 3), camera frame [m], NaN where nothing was seen: of each cell the nearest surface.
    `colors`: (h, w, 3) rgb in 0..1, or None. `source`: the cloud's points (H, W, 3). `cells`: (H, W) the cell
    (row * w + column) of each of them, -1 where nothing was seen.
    """

    points: Floats
    colors: Floats | None
    source: Floats
    cells: Ints

    @property
    def shape(self) -> tuple[int, int]:
        """(h, w)."""
        return self.points.shape[0], self.points.shape[1]

    @property
    def pixels_a_cell(self) -> float:
        """How many points of the cloud fall into one cell, if all were seen."""
        return self.cells.size / (self.shape[0] * self.shape[1])


def grid_of(cloud: Cloud) -> Grid:
    """The working picture of a cloud."""
    points = cloud.points_camera
    seen = points[..., 2] > 0  # NaN is not
    if cloud.organised:
        height, width = seen.shape
        step = max(1, round(width / WIDTH))
        shape = (-(-height // step), -(-width // step))
        cells = (np.arange(height) // step * shape[1])[:, None] + (np.arange(width) // step)[None, :]
        cells = np.where(seen, cells, -1)
    else:
        cells, shape = _projected(points, seen)
    return _averaged(cloud, cells, shape)


def _averaged(cloud: Cloud, cells: Ints, shape: tuple[int, int]) -> Grid:
    """Cells as the mean of those of their points that lie on the nearest surface."""
    size = shape[0] * shape[1]
    index = np.flatnonzero(cells.ravel() >= 0)
    cell = cells.ravel()[index]
    points = cloud.points_camera.reshape(-1, 3)[index]
    nearest = np.full(size, np.inf, np.float32)
    np.minimum.at(nearest, cell, points[:, 2])
    front = points[:, 2] <= nearest[cell] * (1 + _SAME_SURFACE)
    cell, points, index = cell[front], points[front], index[front]
    count = np.bincount(cell, minlength=size)

    def mean(values: NDArray[np.generic]) -> Floats:
        sums = [np.bincount(cell, weights=values[:, axis], minlength=size) for axis in range(3)]
        with np.errstate(invalid="ignore"):
            return (np.stack(sums, axis=-1) / count[:, None]).astype(np.float32).reshape(*shape, 3)

    colors = None
    if cloud.colors is not None:
        colors = mean(cloud.colors.reshape(-1, 3)[index]) / np.float32(255)
    return Grid(mean(points), colors, cloud.points_camera, cells)


def _projected(points: Floats, seen: Mask) -> tuple[Ints, tuple[int, int]]:
    """Cells of a cloud without order, as a pinhole camera at its origin would see it: (1, N), shape."""
    cells = np.full(seen.shape, -1, np.int64)
    if not seen.any():
        return cells, (1, 1)
    rays = points[seen][:, :2] / points[seen][:, 2:]
    low, high = np.percentile(rays, (0.1, 99.9), axis=0)
    extent = np.maximum(high - low, 1e-3)
    focal = WIDTH / 640 * 525.0
    # about as many points a cell as an organised picture has, but never finer than such a picture
    focal = min(focal, float(np.sqrt(seen.sum() / 2.0 / extent.prod())))
    focal = min(focal, 2 * WIDTH / float(extent.max()))
    place = np.floor((rays - low) * focal).astype(np.int64)
    shape = np.floor(extent * focal).astype(np.int64) + 1
    inside = ((place >= 0) & (place < shape)).all(axis=1)
    cells[seen] = np.where(inside, place[:, 1] * shape[0] + place[:, 0], -1)
    return cells, (int(shape[1]), int(shape[0]))


def spread(grid: Grid, labels: NDArray[np.int32]) -> NDArray[np.int32]:
    """Labels of the cells (h, w) as labels of the cloud's points (H, W).

    Where a point is not on its cell's surface, the nearest of the eight cells around gives the label.
    """
    height, width = grid.shape
    flat_cells, source = grid.cells.ravel(), grid.source.reshape(-1, 3)
    flat = np.append(labels.ravel(), np.int32(0))
    out = flat[flat_cells]
    near = np.zeros(labels.shape, dtype=bool)
    for shift in ((0, 1), (1, 0), (1, 1), (1, -1)):
        here, there = shifted(labels, *shift)
        differs = here != there
        a, b = shifted(near, *shift)
        a |= differs
        b |= differs
    doubtful = np.flatnonzero(np.append(near.ravel(), False)[flat_cells])
    best = np.full(doubtful.size, np.inf, np.float32)
    padded = np.pad(grid.points, ((1, 1), (1, 1), (0, 0)), constant_values=np.nan).reshape(-1, 3)
    labels_padded = np.pad(labels, 1).ravel()
    row, column = np.divmod(flat_cells[doubtful], width)
    for dr, dc in ((0, 0), (0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1)):
        there = (row + 1 + dr) * (width + 2) + column + 1 + dc
        distance = ((padded[there] - source[doubtful]) ** 2).sum(axis=1)
        closer = distance < best  # NaN is not
        best[closer] = distance[closer]
        out[doubtful[closer]] = labels_padded[there[closer]]
    return out.reshape(grid.cells.shape)


def shifted(picture: NDArray, rows: int, columns: int) -> tuple[NDArray, NDArray]:
    """Two views of a picture: its pixels, and those `rows` down and `columns` to the right of each."""
    height, width = picture.shape[:2]
    left, right = max(0, -columns), width - max(0, columns)
    here = picture[: height - rows, left:right]
    there = picture[rows:, left + columns : right + columns]
    return here, there
