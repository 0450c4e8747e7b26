"""The frame tree of ROS, from /tf and /tf_static."""

from __future__ import annotations

import threading
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from semmap.schemas import errors

Transform = NDArray[np.float64]
"""(4, 4): rotation and position [m]."""

_DEEPEST: Final = 100
_MOST: Final = 10_000
_LATE_NS: Final = 1_000_000_000


class Frames:
    """The newest transform of each frame in its parent. It can be used from any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._parents: dict[str, tuple[str, Transform, int | None]] = {}

    def take(self, message: Any, *, static: bool) -> None:
        """Take a `tf2_msgs/TFMessage`. Invalid transforms, and frames beyond ten thousand, are ignored."""
        for stamped in message.transforms:
            child, parent = stamped.child_frame_id.lstrip("/"), stamped.header.frame_id.lstrip("/")
            transform = matrix(stamped.transform)
            if transform is None or not child or not parent or child == parent:
                continue
            stamp = stamped.header.stamp
            stamp_ns = None if static else stamp.sec * 1_000_000_000 + stamp.nanosec
            with self._lock:
                if child in self._parents or len(self._parents) < _MOST:
                    self._parents[child] = (parent, transform, stamp_ns)

    def pose(self, frame: str, base: str, stamp_ns: int) -> Transform:
        """Return the pose of `frame` in `base` for an observation at `stamp_ns`.

        Raises BadRequest for an unknown frame, for a transform that is more than a second older, and for a
        cycle.
        """
        found, now = np.eye(4), frame.lstrip("/")
        for _ in range(_DEEPEST):
            if now == base:
                return found
            with self._lock:
                known = self._parents.get(now)
            if known is None:
                raise errors.BadRequest(
                    f"frame {now!r} has no parent on /tf, so the pose of {frame!r} in {base!r} is unknown"
                )
            parent, transform, known_ns = known
            if known_ns is not None and stamp_ns - known_ns > _LATE_NS:
                raise errors.BadRequest(
                    f"the transform of frame {now!r} on /tf is {(stamp_ns - known_ns) / 1e9:.1f} s old"
                )
            found, now = transform @ found, parent
        raise errors.BadRequest(f"the frames on /tf above {frame!r} form a cycle")


def matrix(transform: Any) -> Transform | None:
    """Convert a `geometry_msgs/Transform` to a matrix; return None for an invalid one."""
    t, r = transform.translation, transform.rotation
    return to_matrix((t.x, t.y, t.z), (r.w, r.x, r.y, r.z))


def to_matrix(position_m: tuple[float, ...], wxyz: tuple[float, ...]) -> Transform | None:
    """Convert a position and a quaternion of any length to a matrix; return None for invalid ones."""
    w, x, y, z = wxyz
    norm = float(np.sqrt(w * w + x * x + y * y + z * z))
    if not np.isfinite([*position_m, norm]).all() or norm < 1e-6:
        return None
    w, x, y, z = w / norm, x / norm, y / norm, z / norm
    found = np.eye(4)
    found[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    found[:3, 3] = position_m
    return found
