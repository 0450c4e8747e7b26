"""The poses of frames over time in a recording."""

from __future__ import annotations

from bisect import bisect_left
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.extern.ros.frames import Transform, to_matrix

_GAP_NS: Final = 1_000_000_000
"""The maximum time between two poses for interpolation."""
_EDGE_NS: Final = 100_000_000
"""The maximum extrapolation before and after a pose."""
_DEEPEST: Final = 100
MAPS: Final = ("map", "world", "odom")
"""The usual names of frames with z up; the first that exists is used."""


class Trajectory:
    """The poses of one frame in another, by time."""

    def __init__(self) -> None:
        self._poses: dict[int, NDArray[np.float64]] = {}
        self._order: list[int] = []

    def add(self, stamp_ns: int, position_m: tuple[float, ...], wxyz: tuple[float, ...]) -> None:
        """Add a pose; invalid ones are ignored."""
        if to_matrix(position_m, wxyz) is not None:
            self._poses[stamp_ns] = np.array([*position_m, *wxyz])

    def at(self, stamp_ns: int) -> Transform | None:
        """Return the interpolated pose (4, 4); None if there are no poses close enough in time."""
        if len(self._order) != len(self._poses):
            self._order = sorted(self._poses)
        if stamp_ns in self._poses:
            return _matrix(self._poses[stamp_ns])
        after = bisect_left(self._order, stamp_ns)
        neighbours = self._order[max(after - 1, 0) : after + 1]
        if len(neighbours) == 2 and neighbours[1] - neighbours[0] <= _GAP_NS:
            first, then = neighbours
            share = (stamp_ns - first) / (then - first)
            return _matrix(_between(self._poses[first], self._poses[then], share))
        nearest = min(neighbours, key=lambda at: abs(at - stamp_ns), default=None)
        if nearest is None or abs(nearest - stamp_ns) > _EDGE_NS:
            return None
        return _matrix(self._poses[nearest])


class TransformTree:
    """The transforms on /tf and /tf_static of a recording."""

    def __init__(self) -> None:
        self._parents: dict[str, str] = {}
        self._moving: dict[str, Trajectory] = {}
        self._still: dict[str, Transform] = {}

    def take(self, message: Any, *, static: bool) -> None:
        """Add a `tf2_msgs/TFMessage`; invalid transforms are ignored."""
        for stamped in message.transforms:
            child, parent = strip_slash(stamped.child_frame_id), strip_slash(stamped.header.frame_id)
            t, r = stamped.transform.translation, stamped.transform.rotation
            pose = to_matrix((t.x, t.y, t.z), (r.w, r.x, r.y, r.z))
            if pose is None or not child or not parent or child == parent:
                continue
            self._parents[child] = parent
            if static:
                self._still[child] = pose
            else:
                track = self._moving.setdefault(child, Trajectory())
                track.add(stamp_ns_of(stamped.header.stamp), (t.x, t.y, t.z), (r.w, r.x, r.y, r.z))

    def above(self, frame: str) -> list[str]:
        """Return a frame and its ancestors, in this order."""
        found = [strip_slash(frame)]
        while (parent := self._parents.get(found[-1])) and parent not in found and len(found) < _DEEPEST:
            found.append(parent)
        return found

    def pose(self, frame: str, base: str, stamp_ns: int) -> Transform | None:
        """Return the pose of `frame` in its ancestor `base`; None if it is unknown at that time."""
        pose = np.eye(4)
        for link in self.above(frame):
            if link == strip_slash(base):
                return pose
            track = self._moving.get(link)
            step = self._still.get(link) if track is None else track.at(stamp_ns)
            if step is None:
                return None
            pose = step @ pose
        return None

    def between(self, one: str, other: str, stamp_ns: int) -> Transform | None:
        """Return the pose of `one` in `other`, if they have a common ancestor."""
        shared = next((base for base in self.above(one) if base in self.above(other)), None)
        if shared is None:
            return None
        poses = [self.pose(frame, shared, stamp_ns) for frame in (one, other)]
        if poses[0] is None or poses[1] is None:
            return None
        return np.asarray(np.linalg.inv(poses[1]) @ poses[0])


def strip_slash(frame: str) -> str:
    """Return the name of a frame without the leading slash of ROS 1."""
    return frame.lstrip("/")


def stamp_ns_of(stamp: Any) -> int:
    """Convert a ROS time to nanoseconds."""
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)


def _between(one: NDArray[np.float64], other: NDArray[np.float64], share: float) -> NDArray[np.float64]:
    """Interpolate position and quaternion linearly."""
    turned = -1.0 if one[3:] @ other[3:] < 0 else 1.0
    return np.asarray(one * (1.0 - share) + np.r_[other[:3], turned * other[3:]] * share)


def _matrix(pose: NDArray[np.float64]) -> Transform | None:
    return to_matrix(tuple(pose[:3]), tuple(pose[3:]))
