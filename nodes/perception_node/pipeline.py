"""From clouds to observations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nodes.perception_node.boxes import visible_box
from nodes.perception_node.cloud import Cloud
from nodes.perception_node.fusion import fuse
from nodes.perception_node.plain_segmentation import label_segments, supports_of
from nodes.perception_node.segments import Segment, cut_out, map_points
from schemas.entities import Pose, orientation_from_yaw
from schemas.perception import CameraView, Observation, Observations


@dataclass(frozen=True)
class Learnt:
    """What training found."""


@dataclass(frozen=True)
class Look:
    """What one look gave: the observations, and for each cloud (H, W) whose pixel belongs to which of them.

    In `labels` 0 is background and n stands for `observations.observations[n - 1]`.
    """

    observations: Observations
    labels: tuple[NDArray[np.int32], ...]


def observe(clouds: Sequence[Cloud], learnt: Learnt) -> Observations:
    """What these clouds, taken at the same time, show in the map frame; see `look`."""
    return look(clouds, learnt).observations


def look(clouds: Sequence[Cloud], learnt: Learnt) -> Look:
    """Find the things that clouds, taken at the same time, show; what several of them see is one thing."""
    poses = [np.eye(4) if cloud.map_from_camera is None else cloud.map_from_camera for cloud in clouds]
    points = [map_points(cloud, pose) for cloud, pose in zip(clouds, poses, strict=True)]
    labels = [label_segments(p, cloud.points_camera[..., 2]) for p, cloud in zip(points, clouds, strict=True)]
    segments = [
        segment
        for view, cloud in enumerate(clouds)
        for segment in cut_out(cloud, points[view], labels[view], view, poses[view][:3, 3])
    ]
    supports = sorted(height for p in points for height in supports_of(p))
    things = fuse(segments, clouds, labels)
    stamp_ns = max((cloud.stamp_ns for cloud in clouds), default=0)
    observations = tuple(_observation(thing, supports) for thing in things)
    views = tuple(_view(cloud, pose) for cloud, pose in zip(clouds, poses, strict=True))
    return Look(
        Observations(stamp_ns=stamp_ns, views=views, observations=observations), _relabelled(labels, things)
    )


def _observation(thing: Sequence[Segment], supports: Sequence[float]) -> Observation:
    points = np.concatenate([segment.points for segment in thing])
    lowest = float(np.quantile(points[:, 2], 0.01))
    below = [height for height in supports if height < lowest + 0.03]
    box = visible_box(points, below[-1] if below else None)
    x, y, z = (float(v) for v in box.bottom_m)
    a, b, c = (float(v) for v in box.size_m)
    return Observation(
        class_="Object",
        probability=0.5,
        pose=Pose(position_m=(x, y, z), orientation_wxyz=orientation_from_yaw(box.yaw_rad)),
        size_m=(a, b, c),
        points=sum(segment.count for segment in thing),
        whole=not any(segment.cut for segment in thing),
    )


def _view(cloud: Cloud, pose: NDArray[np.float64]) -> CameraView:
    height, width = cloud.points_camera.shape[:2]
    return CameraView(
        camera=cloud.camera,
        width=width,
        height=height,
        stamp_ns=cloud.stamp_ns,
        intrinsics=() if cloud.intrinsics is None else tuple(cloud.intrinsics.ravel().tolist()),
        map_from_camera=tuple(pose.ravel().tolist()),
    )


def _relabelled(
    labels: Sequence[NDArray[np.int32]], things: Sequence[Sequence[Segment]]
) -> tuple[NDArray[np.int32], ...]:
    numbers = [np.zeros(int(label.max(initial=0)) + 1, np.int32) for label in labels]
    for number, thing in enumerate(things, 1):
        for segment in thing:
            numbers[segment.view][segment.label] = number
    return tuple(number[label] for number, label in zip(numbers, labels, strict=True))
