"""Live poses: where tracked entities are just now, newest wins, without commits."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from semmap.schemas.entities import Angle, Live, Pose, Quaternion, Vector
from semmap.schemas.scene_files import pose_of

StampNs = Annotated[int, Meta(ge=0, le=(1 << 63) - 1)]


class LivePose(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """Where a tracked entity is, on `semmap/live/<name>`: its bottom centre [m] in the map frame.

    It faces `yaw` [rad], or has an `orientation` (unit quaternion wxyz); without either it is upright and
    faces +x. `stamp_ns` is when that was measured, in nanoseconds since 1970; 0 stands for when it arrives.
    """

    at: Vector
    yaw: Angle | None = None
    orientation: Quaternion | None = None
    stamp_ns: StampNs = 0

    def require_pose(self) -> Pose:
        """The same as a pose. Raises BadRequest for yaw and orientation together, or no unit quaternion."""
        return pose_of(self.at, self.yaw, self.orientation)


class LivePoses(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Where all tracked entities are that were heard of lately, by name; on `semmap/live`, at most 10 Hz."""

    stamp_ns: int
    entities: dict[str, Live]
