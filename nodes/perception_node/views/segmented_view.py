"""One segmented cloud."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import Cloud, Floats
from semmap.nodes.perception_node.segmentation import Plane, Segmentation, segment
from semmap.nodes.perception_node.segmentation.gravity import (
    doubt_vertical,
    level_plane,
    room_pose,
    standing_on,
)
from semmap.nodes.perception_node.segmentation.unorganised_cloud import as_image
from semmap.nodes.perception_node.segmentation.working_image import grid_of
from semmap.nodes.perception_node.views.furniture_planes import EVERY, with_furniture
from semmap.nodes.perception_node.views.segments import Segment, cut_out, in_map
from semmap.nodes.perception_node.views.supports import Support, support_of


@dataclass(frozen=True)
class SegmentedView:
    """A cloud in the map frame, with its segments.

    `map_from_camera`: (4, 4); if unknown, the visible floor is z = 0, or the largest plane if there is only
    one. `labels`: (H, W) the segment of each pixel, 0 for none. `carriers`: segments on which others may
    stand. `planes`: (H, W) the plane of each pixel, 0 for none. `supports`: level planes. `same`: (N, N) the
    probability that segments n + 1 and m + 1 are one thing, 0 if unknown. `unused_masks`: the numbers of a
    detector's masks without a segment. `notes`: doubts about the cloud and its pose, for the user.
    """

    cloud: Cloud
    map_from_camera: NDArray[np.float64]
    labels: NDArray[np.int32]
    carriers: frozenset[int]
    planes: NDArray[np.int32]
    supports: tuple[Support, ...]
    same: NDArray[np.float32]
    segments: tuple[Segment, ...] = ()
    unused_masks: tuple[int, ...] = ()
    notes: tuple[str, ...] = ()


def segment_cloud(cloud: Cloud) -> SegmentedView:
    """Segment a cloud. An unorganised cloud is converted to the image of a camera at its origin."""
    if not cloud.organised:
        return _unorganised_view(cloud)
    placed = _placed(cloud)
    segmentation = segment(placed)
    pose, notes = placed.map_from_camera, cloud.notes
    if pose is None:
        pose = _above_largest(segmentation.planes)
    if cloud.map_from_camera is None and (doubt := doubt_vertical(pose)):
        notes += (doubt,)
    thin = in_map(cloud.points_camera[::EVERY, ::EVERY], pose)
    labels, carriers = segmentation.labels, frozenset[int]()
    if placed.map_from_camera is not None:  # else the largest plane counts as the floor
        labels, carriers = with_furniture(segmentation, thin)
    supports = _supports(segmentation, thin)
    bare = SegmentedView(
        cloud, pose, labels, carriers, segmentation.plane_labels, supports, segmentation.same, notes=notes
    )
    return with_labels(bare, labels, carriers)


def with_labels(sight: SegmentedView, labels: NDArray[np.int32], carriers: frozenset[int]) -> SegmentedView:
    """Return the view segmented by other labels (H, W)."""
    segments = cut_out(sight.cloud, sight.map_from_camera, labels, carriers)
    return replace(sight, labels=labels, carriers=carriers, segments=tuple(segments))


def _unorganised_view(cloud: Cloud) -> SegmentedView:
    image, pixel = as_image(cloud)
    seen = segment_cloud(image)
    labels, planes = (np.append(of.ravel(), np.int32(0))[pixel][None, :] for of in (seen.labels, seen.planes))
    return with_labels(replace(seen, cloud=cloud, planes=planes), labels, seen.carriers)


def _placed(cloud: Cloud) -> Cloud:
    """Return the cloud with a pose computed from the visible floor, if its pose is unknown."""
    if cloud.map_from_camera is not None:
        return cloud
    return replace(cloud, map_from_camera=room_pose(grid_of(cloud).points))


def _above_largest(planes: tuple[Plane, ...]) -> NDArray[np.float64]:
    """Return a map frame whose floor is the largest plane, preferably level."""
    largest = level_plane(planes) or max(planes, key=lambda plane: plane.points, default=None)
    return np.eye(4) if largest is None else standing_on(largest)


def _supports(segmentation: Segmentation, thin: Floats) -> tuple[Support, ...]:
    level = [
        n for n, plane in enumerate(segmentation.planes, 1) if plane.kind in ("floor", "support", "plane")
    ]
    planes = segmentation.plane_labels[::EVERY, ::EVERY]
    return tuple(support_of(thin, planes == n) for n in level if (planes == n).any())
