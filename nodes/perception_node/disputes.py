"""Where one camera sees one thing and another one several, as the pictures with more to tell have it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from nodes.perception_node.fusion import shown_by_others
from nodes.perception_node.segments import Segment, in_map
from nodes.perception_node.sights import Sight, labelled

_APART = 0.06
"""Segments of one picture that are one thing with less likelihood are two, whatever another picture shows."""

_FEWEST = 40


def settled(sights: Sequence[Sight]) -> list[Sight]:
    """Sights in which segments are cut apart that another camera sees as several things, and surely so.

    A camera that sees a thing in pieces may be mistaken, or see better; how likely it held the pieces for one
    when it left them apart tells.
    """
    members, most, many = shown_by_others(sights)
    labels = [sight.labels for sight in sights]
    for at, (view, n) in enumerate(members):
        for other in range(len(sights)):
            pieces = [m for of, (v, m) in enumerate(members) if v == other and most[of, at] and many[of, at]]
            cut = sights[view].segments[n]
            if other == view or len(pieces) < 2 or cut.carrier:
                continue
            parts = [sights[other].segments[m] for m in pieces]
            count, group = connected_components(_may_be_one(parts, sights[other].same), directed=False)
            if count > 1:
                labels[view] = _divided(sights[view], labels[view], cut.label, parts, group)
    return [
        sight if own is sight.labels else labelled(sight, own, sight.carriers)
        for sight, own in zip(sights, labels, strict=True)
    ]


def _may_be_one(parts: Sequence[Segment], same: NDArray[np.float32]) -> NDArray[np.bool_]:
    number = np.array([part.label - 1 for part in parts])
    known = (number < len(same)) & np.array([not part.carrier for part in parts])
    may = np.ones((len(parts), len(parts)), bool)
    chance = same[np.ix_(number[known], number[known])]
    may[np.ix_(known, known)] = (chance == 0) | (chance >= _APART)
    return may


def _divided(
    sight: Sight,
    labels: NDArray[np.int32],
    label: int,
    parts: Sequence[Segment],
    group: NDArray[np.int32],
) -> NDArray[np.int32]:
    """Labels (H, W) in which the points of one label go to the groups of parts that they are nearest to."""
    pixels = np.flatnonzero(sight.labels == label)
    points = in_map(sight.cloud.points_camera.reshape(-1, 3)[pixels], sight.map_from_camera)
    whose = np.repeat(group, [len(part.points) for part in parts])
    tree = KDTree(np.concatenate([part.points for part in parts]))
    nearest = whose[tree.query(points)[1]]
    divided, free = labels.copy(), int(labels.max()) + 1
    for number in range(1, int(group.max()) + 1):
        own = pixels[nearest == number]
        if len(own) >= _FEWEST:
            divided.ravel()[own] = free
            free += 1
    return divided
