"""Live poses of tracked entities and states of robots, which are not committed."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from semmap.schemas.entities import Live, Pose, Quaternion, Radians, Vector
from semmap.schemas.scene_files import pose_of

StampNs = Annotated[int, Meta(ge=0, le=(1 << 63) - 1)]


class LivePose(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """The pose of a tracked entity, published on `semmap/live/<name>`.

    `at` is its bottom centre [m] in the map frame. The orientation is `yaw` [rad] or `orientation` (unit
    quaternion wxyz); without either, it is upright and faces +x. `stamp_ns` is the time of the measurement in
    nanoseconds since 1970; 0 stands for the time of arrival.
    """

    at: Vector
    yaw: Radians | None = None
    orientation: Quaternion | None = None
    stamp_ns: StampNs = 0

    def require_pose(self) -> Pose:
        """Return the pose. Raises BadRequest for yaw with orientation, or for a non-unit quaternion."""
        return pose_of(self.at, self.yaw, self.orientation)


class RobotState(LivePose, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """The base and the joints of a robot, published on `semmap/robot/<name>`.

    The pose is that of the origin of its model (MJCF, URDF) in the map frame, and not of its bottom centre.
    `joints` are the positions of its joints [rad, m] by their names in the model; those left out are at 0.
    """

    joints: dict[str, Radians] = {}


class LivePoses(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The last poses of all tracked entities, by name; published on `semmap/live` at 10 Hz or less."""

    stamp_ns: int
    entities: dict[str, Live]
