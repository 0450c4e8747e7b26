"""Which segments of several views show the same thing."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from nodes.perception_node.sights import Sight

_PROBES = 300
_SAME_SHARE = 0.5
_FEWEST_SEEN = 12
_LARGE_SHARE = 0.2

Member = tuple[int, int]
"""The number of a sight, and that of a segment in its `segments`."""


def fuse(sights: Sequence[Sight]) -> list[list[Member]]:
    """Group segments by the thing they show."""
    members, most, many = shown_by_others(sights)
    carrier = np.array([sights[view].segments[n].carrier for view, n in members], dtype=bool)
    same = (most & many) | (most & most.T)  # few points may lie where two things touch
    same &= carrier == carrier[:, None]  # what is flat looks like its table to another camera
    return _groups(same | same.T, members)


class Shown(NamedTuple):
    """What other cameras take segments for.

    `most`, `many`: (M, M) whether most of the points of one that another camera sees, and a large share of
    all its points, are of another segment there.
    """

    members: list[Member]
    most: NDArray[np.bool_]
    many: NDArray[np.bool_]


def shown_by_others(sights: Sequence[Sight]) -> Shown:
    """Look the points of each segment up in the other pictures.

    Where another camera sees them too, its label says what it took them for. Clouds without intrinsics or
    pose see nothing of what others do.
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
    return Shown(members, most, many)


def _labels_of(points: NDArray[np.float32], sight: Sight) -> NDArray[np.int32]:
    """The labels of those map points (N, 3) that a camera sees, and not merely what is before them."""
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
    """The connected components of a symmetrical relation (N, N)."""
    count, root = connected_components(same, directed=False)
    return [[members[int(at)] for at in np.flatnonzero(root == r)] for r in range(count)]
