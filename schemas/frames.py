"""Coordinate frames: a tree with the map's frame at its root."""

from __future__ import annotations

from typing import Annotated, Final, Literal

from msgspec import Meta, Struct

from semmap.schemas.entities import Pose, Quaternion, Radians, Vector
from semmap.schemas.live import StampNs
from semmap.schemas.scene_files import pose_of

MAP: Final = "map"
"""The root: z up, metres."""

LONGEST_NAME: Final = 300
FrameName = Annotated[str, Meta(min_length=1, max_length=LONGEST_NAME)]
"""A frame name as entered by a user."""

FrameSource = Literal["map", "sim", "stream", "camera"]
"""The source of a frame's pose: the map, the simulator, a publisher, or a camera of the simulator."""


class FramePose(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """The pose of a frame in its `parent`, published on `semmap/frame/<name>`: origin [m] and orientation.

    The orientation is `yaw` [rad] about the parent's z, or `orientation` (unit quaternion wxyz). `stamp_ns`
    is the time of the measurement in nanoseconds since 1970; 0 stands for the time of arrival. A `fixed`
    frame is published once and does not become stale; other frames must be published repeatedly.
    """

    parent: FrameName
    at: Vector = (0.0, 0.0, 0.0)
    yaw: Radians | None = None
    orientation: Quaternion | None = None
    stamp_ns: StampNs = 0
    fixed: bool = False

    def require_pose(self) -> Pose:
        """Return the pose. Raises BadRequest for yaw with orientation, or for a non-unit quaternion."""
        return pose_of(self.at, self.yaw, self.orientation)


class Frame(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One frame of the tree. `pose` is in its parent, `map_pose` in the map's frame.

    `age_s` is the time since the last pose was received [s], None for a frame that is not live. `map_pose` is
    None if there is a `problem`, such as a stale pose or a missing parent.
    """

    name: str
    parent: str
    source: FrameSource
    pose: Pose | None
    map_pose: Pose | None
    age_s: float | None = None
    stale: bool = False
    problem: str = ""
