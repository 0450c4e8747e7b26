"""Over-segmentation by local convexity: small smooth patches, so small that none spans two objects."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import ndimage

from semmap.nodes.perception_node.segmentation.working_image import Floats, Labels, Mask, shifted

_CONCAVE = np.sin(np.radians(15))
_CONVEX = np.sin(np.radians(30))
_ACROSS = ((0, 2), (2, 0), (0, 4), (4, 0))  # the farther ones see past edges that the normals round off
_STEP_M = 0.007  # times z^2, at least z
_FEWEST_CELLS = 12
_GROWTH = 8


def patches(points: Floats, normals: Floats, where: Mask) -> Labels:
    """Return (h, w) numbers of patches from 1, without gaps, 0 for none and for cells outside `where`.

    Cells are separated where the surface is concave, sharply convex, or has a depth step.
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
    """Return the cells at borders of patches."""
    cut: Mask = ~np.isfinite(normals[0])
    height, width = cut.shape
    for rows, columns in _ACROSS:
        apart, turn = (
            [there - here for here, there in (shifted(axis, rows, columns) for axis in of)]
            for of in (points, normals)
        )
        # sine of the bend times the distance, positive where convex: the normals turn away from one another
        bend = _dot(turn, apart)
        length = np.sqrt(_dot(apart, apart))
        middle = cut[rows // 2 : height - rows // 2, columns // 2 : width - columns // 2]
        middle |= (bend < -_CONCAVE * length) | (bend > _CONVEX * length)
    for rows, columns in ((0, 1), (1, 0)):
        z, far = shifted(points[2], rows, columns)
        here, there = shifted(cut, rows, columns)
        step = _step(z, far)
        here |= step & (z > far)  # the farther of the two, whose surface continues behind
        there |= step & (far >= z)
    return cut & where


def _dot(a: Sequence[Floats], b: Sequence[Floats]) -> Floats:
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def _step(z: Floats, other: Floats) -> Mask:
    return np.asarray(np.abs(z - other) > _STEP_M * np.maximum(z, z * z))


def grown(labels: Labels, points: Floats, where: Mask) -> Labels:
    """Return labels grown into unlabelled cells of `where`, each from the nearest adjacent cell."""
    padded = np.pad(labels, 1)
    flat, width = padded.ravel(), padded.shape[1]
    around = np.array([[1], [-1], [width], [-width]])
    z = np.pad(points[2], 1, constant_values=np.nan).ravel()
    free = np.pad(where & (labels == 0), 1).ravel()
    cells = np.flatnonzero(free)
    for _ in range(_GROWTH):
        sides, own = cells + around, z[cells]
        off = np.abs(z[sides] - own)
        off[~(off <= _STEP_M * np.maximum(own, own * own)) | (flat[sides] == 0)] = np.inf
        best = off.argmin(axis=0), np.arange(len(cells))
        takes = np.isfinite(off[best])
        new = cells[takes]
        flat[new] = flat[sides[best][takes]]
        free[new] = False
        cells = (new + around).ravel()  # only cells next to these can change
        cells = cells[free[cells]]
    return padded[1:-1, 1:-1]


def _numbered(labels: Labels) -> Labels:
    """Return the labels renumbered from 1 without gaps."""
    used = np.bincount(labels.ravel()) > 0
    used[0] = False
    number = np.where(used, np.cumsum(used), 0).astype(np.int32)
    return number[labels]
