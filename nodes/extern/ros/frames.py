"""Frames of ROS as they are told on /tf and /tf_static: where one is in another."""

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
    """The newest transform of each frame in its parent. Any thread may use it."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._parents: dict[str, tuple[str, Transform, int | None]] = {}

    def take(self, message: Any, *, static: bool) -> None:
        """A `tf2_msgs/TFMessage`; what is no transform, and frames beyond ten thousand, are passed over."""
        for said in message.transforms:
            child, parent = said.child_frame_id.lstrip("/"), said.header.frame_id.lstrip("/")
            transform = matrix(said.transform)
            if transform is None or not child or not parent or child == parent:
                continue
            stamp_ns = None if static else said.header.stamp.sec * 1_000_000_000 + said.header.stamp.nanosec
            with self._lock:
                if child in self._parents or len(self._parents) < _MOST:
                    self._parents[child] = (parent, transform, stamp_ns)

    def pose(self, frame: str, base: str, stamp_ns: int) -> Transform:
        """Where `frame` is in `base`, for what was seen at `stamp_ns`.

        Raises BadRequest where nobody says, where what is said is a second older than that or more, and for
        frames that are in one another.
        """
        found, now = np.eye(4), frame.lstrip("/")
        for _ in range(_DEEPEST):
            if now == base:
                return found
            with self._lock:
                known = self._parents.get(now)
            if known is None:
                raise errors.BadRequest(
                    f"nobody says on /tf where the frame {now!r} is, so {frame!r} is nowhere in {base!r}"
                )
            parent, transform, said_ns = known
            if said_ns is not None and stamp_ns - said_ns > _LATE_NS:
                raise errors.BadRequest(
                    f"where the frame {now!r} is was last said {(stamp_ns - said_ns) / 1e9:.1f} s before"
                )
            found, now = transform @ found, parent
        raise errors.BadRequest(f"the frames on /tf above {frame!r} are in one another")


def matrix(transform: Any) -> Transform | None:
    """A `geometry_msgs/Transform` as a matrix; None for what has no length, or is no number."""
    t, r = transform.translation, transform.rotation
    return to_matrix((t.x, t.y, t.z), (r.w, r.x, r.y, r.z))


def to_matrix(position_m: tuple[float, ...], wxyz: tuple[float, ...]) -> Transform | None:
    """A position and a quaternion of any length as a matrix; None for what has none, or is no number."""
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
