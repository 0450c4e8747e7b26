"""Segments: the parts of a view that belong to one thing, in the map frame."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import Cloud, Floats, Transform
from semmap.nodes.perception_node.input.masks import DetectorLabel

MOST_POINTS = 3000
"""A segment of more points is subsampled, since more points do not improve recognition."""

ENDS_EVERY = 8
"""Step between the points at an image edge that are kept as ends."""

_LEAST_M = 0.005
"""A smaller segment is a single point measured repeatedly."""


@dataclass(frozen=True)
class Segment:
    """The part of one thing in one view.

    `points`: (N, 3), map frame [m]. `colors`: (N, 3) rgb, or None. `label`: its number in the view. `eye`:
    (3,), camera position [m]. `cut`: an image edge cuts it. `count`: points before subsampling. `carrier`: a
    plane on which things may stand, or a side of one. `masked`: it is from an external detector, with label
    `said`. `ends`: (E, 3), some points at the image edge, map frame [m].
    """

    points: Floats
    colors: NDArray[np.uint8] | None
    label: int
    eye: NDArray[np.float64]
    cut: bool
    count: int
    carrier: bool = False
    masked: bool = False
    detector_label: DetectorLabel | None = None
    ends: Floats = field(default_factory=lambda: np.empty((0, 3), np.float32))


def map_points(cloud: Cloud, map_from_camera: Transform) -> Floats:
    """Return the cloud's points (H, W, 3) in the map frame [m]."""
    return in_map(cloud.points_camera, map_from_camera)


def in_map(points_camera: Floats, map_from_camera: Transform) -> Floats:
    """Transform points (..., 3) from a camera's frame to the map frame [m]."""
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
    """Return the segments of a labelled view: `labels` (H, W), 0 for background and missing depth."""
    flat = labels.ravel().astype(np.uint16)  # smaller integers are compared faster
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
    """Return the flat indices of the pixels at the edge of an image (H, W)."""
    inner = np.zeros(shape, bool)
    inner[margin:-margin, margin:-margin] = True
    return np.flatnonzero(~inner)
