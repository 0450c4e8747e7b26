"""Which segments of several views show the same thing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from nodes.perception_node.cloud import Cloud
from nodes.perception_node.segments import Segment

_PROBES = 300
_SAME_SHARE = 0.5
_FEWEST_SEEN = 12


def fuse(
    segments: Sequence[Segment], clouds: Sequence[Cloud], labels: Sequence[NDArray[np.int32]]
) -> list[list[Segment]]:
    """Group segments by the thing they show.

    The points of a segment are looked up in the other pictures: where another camera sees them too, its label
    says what it took them for. Clouds without intrinsics or pose see nothing of what others do.
    """
    place = {(segment.view, segment.label): at for at, segment in enumerate(segments)}
    votes = np.zeros((len(segments), len(segments)))
    seen = np.zeros((len(segments), len(clouds)))
    for at, segment in enumerate(segments):
        probes = segment.points[:: max(1, len(segment.points) // _PROBES)]
        for view, (cloud, label) in enumerate(zip(clouds, labels, strict=True)):
            if view == segment.view:
                continue
            hits = _labels_of(probes, cloud, label)
            seen[at, view] = len(hits)
            for other, count in zip(*np.unique(hits[hits > 0], return_counts=True), strict=True):
                if (view, int(other)) in place:
                    votes[at, place[view, int(other)]] = count
    views = np.array([segment.view for segment in segments], dtype=int)
    shown = np.maximum(seen[:, views] if len(segments) else seen, 1)
    same = (votes > _SAME_SHARE * shown) & (votes >= _FEWEST_SEEN)
    return _groups(same | same.T, segments)


def _labels_of(points: NDArray[np.float32], cloud: Cloud, labels: NDArray[np.int32]) -> NDArray[np.int32]:
    """The labels of those map points (N, 3) that the cloud's camera sees, not merely what is before them."""
    if cloud.intrinsics is None or cloud.map_from_camera is None:
        return np.empty(0, np.int32)
    rotation, shift = cloud.map_from_camera[:3, :3], cloud.map_from_camera[:3, 3]
    camera = (points - shift) @ rotation
    camera = camera[camera[:, 2] > 0.1]
    pixel = camera @ cloud.intrinsics.T
    column, row = (pixel[:, :2] // pixel[:, 2:]).astype(int).T
    height, width = labels.shape
    inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    column, row, depth = column[inside], row[inside], camera[inside, 2]
    with np.errstate(invalid="ignore"):
        visible = np.abs(cloud.points_camera[row, column, 2] - depth) < 0.01 + 0.008 * depth**2
    return np.asarray(labels[row[visible], column[visible]])


def _groups(same: NDArray[np.bool_], segments: Sequence[Segment]) -> list[list[Segment]]:
    """The connected components of a symmetrical relation (N, N)."""
    root = np.arange(len(segments))
    for a, b in np.argwhere(same):
        root[root == root[a]] = root[b]
    return [[segments[int(i)] for i in np.flatnonzero(root == r)] for r in np.unique(root)]
