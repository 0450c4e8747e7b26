"""Splits a segment of one camera that another camera sees as several things."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from semmap.nodes.perception_node.views.fusion import matching_segments
from semmap.nodes.perception_node.views.segmented_view import SegmentedView, with_labels
from semmap.nodes.perception_node.views.segments import Segment, in_map

_FEWEST = 40


def resolve_splits(sights: Sequence[SegmentedView]) -> list[SegmentedView]:
    """Return the views with such segments split.

    Either camera may be wrong. Whether the pieces are one thing is left to recognition, which uses `same`.
    """
    members, same = matching_segments(sights)
    labels = [sight.labels for sight in sights]
    for at, (view, n) in enumerate(members):
        for other in range(len(sights)):
            pieces = [m for of, (v, m) in enumerate(members) if v == other and same[of, at]]
            cut = sights[view].segments[n]
            if other != view and len(pieces) > 1 and not cut.carrier:
                parts = [sights[other].segments[m] for m in pieces]
                labels[view] = _divided(sights[view], labels[view], cut.label, parts)
    both = zip(sights, labels, strict=True)
    return [sight if own is sight.labels else _cut_up(sight, own) for sight, own in both]


def _divided(
    sight: SegmentedView, labels: NDArray[np.int32], label: int, parts: Sequence[Segment]
) -> NDArray[np.int32]:
    """Return labels (H, W) in which the points of one label are assigned to the nearest of the parts."""
    pixels = np.flatnonzero(sight.labels == label)
    points = in_map(sight.cloud.points_camera.reshape(-1, 3)[pixels], sight.map_from_camera)
    whose = np.repeat(np.arange(len(parts)), [len(part.points) for part in parts])
    tree = KDTree(np.concatenate([part.points for part in parts]))
    nearest = whose[tree.query(points)[1]]
    divided, free = labels.copy(), int(labels.max()) + 1
    for number in range(1, len(parts)):
        own = pixels[nearest == number]
        if len(own) >= _FEWEST:
            divided.ravel()[own] = free
            free += 1
    return divided


def _cut_up(sight: SegmentedView, labels: NDArray[np.int32]) -> SegmentedView:
    """Return the view with labels (H, W) that may split former labels.

    Parts inherit the statistics of their former label, and count as probably one thing.
    """
    before = np.arange(int(labels.max()) + 1)
    before[labels] = sight.labels
    before = before[1:] - 1
    same = (before[:, None] == before).astype(np.float32)
    asked = np.flatnonzero(before < len(sight.same))
    others = ~(same[np.ix_(asked, asked)] > 0)
    same[np.ix_(asked, asked)] += others * sight.same[np.ix_(before[asked], before[asked])]
    return replace(with_labels(sight, labels, sight.carriers), same=same)
