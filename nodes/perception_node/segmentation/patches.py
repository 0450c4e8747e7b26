"""Small smooth patches: too many on purpose, so that none spans two objects."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from nodes.perception_node.segmentation.grid import Floats, Mask, shifted

Labels = NDArray[np.int32]

_CONCAVE = np.sin(np.radians(15))
_CONVEX = np.sin(np.radians(30))
_ACROSS = ((0, 2), (2, 0), (0, 4), (4, 0))  # the farther ones see past edges that the normals round off
_STEP_M = 0.007  # times z^2, at least z
_FEWEST_CELLS = 12
_GROWTH = 8


def patches(points: Floats, normals: Floats, where: Mask) -> Labels:
    """(h, w) numbers of patches from 1, without gaps, 0 for none; cells outside `where` are in none.

    Cells are cut apart where the surface is concave, sharply convex, or steps in depth.
    """
    cut = _cuts(points, normals, where)
    parts, count = ndimage.label(where & ~cut)
    sizes = np.bincount(parts.ravel(), minlength=count + 1)
    big = sizes >= _FEWEST_CELLS
    big[0] = False
    labels = np.where(big[parts], parts, 0).astype(np.int32)
    labels = grown(labels, points, where)
    rest, extra = ndimage.label(where & (labels == 0))
    keep = np.bincount(rest.ravel(), minlength=extra + 1) >= _FEWEST_CELLS
    keep[0] = False
    labels = np.where((labels == 0) & keep[rest], rest + count, labels).astype(np.int32)
    return _numbered(labels)


def _cuts(points: Floats, normals: Floats, where: Mask) -> Mask:
    """Cells at which two sides meet."""
    cut: Mask = ~np.isfinite(normals[..., 0])
    for rows, columns in _ACROSS:
        (p, q), (m, n) = shifted(points, rows, columns), shifted(normals, rows, columns)
        middle = cut[rows // 2 : cut.shape[0] - rows // 2, columns // 2 : cut.shape[1] - columns // 2]
        middle |= _bent(p, q, m, n)
    for rows, columns in ((0, 1), (1, 0)):
        z, far = shifted(points[..., 2], rows, columns)
        here, there = shifted(cut, rows, columns)
        step = _step(z, far)
        here |= step & (z > far)  # the farther of the two, whose surface goes on behind
        there |= step & (far >= z)
    return cut & where


def _bent(p: Floats, q: Floats, m: Floats, n: Floats) -> Mask:
    """Whether the surface bends too much between points p and q with normals m and n."""
    apart = q - p
    length = np.maximum(np.linalg.norm(apart, axis=-1), 1e-6)
    # sine of the bend, positive where convex: the normals turn away from one another
    bend = np.einsum("...i,...i->...", n - m, apart) / length
    return (bend < -_CONCAVE) | (bend > _CONVEX)


def _step(z: Floats, other: Floats) -> Mask:
    return np.abs(z - other) > _STEP_M * np.maximum(z, z * z)


def grown(labels: Labels, points: Floats, where: Mask, rounds: int = _GROWTH) -> Labels:
    """Labels spread over cells of `where` without one, each to the label of the nearest cell around it."""
    labels = labels.copy()
    height, width = labels.shape
    for _ in range(rounds):
        row, column = np.nonzero(where & (labels == 0))
        best = np.full(row.size, np.inf, np.float32)
        new = np.zeros(row.size, np.int32)
        for dr, dc in ((0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1)):
            r, c = np.clip(row + dr, 0, height - 1), np.clip(column + dc, 0, width - 1)
            step = np.abs(points[r, c, 2] - points[row, column, 2])
            takes = (labels[r, c] > 0) & (step < best) & ~_step(points[row, column, 2], points[r, c, 2])
            best[takes] = step[takes]
            new[takes] = labels[r, c][takes]
        if not new.any():
            break
        labels[row, column] = new
    return labels


def _numbered(labels: Labels) -> Labels:
    """The same with numbers from 1 without gaps."""
    used = np.unique(labels)
    used = used[used > 0]
    number = np.zeros(labels.max(initial=0) + 1, np.int32)
    number[used] = np.arange(1, len(used) + 1)
    return number[labels]
