"""The points of a frame for viewers: in the map frame, subsampled, each with its observation."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.pipeline import FrameResult
from semmap.nodes.perception_node.views.segments import in_map
from semmap.schemas.perception import SegmentedCloud

MOST_POINTS = 20_000


def segmented_cloud(clouds: Sequence[Cloud], look: FrameResult) -> SegmentedCloud:
    """Combine all clouds of a frame into one message."""
    total = sum(cloud.points_camera.size // 3 for cloud in clouds)
    step = max(1, -(-total // MOST_POINTS))
    parts = [_thinned(cloud, labels, step) for cloud, labels in zip(clouds, look.labels, strict=True)]
    positions, colors, labels = (np.concatenate(columns) for columns in zip(*parts, strict=True))
    return SegmentedCloud(
        stamp_ns=look.observations.stamp_ns,
        positions=positions.astype("<f4").tobytes(),
        colors=colors.tobytes(),
        labels=labels.astype("<u2").tobytes(),
    )


def _thinned(
    cloud: Cloud, labels: NDArray[np.int32], step: int
) -> tuple[NDArray[np.float32], NDArray[np.uint8], NDArray[np.int32]]:
    pose = np.eye(4) if cloud.map_from_camera is None else cloud.map_from_camera
    points = in_map(cloud.points_camera.reshape(-1, 3)[::step], pose)
    seen = np.isfinite(points[:, 2])
    grey = np.full((len(points), 3), 128, np.uint8)
    colors = grey if cloud.colors is None else cloud.colors.reshape(-1, 3)[::step]
    return points[seen], colors[seen], labels.ravel()[::step][seen]
