"""Fusion: finds segments of several views that show the same thing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from semmap.nodes.perception_node.views.segmented_view import SegmentedView

_PROBES = 300
_SAME_SHARE = 0.5
_FEWEST_SEEN = 12
_LARGE_SHARE = 0.2
_DOUBT = 0.01

Member = tuple[int, int]
"""The index of a view, and that of a segment in its `segments`."""


def group_segments(sights: Sequence[SegmentedView]) -> list[list[Member]]:
    """Group segments by thing."""
    members, same = matching_segments(sights)
    return _groups(same, members)


def same_thing_logits(
    sights: Sequence[SegmentedView], groups: Sequence[Sequence[Member]]
) -> NDArray[np.float64]:
    """Return (2, G, G) the minimum and maximum logit, over cameras, that two groups are one thing.

    The value is 0 if no camera compared them.
    """
    group_of = [np.zeros(int(sight.labels.max(initial=0)) + 1, int) for sight in sights]
    for number, members in enumerate(groups, 1):
        for view, n in members:
            group_of[view][sights[view].segments[n].label] = number
    least, most = np.full((2, len(groups) + 1, len(groups) + 1), np.inf)
    most = -most
    for sight, group in zip(sights, group_of, strict=True):
        a, b = np.nonzero(sight.same)
        inside = np.maximum(a, b) + 1 < len(group)
        a, b = a[inside], b[inside]
        chance = np.clip(sight.same[a, b], _DOUBT, 1.0 - _DOUBT)
        pair = group[a + 1], group[b + 1]
        for end, ufunc in ((least, np.minimum), (most, np.maximum)):
            ufunc.at(end, pair, np.log(chance / (1.0 - chance)))
    both = np.stack([least, most])[:, 1:, 1:]
    return np.where(np.isfinite(both), both, 0.0)


def matching_segments(sights: Sequence[SegmentedView]) -> tuple[list[Member], NDArray[np.bool_]]:
    """Return all segments, and (M, M) whether one matches the other in another view.

    A match requires that most of its points visible in the other view lie on the other segment, and that
    these are a large share of all its points or the same holds in reverse. Clouds without intrinsics or pose
    have no matches.
    """
    members = [(view, n) for view, sight in enumerate(sights) for n in range(len(sight.segments))]
    row = {(view, sights[view].segments[n].label): at for at, (view, n) in enumerate(members)}
    most, many = np.zeros((2, len(members), len(members)), bool)
    for at, (view, n) in enumerate(members):
        points = sights[view].segments[n].points
        probes = points[:: max(1, len(points) // _PROBES)]
        for other, sight in enumerate(sights):
            if other == view:
                continue
            hits = _labels_of(probes, sight)
            for label, count in zip(*np.unique(hits[hits > 0], return_counts=True), strict=True):
                there = row.get((other, int(label)))
                if there is not None and count >= _FEWEST_SEEN:
                    most[at, there] = count > _SAME_SHARE * len(hits)
                    many[at, there] = count > _LARGE_SHARE * len(probes)
    carrier = np.array([sights[view].segments[n].carrier for view, n in members], dtype=bool)
    same = (most & many) | (most & most.T)  # two things may touch in a few points
    return members, same & (carrier == carrier[:, None])  # a flat thing may merge with its table


def _labels_of(points: NDArray[np.float32], sight: SegmentedView) -> NDArray[np.int32]:
    """Return the labels of map points (N, 3) that a camera sees unoccluded."""
    cloud, pose = sight.cloud, sight.map_from_camera
    if cloud.intrinsics is None or cloud.map_from_camera is None:
        return np.empty(0, np.int32)
    camera = (points - pose[:3, 3]) @ pose[:3, :3]
    camera = camera[camera[:, 2] > 0.1]
    pixel = camera @ cloud.intrinsics.T
    column, row = (pixel[:, :2] // pixel[:, 2:]).astype(int).T
    height, width = sight.labels.shape
    inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    column, row, depth = column[inside], row[inside], camera[inside, 2]
    with np.errstate(invalid="ignore"):
        visible = np.abs(cloud.points_camera[row, column, 2] - depth) < 0.01 + 0.008 * depth**2
    return np.asarray(sight.labels[row[visible], column[visible]])


def _groups(same: NDArray[np.bool_], members: Sequence[Member]) -> list[list[Member]]:
    """Return the connected components of a relation (N, N)."""
    count, root = connected_components(same, directed=False)
    return [[members[int(at)] for at in np.flatnonzero(root == r)] for r in range(count)]
