"""One cloud, taken apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nodes.perception_node.cloud import Cloud
from nodes.perception_node.plain_segmentation import label_segments, supports_of
from nodes.perception_node.segments import Segment, cut_out, map_points


@dataclass(frozen=True)
class Sight:
    """A cloud with its segments, and `labels` (H, W) that say whose each pixel is, 0 for none.

    `map_from_camera`: (4, 4), the identity where nobody knows. `supports_m`: heights of horizontal planes.
    """

    cloud: Cloud
    map_from_camera: NDArray[np.float64]
    labels: NDArray[np.int32]
    segments: tuple[Segment, ...]
    supports_m: tuple[float, ...]


def see(cloud: Cloud) -> Sight:
    """Take a cloud apart."""
    pose = np.eye(4) if cloud.map_from_camera is None else cloud.map_from_camera
    points = map_points(cloud, pose)
    supports = supports_of(points[::2, ::2])
    labels = label_segments(points, cloud.points_camera[..., 2], supports)
    return Sight(cloud, pose, labels, tuple(cut_out(cloud, points, labels, pose[:3, 3])), tuple(supports))
