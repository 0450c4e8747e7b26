"""Planes that are no part of the room but sides of things: table tops, the fronts of cupboards."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from semmap.nodes.perception_node.input.cloud import Floats
from semmap.nodes.perception_node.segmentation import Segmentation
from semmap.nodes.perception_node.views.segments import Segment

_ROOM_M = 2.2
"""A wall is higher or wider, as far as it is seen."""

_NEAR_M = 0.03
_BENEATH = 0.5
_HANGING = 0.6
"""What reaches to less of a top's height stands under it."""

_LYING_M = 0.004
"""What lies on a top, however thin, is mostly so much above it."""
_TOP_M = 0.05

_HIGHEST = 0.99  # what is higher may be a few stray points
_UNDER_M = 0.015
_STANDING = 0.5
"""What has a larger share of its points above a top stands on it, and ends there."""

EVERY = 4
"""Of so many rows and columns one is enough to tell how high and how wide a plane is."""


def with_furniture(segmentation: Segmentation, thin: Floats) -> tuple[NDArray[np.int32], frozenset[int]]:
    """Labels (H, W) in which such planes are things too, and the numbers of these.

    `thin`: (H / EVERY, W / EVERY, 3) of every so many rows and columns the points, map frame [m].
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
    """(H, W) pixels of what stands on a top (M, 3) that are below it: the rim of the table, its legs."""
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
    """Which groups of segments are one thing: a top, and what is below it and reaches up to near it."""
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
    """How high a top is, of which the highest points are noise."""
    return float(np.median(heights[heights > highest - _TOP_M]))


def _beneath(points: Floats, top: Floats) -> NDArray[np.bool_]:
    """(N,) which of some points (N, 3) are within the hull of those of a top (M, 3), as seen from above."""
    sides = ConvexHull(top[:, :2], qhull_options="QJ").equations  # a front alone is a line
    return np.asarray((points[:, :2] @ sides[:, :2].T + sides[:, 2] < _NEAR_M).all(axis=1))


Corners = tuple[NDArray[np.float32], NDArray[np.float32]]


def _box(points: Floats) -> Corners:
    """The map's lowest and highest coordinates (3,) of points (N, 3), a few stray ones apart."""
    if not len(points):
        return np.full(3, np.inf, np.float32), np.full(3, -np.inf, np.float32)
    low, high = np.quantile(points, [1 - _HIGHEST, _HIGHEST], axis=0).astype(np.float32)
    return low, high


def _stands_free(points: Floats, mask: NDArray[np.bool_]) -> bool:
    """Whether an upright plane ends within the picture and below a room's height."""
    if mask[0].any() or mask[:, 0].any() or mask[:, -1].any():
        return False
    low, high = _box(points)
    return bool(high[2] < _ROOM_M and np.hypot(*(high - low)[:2]) < _ROOM_M)


def _touching(boxes: Sequence[Corners]) -> list[int]:
    """For each box the number of the first one that it hangs together with."""
    group = list(range(len(boxes)))
    for a in range(len(boxes)):
        for b in range(a):
            (low, high), (lowest, highest) = boxes[a], boxes[b]
            if (low < highest + _NEAR_M).all() and (lowest < high + _NEAR_M).all():
                old, new = group[a], group[b]
                group = [new if number == old else number for number in group]
    return group
