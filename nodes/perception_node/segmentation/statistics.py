"""Sums over patches and over their borders. Sums of a union are sums of sums, so merging is cheap."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from nodes.perception_node.segmentation.grid import Floats, Labels, shifted

Sums = NDArray[np.float64]
Indices = NDArray[np.int64]

# columns of `Statistics.inside`
COUNT, POINT, SQUARES, NORMAL, SHADE, SHADES = 0, slice(1, 4), slice(4, 10), slice(10, 13), slice(13, 16), 16
HIDDEN = 17
INSIDE = 18
_FIRST, _SECOND = (0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2)

# columns of `Statistics.between`, for the ordered pair (a, b)
TOUCH, STEP, BEFORE, BENDS, BEND, CONCAVE, DEEP, CONVEX, LIKE, WIDE = range(10)
SIGHT, BLOCKED, OPEN, BRIGHTER, COLOURED = range(10, 15)
BETWEEN = 15

_STEP_M = 0.007
_SAME_SURFACE_M = 0.02
_SAMPLES = 12
_SINES = np.sin(np.radians((20, 45)))


@dataclass(frozen=True)
class Upright:
    """What is level and what is up. `axes`: (3, 3) rows of two level axes and the vertical, camera frame.

    `supports`: (S,) the heights along the vertical on which things may stand, rising.
    """

    axes: Sums
    supports: Sums


@dataclass
class Statistics:
    """What is known of P patches; row 0 is the first.

    `inside`: (P, INSIDE) sums over cells. `low`, `high`: (P, 3) bounds along two level axes and the
    vertical [m]. `between`: (P, P, BETWEEN) sums over borders; only BEFORE, how often the first is in front
    of the second, is not symmetric. `owner`: (P,) the patch that each was merged into, at first itself.
    `supports`: see `Upright`.
    """

    inside: Sums
    low: Sums
    high: Sums
    between: Sums
    owner: NDArray[np.int64]
    supports: Sums

    def merge(self, a: int, b: int) -> None:
        """Patch a becomes the union of a and b; b's row is left as it was, and means nothing any more."""
        self.inside[a] += self.inside[b]
        self.low[a] = np.minimum(self.low[a], self.low[b])
        self.high[a] = np.maximum(self.high[a], self.high[b])
        self.between[a] += self.between[b]
        self.between[:, a] += self.between[:, b]
        self.owner[self.owner == b] = a

    def copy(self) -> Statistics:
        """An independent one."""
        return Statistics(*(getattr(self, field.name).copy() for field in fields(self)))


def statistics(
    labels: Labels, points: Floats, normals: Floats, shades: Floats, upright: Upright
) -> Statistics:
    """Of patches `labels` (h, w), numbered from 1 without gaps; `shades` as of `Grid`."""
    count = int(labels.max(initial=0))
    row, column = np.nonzero(labels)
    owner = labels[row, column].astype(np.uint16)  # which is sorted by counting
    order = np.argsort(owner, kind="stable")
    row, column = row[order], column[order]
    starts = np.searchsorted(owner[order], np.arange(1, count + 1))
    p, n = points[row, column], np.nan_to_num(normals[row, column])
    values = np.zeros((len(p), INSIDE))
    values[:, COUNT], values[:, POINT], values[:, NORMAL] = 1, p, n
    values[:, SQUARES] = p[:, _FIRST] * p[:, _SECOND]
    values[:, SHADE] = shade = shades[row, column]
    values[:, SHADES] = (shade[:, 1:] ** 2).sum(axis=1)
    placed = p @ upright.axes.T
    inside, low, high = (
        ufunc.reduceat(of, starts, axis=0).astype(np.float64) if count else np.zeros((0, of.shape[1]))
        for ufunc, of in ((np.add, values), (np.minimum, placed), (np.maximum, placed))
    )
    between = np.zeros((count, count, BETWEEN))
    _touching(between, labels, points)
    _bending(between, labels, points, normals, shades)
    _seen_between(between, labels, points, inside[:, POINT][:, 2])
    inside[:, HIDDEN] = _hidden(labels, points, count)
    return Statistics(inside, low, high, between, np.arange(count), upright.supports)


def _add(between: Sums, a: Labels, b: Labels, columns: dict[int, NDArray[np.generic]]) -> None:
    """Sums of `columns` over pairs of cells with labels a and b, in both directions."""
    count = between.shape[0]
    key = (a - 1) * count + (b - 1)
    for column, values in columns.items():
        sums = np.bincount(key, weights=values, minlength=count * count).reshape(count, count)
        between[..., column] += sums + sums.T


def _touching(between: Sums, labels: Labels, points: Floats) -> None:
    """Cells side by side."""
    count = between.shape[0]
    for shift in ((0, 1), (1, 0)):
        a, b = shifted(labels, *shift)
        where = (a != b) & (a > 0) & (b > 0)
        a, b = a[where], b[where]
        z, far = (view[where] for view in shifted(points[..., 2], *shift))
        step = np.abs(z - far) > _STEP_M * np.maximum(z, z * z)
        _add(between, a, b, {TOUCH: np.ones(len(a)), STEP: step})
        for first, second, front in ((a, b, step & (z < far)), (b, a, step & (far < z))):
            key = (first - 1) * count + (second - 1)
            sums = np.bincount(key, weights=front, minlength=count * count)
            between[..., BEFORE] += sums.reshape(count, count)


def _bending(between: Sums, labels: Labels, points: Floats, normals: Floats, shades: Floats) -> None:
    """Cells four apart, which sees past rounded edges and narrow shadows."""
    for shift in ((0, 4), (4, 0), (3, 3), (3, -3)):
        a, b = shifted(labels, *shift)
        where = (a != b) & (a > 0) & (b > 0)
        a, b = a[where], b[where]
        p, q = (view[where] for view in shifted(points, *shift))
        m, n = (np.nan_to_num(view[where]) for view in shifted(normals, *shift))
        apart = q - p
        length = np.maximum(np.linalg.norm(apart, axis=-1), 1e-6)
        bend = ((n - m) * apart).sum(axis=-1) / length
        turned = np.abs(np.subtract(*(view[where] for view in shifted(shades, *shift))))
        near = np.abs(apart[:, 2]) < _SAME_SURFACE_M * np.maximum(1, p[:, 2] ** 2)
        columns = {
            WIDE: np.ones(len(a)),
            BENDS: near,
            BEND: near * bend,
            CONCAVE: near & (bend < -_SINES[0]),
            DEEP: near & (bend < -_SINES[1]),
            CONVEX: near & (bend > _SINES[1]),
            LIKE: near * (m * n).sum(axis=-1),
            BRIGHTER: near * turned[:, 0],
            COLOURED: near * np.hypot(turned[:, 1], turned[:, 2]),
        }
        _add(between, a, b, columns)


def _seen_between(between: Sums, labels: Labels, points: Floats, depth_sums: Sums) -> None:
    """What stands in the line between the middles of two patches: something nearer, or open space."""
    count = between.shape[0]
    size = np.bincount(labels.ravel(), minlength=count + 1)[1:]
    row, column = np.nonzero(labels)
    label = labels[row, column]
    middle = np.stack(
        [np.bincount(label, weights=of, minlength=count + 1)[1:] / size for of in (row, column)], axis=1
    )
    depth = depth_sums / size
    a, b = np.triu_indices(count, 1)
    t = (np.arange(_SAMPLES) + 0.5) / _SAMPLES
    place = middle[a, None] * (1 - t[:, None]) + middle[b, None] * t[:, None]
    r, c = place[..., 0].astype(np.int64), place[..., 1].astype(np.int64)
    there = labels[r, c] - 1
    other = (there != a[:, None]) & (there != b[:, None])
    line = depth[a, None] * (1 - t) + depth[b, None] * t
    z = points[r, c, 2]
    blocked = other & (z < line - _SAME_SURFACE_M)
    open_ = other & (z > line + _SAME_SURFACE_M)  # where nothing is seen may be a shadow
    for column_, values in ((SIGHT, other), (BLOCKED, blocked), (OPEN, open_)):
        between[a, b, column_] = between[b, a, column_] = values.sum(axis=1)


def _hidden(labels: Labels, points: Floats, count: int) -> Sums:
    """(P,) cells at whose side something else is nearer: the patch may go on behind it."""
    hidden = np.zeros(count + 1)
    for shift in ((0, 1), (1, 0)):
        a, b = shifted(labels, *shift)
        z, far = shifted(points[..., 2], *shift)
        step = _STEP_M * np.maximum(z, z * z)
        for mine, behind in ((b, far - z > step), (a, z - far > step)):
            hidden += np.bincount(mine[(a != b) & behind], minlength=count + 1)
    return hidden[1:]
