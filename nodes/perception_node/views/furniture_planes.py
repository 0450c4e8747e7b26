"""Planes that are sides of furniture, not of the room: table tops, fronts of cupboards."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from semmap.nodes.perception_node.input.cloud import Floats
from semmap.nodes.perception_node.segmentation import Segmentation
from semmap.nodes.perception_node.views.segments import Segment

_ROOM_M = 2.2
"""A wall exceeds this height or width in the visible part."""

_NEAR_M = 0.03
_BENEATH = 0.5
_HANGING = 0.6
"""A thing that reaches less than this share of a top's height stands under it."""

_LYING_M = 0.004
"""A thing that lies on a top, however thin, is mostly this far above it."""
_TOP_M = 0.05

_HIGHEST = 0.99  # higher points may be outliers
_UNDER_M = 0.015
_STANDING = 0.5
"""A thing with a larger share of its points above a top stands on it, and ends there."""

EVERY = 4
"""Only every so many rows and columns are used to measure a plane."""


def with_furniture(segmentation: Segmentation, thin: Floats) -> tuple[NDArray[np.int32], frozenset[int]]:
    """Return labels (H, W) that include such planes as things, and their numbers.

    `thin`: (H / EVERY, W / EVERY, 3) the points of every so many rows and columns, map frame [m].
    """
    labels, planes = segmentation.labels.copy(), segmentation.plane_labels
    thin_planes = planes[::EVERY, ::EVERY]
    sides = [
        number
        for number, plane in enumerate(segmentation.planes, 1)
        if plane.kind == "support"
        or (plane.kind == "wall" and _stands_free(thin[thin_planes == number], planes == number))
    ]
    boxes = [_box(thin[thin_planes == number]) for number in sides]
    first = int(labels.max(initial=0)) + 1
    body = [first + n for n in _touching(boxes)]
    for n, own_label in zip(sides, body, strict=True):
        labels[planes == n] = own_label
    for n, own_label in zip(sides, body, strict=True):
        if segmentation.planes[n - 1].kind == "support":
            labels[_under(thin[thin_planes == n], labels, thin, frozenset(body))] = own_label
    return labels, frozenset(body)


def _under(
    top: Floats, labels: NDArray[np.int32], thin: Floats, furniture: frozenset[int]
) -> NDArray[np.bool_]:
    """Return the pixels (H, W) below a top (M, 3) of things that stand on it: the table's rim and legs."""
    own, height = labels[::EVERY, ::EVERY], float(np.median(top[:, 2]))
    ending = np.zeros_like(own)
    for label in np.unique(own[(thin[..., 2] < height - _UNDER_M) & (own > 0)]):
        rows, columns = np.nonzero(own == label)
        points = thin[rows, columns]
        low = points[:, 2] < height - _UNDER_M
        if label not in furniture and low.mean() < 1.0 - _STANDING:
            at = np.flatnonzero(low)[_beneath(points[low], top)]
            ending[rows[at], columns[at]] = label
    whole = ending.repeat(EVERY, axis=0).repeat(EVERY, axis=1)[: labels.shape[0], : labels.shape[1]]
    return np.asarray((whole > 0) & (whole == labels))


def join_legs(groups: Sequence[Sequence[Segment]]) -> list[list[int]]:
    """Return the groups of segments that are one thing: a top, and parts below that reach close to it."""
    clouds = [np.concatenate([segment.points for segment in group]) for group in groups]
    highest = [float(np.quantile(points[:, 2], _HIGHEST)) for points in clouds]
    tops = [n for n, group in enumerate(groups) if any(segment.carrier for segment in group)]
    middle = [float(np.median(points[:, 2])) for points in clouds]
    levels = {n: _level(clouds[n][:, 2], highest[n]) for n in tops}
    joined = {n: [n] for n in range(len(groups))}
    for n, own in enumerate(highest):
        if n in tops:
            continue
        for top in tops:
            high = highest[top]
            reaches = _HANGING * high < own < high + 0.5 * _NEAR_M
            lies_on = middle[n] > levels[top] + _LYING_M
            if reaches and not lies_on and _beneath(clouds[n], clouds[top]).mean() > _BENEATH:
                joined[top] += joined.pop(n)
                break
    return list(joined.values())


def _level(heights: Floats, highest: float) -> float:
    """Return the height of a top, whose highest points are noise."""
    return float(np.median(heights[heights > highest - _TOP_M]))


def _beneath(points: Floats, top: Floats) -> NDArray[np.bool_]:
    """Return which points (N, 3) lie within the hull of a top (M, 3), seen from above."""
    sides = ConvexHull(top[:, :2], qhull_options="QJ").equations  # a front alone is a line
    return np.asarray((points[:, :2] @ sides[:, :2].T + sides[:, 2] < _NEAR_M).all(axis=1))


Corners = tuple[NDArray[np.float32], NDArray[np.float32]]


def _box(points: Floats) -> Corners:
    """Return the bounds (3,) of points (N, 3), without outliers."""
    if not len(points):
        return np.full(3, np.inf, np.float32), np.full(3, -np.inf, np.float32)
    low, high = np.quantile(points, [1 - _HIGHEST, _HIGHEST], axis=0).astype(np.float32)
    return low, high


def _stands_free(points: Floats, mask: NDArray[np.bool_]) -> bool:
    """Return whether an upright plane ends within the image and below a room's height."""
    if mask[0].any() or mask[:, 0].any() or mask[:, -1].any():
        return False
    low, high = _box(points)
    return bool(high[2] < _ROOM_M and np.hypot(*(high - low)[:2]) < _ROOM_M)


def _touching(boxes: Sequence[Corners]) -> list[int]:
    """Return for each box the first one that it is connected to."""
    group = list(range(len(boxes)))
    for a in range(len(boxes)):
        for b in range(a):
            (low, high), (lowest, highest) = boxes[a], boxes[b]
            if (low < highest + _NEAR_M).all() and (lowest < high + _NEAR_M).all():
                old, new = group[a], group[b]
                group = [new if number == old else number for number in group]
    return group
