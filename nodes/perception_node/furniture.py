"""Planes that are no part of the room but sides of things: table tops, the fronts of cupboards."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from nodes.perception_node.cloud import Floats
from nodes.perception_node.segmentation import Segmentation

_ROOM_M = 2.2
"""A wall is higher or wider, as far as it is seen."""

_NEAR_M = 0.03
_HANGING_M = 0.1
_EVERY = 4


def with_furniture(
    segmentation: Segmentation, points_map: Floats
) -> tuple[NDArray[np.int32], frozenset[int]]:
    """Labels (H, W) in which such planes are things too, with what hangs below them; and their numbers.

    `points_map`: (H, W, 3) [m].
    """
    labels, planes = segmentation.labels.copy(), segmentation.plane_labels
    sides = [
        number
        for number, plane in enumerate(segmentation.planes, 1)
        if plane.kind == "support" or (plane.kind == "wall" and _stands_free(points_map, planes == number))
    ]
    if not sides:
        return labels, frozenset()
    boxes = [_box(points_map[::_EVERY, ::_EVERY][planes[::_EVERY, ::_EVERY] == number]) for number in sides]
    first = int(labels.max(initial=0)) + 1
    body = [first + n for n in _touching(boxes)]
    for number, own in zip(sides, body, strict=True):
        labels[planes == number] = own
    for label, box in _boxes_of(segmentation.labels, points_map):
        for own, (low, high) in zip(body, boxes, strict=True):
            reaches = high[2] - _HANGING_M < box[1][2] < high[2] + 0.5 * _NEAR_M
            middle = (box[0] + box[1])[:2] / 2
            if reaches and (middle > low[:2] - _NEAR_M).all() and (middle < high[:2] + _NEAR_M).all():
                labels[segmentation.labels == label] = own
                break
    return labels, frozenset(body)


Corners = tuple[NDArray[np.float32], NDArray[np.float32]]


def _box(points: Floats) -> Corners:
    """The map's lowest and highest coordinates (3,) of points (N, 3), a few stray ones apart."""
    if not len(points):
        return np.full(3, np.inf, np.float32), np.full(3, -np.inf, np.float32)
    low, high = np.quantile(points, [0.01, 0.99], axis=0).astype(np.float32)
    return low, high


def _boxes_of(labels: NDArray[np.int32], points_map: Floats) -> list[tuple[int, Corners]]:
    thin = labels[::_EVERY, ::_EVERY]
    used = np.unique(thin[thin > 0])
    return [(int(label), _box(points_map[::_EVERY, ::_EVERY][thin == label])) for label in used]


def _stands_free(points_map: Floats, mask: NDArray[np.bool_]) -> bool:
    """Whether an upright plane ends within the picture and below a room's height."""
    if mask[0].any() or mask[:, 0].any() or mask[:, -1].any():
        return False
    low, high = _box(points_map[mask][::_EVERY])
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
