"""Memory of what moving cameras saw, which completes things that an image edge cuts.

One segment per thing is remembered, in the map frame. Current measurements take precedence: only points
outside the image, or occluded, are kept. Points that are seen again are replaced, and points that a camera
looks through are removed. Nothing is remembered for a camera that has never moved, or has no name.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from semmap.nodes.perception_node.input.cloud import Cloud, Transform
from semmap.nodes.perception_node.views.segmented_view import SegmentedView
from semmap.nodes.perception_node.views.segments import Segment
from semmap.schemas import errors

MOST_SEGMENTS = 100
"""Maximum number of remembered segments; the oldest are dropped."""
MOST_POINTS = 2000
"""Maximum number of points per segment [3.5 kB per hundred, with colours]."""
_FEWEST_POINTS = 30
_MOVED_M, _TURNED_COS = 0.05, float(np.cos(np.radians(3.0)))
_FEWEST_SEEN = 12
_SAME_SHARE = 0.5
_LARGE_SHARE = 0.05
_NEAR_M = 0.06
"""A cut thing continues if a remembered point is this near."""
_LOOSE = 0.1
"""A thing is whole if it continues at all but this share of its ends."""


class Recalled(NamedTuple):
    """The remainder of a remembered segment, and its thing from 1, or 0 if that is not in view."""

    rest: Segment
    thing: int


@dataclass(frozen=True)
class SegmentMemory:
    """The remembered segments, latest last, and the first pose (4, 4) of each camera.

    `moving`: the cameras that have left it.
    """

    segments: tuple[Segment, ...] = ()
    first: Mapping[str, Transform] = field(default_factory=dict)
    moving: frozenset[str] = frozenset()

    def recalled(
        self, sights: Sequence[SegmentedView], labels: Sequence[NDArray[np.int32]]
    ) -> list[Recalled]:
        """Return the part of each segment that is not visible now.

        `labels`: for each view (H, W) the thing, 0 for none.
        """
        views = [
            (sight.cloud, sight.map_from_camera, own)
            for sight, own in zip(sights, labels, strict=True)
            if sight.cloud.camera in self.moving
        ]
        if not views:
            return []
        found = (_recalled(segment, views) for segment in self.segments)
        return [own for own in found if len(own.rest.points) >= (1 if own.thing else _FEWEST_POINTS)]

    def after(
        self, sights: Sequence[SegmentedView], seen: Iterable[Sequence[Segment]], rest: Iterable[Segment]
    ) -> SegmentMemory:
        """Return the memory with the segments of `seen` things, and the `rest` of unseen ones."""
        first, moving = dict(self.first), set(self.moving)
        for sight in sights:
            cloud = sight.cloud
            if not cloud.camera or cloud.intrinsics is None or cloud.map_from_camera is None:
                continue
            if _apart(first.setdefault(cloud.camera, cloud.map_from_camera), cloud.map_from_camera):
                moving.add(cloud.camera)
        eyes = {tuple(s.map_from_camera[:3, 3].tolist()) for s in sights if s.cloud.camera in moving}
        new = [
            joined(segments)
            for segments in seen
            if any(tuple(segment.eye.tolist()) in eyes for segment in segments)
        ]
        return SegmentMemory((*rest, *new)[-MOST_SEGMENTS:], first, frozenset(moving))


def completed(own: Sequence[Segment], rests: Sequence[Segment]) -> tuple[Segment, ...]:
    """Return a thing's segments with the remembered ones: cut only where it does not continue."""
    everything = (*own, *rests)
    ends = [_loose(segment, [rest for rest in rests if rest is not segment]) for segment in everything]
    cut = sum(map(len, ends)) > _LOOSE * sum(len(segment.ends) for segment in everything)
    return tuple(replace(s, cut=cut, ends=loose) for s, loose in zip(everything, ends, strict=True))


def joined(segments: Sequence[Segment]) -> Segment:
    """Return several segments of one thing as one, seen from the main camera, with at most `MOST_POINTS`."""
    most = max(segments, key=lambda segment: segment.count)
    points = np.concatenate([segment.points for segment in segments])
    shades = [segment.colors for segment in segments if segment.colors is not None]
    some = np.linspace(0, len(points) - 1, min(len(points), MOST_POINTS)).astype(int)  # not whole columns
    return Segment(
        points=points[some],
        colors=np.concatenate(shades)[some] if len(shades) == len(segments) else None,
        label=0,
        eye=most.eye,
        cut=any(segment.cut for segment in segments),
        count=sum(segment.count for segment in segments),
        carrier=any(segment.carrier for segment in segments),
        ends=np.concatenate([segment.ends for segment in segments]),
    )


def _recalled(segment: Segment, views: Sequence[tuple[Cloud, Transform, NDArray[np.int32]]]) -> Recalled:
    away, ends_away = np.ones(len(segment.points), bool), np.ones(len(segment.ends), bool)
    hits = []
    for cloud, pose, labels in views:
        unseen, seen = _visibility(segment.points, cloud, pose, labels)
        away &= unseen
        hits.append(seen)
        if len(ends_away):
            ends_away &= _visibility(segment.ends, cloud, pose, labels)[0]
    counts = np.bincount(np.concatenate(hits), minlength=1)
    thing = int(counts.argmax())
    least = max(_FEWEST_SEEN, _LARGE_SHARE * len(segment.points))
    same = thing > 0 and counts[thing] >= least and counts[thing] > _SAME_SHARE * counts.sum()
    rest = replace(
        segment,
        points=segment.points[away],
        colors=None if segment.colors is None else segment.colors[away],
        ends=segment.ends[ends_away],
        count=int(segment.count * away.mean()),
    )
    return Recalled(rest, thing if same else 0)


def _visibility(
    points: NDArray[np.float32], cloud: Cloud, pose: Transform, labels: NDArray[np.int32]
) -> tuple[NDArray[np.bool_], NDArray[np.int32]]:
    """Return which map points (N, 3) a camera neither sees nor looks through, and labels of visible ones."""
    if cloud.intrinsics is None:
        raise errors.InternalError("the intrinsics of the camera are unknown")
    height, width = labels.shape
    camera = (points - pose[:3, 3].astype(np.float32)) @ pose[:3, :3].astype(np.float32)
    ahead = camera[:, 2] > 0.1
    pixel = camera[ahead] @ cloud.intrinsics.T.astype(np.float32)
    column, row = (pixel[:, :2] / pixel[:, 2:]).T
    inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    at = np.flatnonzero(ahead)[inside]
    row, column, depth = row[inside].astype(int), column[inside].astype(int), camera[at, 2]
    behind = cloud.points_camera[row, column, 2] - depth
    slack = 0.02 + 0.01 * depth**2
    unseen = np.ones(len(points), bool)
    with np.errstate(invalid="ignore"):
        unseen[at[behind > -slack]] = False
        surface = np.abs(behind) <= slack
    return unseen, labels[row[surface], column[surface]]


def _loose(segment: Segment, others: Sequence[Segment]) -> NDArray[np.float32]:
    """Return the ends of a segment at which no other segment continues."""
    if not len(segment.ends) or not others:
        return segment.ends
    tree = KDTree(np.concatenate([other.points for other in others]))
    apart, _ = tree.query(segment.ends, distance_upper_bound=_NEAR_M)
    return np.asarray(segment.ends[~np.isfinite(apart)])


def _apart(one: Transform, other: Transform) -> bool:
    cosine = (np.trace(one[:3, :3].T @ other[:3, :3]) - 1.0) / 2.0
    return bool(np.linalg.norm(one[:3, 3] - other[:3, 3]) > _MOVED_M or cosine < _TURNED_COS)
