"""Sums over patches and their borders, which are additive, so merging is cheap."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.segmentation.working_image import Floats, Labels

Sums = NDArray[np.float64]
Indices = NDArray[np.int64]

# columns of `Statistics.inside`
COUNT, POINT, SQUARES, NORMAL, SHADE, SHADES = 0, slice(1, 4), slice(4, 10), slice(10, 13), slice(13, 16), 16
HIDDEN = 17
INSIDE = 18
_FIRST, _SECOND = [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]

# columns of `Statistics.between`, for the ordered pair (a, b)
TOUCH, STEP, BEFORE, BENDS, BEND, CONCAVE, DEEP, CONVEX, LIKE, WIDE = range(10)
SIGHT, BLOCKED, OPEN, BRIGHTER, COLOURED = range(10, 15)
BETWEEN = 15

_STEP_M = 0.007
_SAME_SURFACE_M = 0.02
_SAMPLES = 12
_FAR = 4
_SINES = np.sin(np.radians((20, 45)))


@dataclass(frozen=True)
class Upright:
    """The vertical and the supports. `axes`: (3, 3) rows of two level axes and the vertical, camera frame.

    `supports`: (S,) the heights of supports along the vertical, ascending.
    """

    axes: Sums
    supports: Sums


@dataclass
class Statistics:
    """The statistics of P patches.

    `inside`: (P, INSIDE) sums over cells. `low`, `high`: (P, 3) bounds along two level axes and the vertical
    [m]. `between`: (P, P, BETWEEN) sums over borders; only BEFORE, how often the first occludes the second,
    is not symmetric. `owner`: (P,) the patch that each was merged into. `supports`: see `Upright`.
    """

    inside: Sums
    low: Sums
    high: Sums
    between: Sums
    owner: NDArray[np.int64]
    supports: Sums

    def merge(self, a: int, b: int) -> None:
        """Merge patch b into patch a; row b is invalid afterwards."""
        self.inside[a] += self.inside[b]
        self.low[a] = np.minimum(self.low[a], self.low[b])
        self.high[a] = np.maximum(self.high[a], self.high[b])
        self.between[a] += self.between[b]
        self.between[:, a] += self.between[:, b]
        self.owner[self.owner == b] = a

    def copy(self) -> Statistics:
        """Return a copy."""
        return Statistics(*(getattr(self, field.name).copy() for field in fields(self)))


def statistics(
    labels: Labels, points: Floats, normals: Floats, shades: Floats, upright: Upright
) -> Statistics:
    """Compute the statistics of patches `labels` (h, w), from 1 without gaps; other arrays are (3, h, w)."""
    count = int(labels.max(initial=0))
    cells = _cells_of(labels, points, normals, shades)
    p = cells.points
    values = (
        *(np.ones(len(cells.owner)), *p, *(p[_FIRST] * p[_SECOND]), *cells.normals, *cells.shades),
        (cells.shades[1:] ** 2).sum(axis=0),
        _hides(cells, labels, points[2]),
    )
    inside = np.stack([np.bincount(cells.owner, of, count) for of in values], axis=1, dtype=np.float64)
    order = np.argsort(cells.owner.astype(np.uint16), kind="stable")  # which is sorted by counting
    placed = (upright.axes @ p)[:, order]
    starts = np.cumsum(inside[:, COUNT], dtype=np.int64) - inside[:, COUNT].astype(np.int64)
    low, high = (
        ufunc.reduceat(placed, starts, axis=1).T if count else np.zeros((0, 3))
        for ufunc in (np.minimum, np.maximum)
    )
    between = np.zeros((count, count, BETWEEN))
    _touching(between, cells)
    _bending(between, cells)
    _seen_between(between, cells, labels, points[2])
    return Statistics(inside, low, high, between, np.arange(count), upright.supports)


@dataclass(frozen=True)
class _Cells:
    """The N cells of all patches as rows of values, since most cells of an image are in none.

    `place`: (N,) the cell's index in the image, `owner`: (N,) its patch, from 0. `points`, `normals`,
    `shades`: (3, N). `number`: (h, w) the index of each cell among these, -1 for none, with a margin of
    `_FAR` on all sides.
    """

    place: Indices
    owner: Indices
    points: Floats
    normals: Floats
    shades: Floats
    number: Indices

    def pairs(self, *shifts: tuple[int, int]) -> tuple[Indices, Indices]:
        """Return pairs of cells in different patches that are shifted by these rows and columns."""
        width = self.number.shape[1]
        middle = np.flatnonzero(self.number >= 0)
        places = np.concatenate([middle + rows * width + columns for rows, columns in shifts])
        other, own = self.number.ravel()[places], np.tile(self.owner, len(shifts))
        found = np.flatnonzero((other >= 0) & (self.owner[other] != own))
        return found % len(middle), other[found]


def _cells_of(labels: Labels, points: Floats, normals: Floats, shades: Floats) -> _Cells:
    place = np.flatnonzero(labels)
    number = np.full(labels.shape, -1)
    number.ravel()[place] = np.arange(len(place))
    p, n, shade = (of.reshape(3, -1).take(place, axis=1) for of in (points, normals, shades))
    owner = labels.ravel()[place].astype(np.int64) - 1
    return _Cells(place, owner, p, np.nan_to_num(n), shade, np.pad(number, _FAR, constant_values=-1))


def _hides(cells: _Cells, labels: Labels, depth: Floats) -> Sums:
    """Return (N,) the number of sides with a nearer neighbour: the patch may continue behind it."""
    hidden = np.zeros(len(cells.owner))
    z, label = np.pad(depth, 1, constant_values=np.nan), np.pad(labels, 1)
    middle = np.flatnonzero(label)
    for side in (1, -1, z.shape[1], -z.shape[1]):
        near, other = z.ravel()[middle + side], label.ravel()[middle + side]
        step = _STEP_M * np.maximum(near, near * near)
        hidden += (other != cells.owner + 1) & (cells.points[2] - near > step)
    return hidden


def _add(between: Sums, a: Indices, b: Indices, columns: Mapping[int, NDArray[np.generic]]) -> None:
    """Add sums of `columns` over pairs of cells of the patches a and b, in both directions."""
    for column, values in columns.items():
        sums = _sums(len(between), a, b, values)
        between[..., column] = sums + sums.T


def _sums(count: int, a: Indices, b: Indices, values: NDArray[np.generic]) -> Sums:
    return np.asarray(np.bincount(a * count + b, values, count * count).reshape(count, count), np.float64)


def _touching(between: Sums, cells: _Cells) -> None:
    """Add sums over adjacent cells."""
    i, j = cells.pairs((0, 1), (1, 0))
    a, b, z, far = cells.owner[i], cells.owner[j], cells.points[2, i], cells.points[2, j]
    step = np.abs(z - far) > _STEP_M * np.maximum(z, z * z)
    _add(between, a, b, {TOUCH: np.ones(len(a)), STEP: step})
    for first, second, front in ((a, b, step & (z < far)), (b, a, step & (far < z))):
        between[..., BEFORE] += _sums(len(between), first, second, front)


def _bending(between: Sums, cells: _Cells) -> None:
    """Add sums over cells four apart, which spans rounded edges and narrow shadows."""
    i, j = cells.pairs((0, _FAR), (_FAR, 0), (3, 3), (3, -3))
    (p, q), (m, n), shades = (
        (of.take(i, axis=1), of.take(j, axis=1)) for of in (cells.points, cells.normals, cells.shades)
    )
    apart = q - p
    length = np.maximum(np.sqrt((apart * apart).sum(axis=0)), np.float32(1e-6))
    bend = ((n - m) * apart).sum(axis=0) / length
    brighter, *coloured = np.abs(np.subtract(*shades))
    near = np.abs(apart[2]) < _SAME_SURFACE_M * np.maximum(1, p[2] ** 2)
    columns = {
        WIDE: np.ones(len(i)),
        BENDS: near,
        BEND: near * bend,
        CONCAVE: near & (bend < -_SINES[0]),
        DEEP: near & (bend < -_SINES[1]),
        CONVEX: near & (bend > _SINES[1]),
        LIKE: near * (m * n).sum(axis=0),
        BRIGHTER: near * brighter,
        COLOURED: near * np.hypot(*coloured),
    }
    _add(between, cells.owner[i], cells.owner[j], columns)


def _seen_between(between: Sums, cells: _Cells, labels: Labels, depth: Floats) -> None:
    """Add what lies on the line between the centres of two patches: an occluder, or open space."""
    count = len(between)
    size = np.bincount(cells.owner, minlength=count)
    row, column, mean = (
        np.bincount(cells.owner, of, count) / size
        for of in (*np.divmod(cells.place, labels.shape[1]), cells.points[2])
    )
    a, b = np.triu_indices(count, 1)
    t = ((np.arange(_SAMPLES) + 0.5) / _SAMPLES)[:, None]
    r, c, line = (of[a] * (1 - t) + of[b] * t for of in (row, column, mean))
    place = r.astype(np.int64) * labels.shape[1] + c.astype(np.int64)
    there, z = labels.ravel()[place] - 1, depth.ravel()[place]
    other = (there != a) & (there != b)
    blocked = other & (z < line - _SAME_SURFACE_M)
    open_ = other & (z > line + _SAME_SURFACE_M)  # missing depth may be a shadow
    for column_, values in ((SIGHT, other), (BLOCKED, blocked), (OPEN, open_)):
        between[a, b, column_] = between[b, a, column_] = values.sum(axis=0)
