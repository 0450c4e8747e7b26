"""One cloud, segmented."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from nodes.perception_node.input.cloud import Cloud, Floats
from nodes.perception_node.segmentation import Plane, Segmentation, segment
from nodes.perception_node.views.furniture_planes import EVERY, with_furniture
from nodes.perception_node.views.segments import Segment, cut_out, in_map
from nodes.perception_node.views.supports import Support, support_of


@dataclass(frozen=True)
class Sight:
    """A cloud in the map, with its segments.

    `map_from_camera`: (4, 4); where nobody knows it, the largest plane is taken for the map's floor.
    `labels`: (H, W) the segment of each pixel, 0 for none. `carriers`: on which others may stand. `planes`:
    (H, W) the plane of each pixel, 0 for none. `supports`: its level planes. `same`: (N, N) how
    likely segments n + 1 and m + 1 are one all the same, 0 where nobody knows.
    """

    cloud: Cloud
    map_from_camera: NDArray[np.float64]
    labels: NDArray[np.int32]
    carriers: frozenset[int]
    planes: NDArray[np.int32]
    supports: tuple[Support, ...]
    same: NDArray[np.float32]
    segments: tuple[Segment, ...] = ()


def see(cloud: Cloud) -> Sight:
    """Take a cloud apart."""
    segmentation = segment(cloud)
    pose = _standing_on(segmentation.planes) if cloud.map_from_camera is None else cloud.map_from_camera
    thin = in_map(cloud.points_camera[::EVERY, ::EVERY], pose)
    labels, carriers = segmentation.labels, frozenset[int]()
    if cloud.map_from_camera is not None:  # else the largest plane is taken for the floor, whatever it is
        labels, carriers = with_furniture(segmentation, thin)
    supports = _supports(segmentation, thin)
    bare = Sight(cloud, pose, labels, carriers, segmentation.plane_labels, supports, segmentation.same)
    return labelled(bare, labels, carriers)


def labelled(sight: Sight, labels: NDArray[np.int32], carriers: frozenset[int]) -> Sight:
    """The same cloud cut up by other labels (H, W)."""
    segments = cut_out(sight.cloud, sight.map_from_camera, labels, carriers)
    return replace(sight, labels=labels, carriers=carriers, segments=tuple(segments))


def _standing_on(planes: tuple[Plane, ...]) -> NDArray[np.float64]:
    """A map frame whose floor is the largest plane, with the camera above its origin."""
    pose = np.eye(4)
    if planes:
        plane = max(planes, key=lambda plane: plane.points)
        up = plane.normal
        ahead = np.array([0.0, 0.0, 1.0]) - up * up[2]
        if np.linalg.norm(ahead) < 0.1:  # the camera looks straight down
            ahead = np.array([0.0, -1.0, 0.0]) - up * -up[1]
        ahead /= np.linalg.norm(ahead)
        pose[:3, :3] = np.stack([ahead, np.cross(up, ahead), up])
        pose[2, 3] = -plane.offset_m
    return pose


def _supports(segmentation: Segmentation, thin: Floats) -> tuple[Support, ...]:
    level = [
        n for n, plane in enumerate(segmentation.planes, 1) if plane.kind in ("floor", "support", "plane")
    ]
    planes = segmentation.plane_labels[::EVERY, ::EVERY]
    return tuple(support_of(thin, planes == n) for n in level if (planes == n).any())
