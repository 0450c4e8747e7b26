"""The parts of views that belong to one thing each, in the map frame."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import Cloud, Floats, Transform
from semmap.nodes.perception_node.input.masks import DetectorLabel

MOST_POINTS = 3000
"""A segment of more points is thinned: what is learnt from it does not get better with more."""

ENDS_EVERY = 8
"""One in so many of the points at a picture's edge tells where a thing is cut."""

_LEAST_M = 0.005
"""What measures less is no thing, but one point seen again and again."""


@dataclass(frozen=True)
class Segment:
    """What one view shows of one thing.

    `points`: (N, 3), map frame [m]. `colors`: (N, 3) rgb, or None. `label`: its number in the view.
    `eye`: (3,), where the camera was [m]. `cut`: the picture's edge runs through it. `count`: how many points
    it had before it was thinned. `carrier`: it is a plane on which things may stand, or a side of one.
    `masked`: somebody else's detector cut it out; `said`: what that takes it for. `ends`: (E, 3), some of its
    points at the picture's edge, map frame [m].
    """

    points: Floats
    colors: NDArray[np.uint8] | None
    label: int
    eye: NDArray[np.float64]
    cut: bool
    count: int
    carrier: bool = False
    masked: bool = False
    said: DetectorLabel | None = None
    ends: Floats = field(default_factory=lambda: np.empty((0, 3), np.float32))


def map_points(cloud: Cloud, map_from_camera: Transform) -> Floats:
    """(H, W, 3) the cloud's points in the map frame [m]."""
    return in_map(cloud.points_camera, map_from_camera)


def in_map(points_camera: Floats, map_from_camera: Transform) -> Floats:
    """(..., 3) points of a camera's frame in the map frame [m]."""
    pose = map_from_camera.astype(np.float32)
    x, y, z = np.moveaxis(points_camera, -1, 0)
    points = np.empty_like(points_camera)
    for axis in range(3):  # a matrix product takes ten times as long for three columns
        points[..., axis] = pose[axis, 0] * x + pose[axis, 1] * y + pose[axis, 2] * z + pose[axis, 3]
    return points


def cut_out(
    cloud: Cloud,
    map_from_camera: Transform,
    labels: NDArray[np.int32],
    carriers: frozenset[int] = frozenset(),
) -> list[Segment]:
    """The segments of one labelled view: `labels` (H, W), 0 for background and where nothing was seen."""
    flat = labels.ravel().astype(np.uint16)  # of which more are compared at once
    points_camera = cloud.points_camera.reshape(-1, 3)
    edge = _at_edge(labels.shape) if cloud.organised else np.empty(0, np.intp)
    at_edge = flat[edge]
    found = []
    for label in range(1, int(labels.max(initial=0)) + 1):
        own = np.flatnonzero(flat == label)
        if not own.size:
            continue
        ends = edge[at_edge == label]
        thin = own[:: -(-len(own) // MOST_POINTS)]
        points = in_map(points_camera.take(thin, axis=0), map_from_camera)
        if max(np.ptp(points[:, axis]) for axis in range(3)) < _LEAST_M:
            continue
        found.append(
            Segment(
                points=points,
                colors=None if cloud.colors is None else cloud.colors.reshape(-1, 3).take(thin, axis=0),
                label=label,
                eye=map_from_camera[:3, 3],
                cut=len(ends) > 0,
                count=len(own),
                carrier=label in carriers,
                ends=in_map(points_camera.take(ends[::ENDS_EVERY], axis=0), map_from_camera),
            )
        )
    return found


@cache
def _at_edge(shape: tuple[int, int], margin: int = 2) -> NDArray[np.intp]:
    """The flat indices of the pixels at the edge of a picture (H, W)."""
    inner = np.zeros(shape, bool)
    inner[margin:-margin, margin:-margin] = True
    return np.flatnonzero(~inner)
