"""The parts of views that belong to one thing each, in the map frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nodes.perception_node.cloud import Cloud, Floats

MOST_POINTS = 3000
"""A segment of more points is thinned: what is learnt from it does not get better with more."""


_LEAST_M = 0.005
"""What measures less is no thing, but one point seen again and again."""


@dataclass(frozen=True)
class Segment:
    """What one view shows of one thing.

    `points`: (N, 3), map frame [m]. `colors`: (N, 3) rgb, or None. `label`: its number in the view.
    `eye`: (3,), where the camera was [m]. `cut`: the picture's edge runs through it. `count`: how many points
    it had before it was thinned. `carrier`: it is a plane on which things may stand, or a side of one.
    """

    points: Floats
    colors: NDArray[np.uint8] | None
    label: int
    eye: NDArray[np.float64]
    cut: bool
    count: int
    carrier: bool = False


def map_points(cloud: Cloud, map_from_camera: NDArray[np.float64]) -> Floats:
    """(H, W, 3) the cloud's points in the map frame [m]."""
    pose = map_from_camera.astype(np.float32)
    x, y, z = np.moveaxis(cloud.points_camera, -1, 0)
    points = np.empty_like(cloud.points_camera)
    for axis in range(3):  # a matrix product takes ten times as long for three columns
        points[..., axis] = pose[axis, 0] * x + pose[axis, 1] * y + pose[axis, 2] * z + pose[axis, 3]
    return points


def cut_out(
    cloud: Cloud,
    points_map: Floats,
    labels: NDArray[np.int32],
    eye: NDArray[np.float64],
    carriers: frozenset[int] = frozenset(),
) -> list[Segment]:
    """The segments of one labelled view: `points_map` (H, W, 3), `labels` (H, W) with 0 for background."""
    pixels = np.flatnonzero((labels.ravel() > 0) & np.isfinite(points_map[..., 2]).ravel())
    owner = labels.ravel()[pixels].astype(np.uint16)  # which is sorted by counting
    order = np.argsort(owner, kind="stable")
    pixels, owner = pixels[order], owner[order]
    at_edge = _labels_at_edge(labels) if cloud.organised else frozenset()
    found = []
    for own in np.split(pixels, np.flatnonzero(np.diff(owner)) + 1) if len(pixels) else ():
        label = int(labels.ravel()[own[0]])
        thin = own[:: max(1, -(-len(own) // MOST_POINTS))]
        if np.ptp(points_map.reshape(-1, 3)[thin], axis=0).max() < _LEAST_M:
            continue
        found.append(
            Segment(
                points=points_map.reshape(-1, 3)[thin],
                colors=None if cloud.colors is None else cloud.colors.reshape(-1, 3)[thin],
                label=label,
                eye=eye,
                cut=label in at_edge,
                count=len(own),
                carrier=label in carriers,
            )
        )
    return found


def _labels_at_edge(labels: NDArray[np.int32], margin: int = 2) -> frozenset[int]:
    borders = (labels[:margin], labels[-margin:], labels[:, :margin], labels[:, -margin:])
    return frozenset(int(label) for border in borders for label in np.unique(border))
