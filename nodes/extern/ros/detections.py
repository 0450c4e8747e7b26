"""Conversion of ROS detections to observations of perception."""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np

from semmap.nodes.extern.ros.frames import Frames, Transform, matrix
from semmap.nodes.extern.ros.types import new
from semmap.schemas import errors
from semmap.schemas.entities import REACH_M, Pose
from semmap.schemas.perception import Observation, Observations

_MOST: Final = 1000


def observations_of(message: Any, frames: Frames, base: str) -> Observations:
    """Convert a `vision_msgs/Detection3DArray` to observations in the map frame, named `base` in ROS.

    The `class_id` of a hypothesis is a class of the map. Detections without a hypothesis or a size are
    ignored. Raises BadRequest for an unknown frame, and for more than a thousand detections.
    """
    if len(message.detections) > _MOST:
        raise errors.BadRequest(f"{len(message.detections)} detections in a message; the maximum is {_MOST}")
    stamp = message.header.stamp
    stamp_ns = int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)
    where = frames.pose(message.header.frame_id, base, stamp_ns)
    found = (_observation(detection, where) for detection in message.detections)
    return Observations(stamp_ns=stamp_ns, views=(), observations=tuple(o for o in found if o is not None))


def _observation(detection: Any, where: Transform) -> Observation | None:
    size = (detection.bbox.size.x, detection.bbox.size.y, detection.bbox.size.z)
    centre = detection.bbox.center
    moved = matrix(
        new("geometry_msgs/msg/Transform", translation=centre.position, rotation=centre.orientation)
    )
    candidates = {
        r.hypothesis.class_id: min(1.0, max(0.0, r.hypothesis.score))
        for r in detection.results
        if r.hypothesis.class_id and math.isfinite(r.hypothesis.score)
    }
    if moved is None or not candidates or not all(0.0 < extent <= REACH_M for extent in size):
        return None
    pose = where @ moved
    bottom = pose[:3, 3] - pose[:3, 2] * size[2] / 2.0
    if not (np.abs(bottom) <= REACH_M).all():
        return None
    best = max(candidates, key=lambda name: candidates[name])
    x, y, z = bottom.tolist()
    return Observation(
        class_=best,
        probability=candidates[best],
        candidates=candidates,
        pose=Pose(position_m=(x, y, z), orientation_wxyz=_quaternion(pose)),
        size_m=size,
        points=0,
    )


def _quaternion(pose: Transform) -> tuple[float, float, float, float]:
    """Convert a rotation matrix to a quaternion: the eigenvector of Bar-Itzhack's symmetric matrix."""
    m = pose[:3, :3]
    k = np.array(
        [
            [m[0, 0] + m[1, 1] + m[2, 2], m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]],
            [m[2, 1] - m[1, 2], m[0, 0] - m[1, 1] - m[2, 2], m[1, 0] + m[0, 1], m[2, 0] + m[0, 2]],
            [m[0, 2] - m[2, 0], m[1, 0] + m[0, 1], m[1, 1] - m[0, 0] - m[2, 2], m[2, 1] + m[1, 2]],
            [m[1, 0] - m[0, 1], m[2, 0] + m[0, 2], m[2, 1] + m[1, 2], m[2, 2] - m[0, 0] - m[1, 1]],
        ]
    )
    values, vectors = np.linalg.eigh(k)
    w, x, y, z = vectors[:, int(values.argmax())].tolist()
    return (w, x, y, z) if w >= 0 else (-w, -x, -y, -z)
