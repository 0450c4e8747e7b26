"""Frames: coordinate systems that are somewhere in one another, a tree with the map's frame at its root."""

from __future__ import annotations

from typing import Annotated, Final, Literal

from msgspec import Meta, Struct

from semmap.schemas.entities import Angle, Pose, Quaternion, Vector
from semmap.schemas.live import StampNs
from semmap.schemas.scene_files import pose_of

MAP: Final = "map"
"""The root: z up, metres."""

LONGEST_NAME: Final = 300
FrameName = Annotated[str, Meta(min_length=1, max_length=LONGEST_NAME)]
"""A frame as somebody wrote it."""

FrameSource = Literal["map", "sim", "stream", "camera"]
"""Who says where a frame is: the map, the simulator, whoever publishes it, or a camera of the simulator."""


class FramePose(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """Where a frame is in its `parent`, on `semmap/frame/<name>`: its origin [m] and how it is turned.

    It is turned by `yaw` [rad] about the parent's z, or by `orientation` (unit quaternion wxyz). `stamp_ns`
    is when that was measured, in nanoseconds since 1970; 0 stands for when it arrives. What is `fixed` is
    said once and never stale; everything else has to be said again and again.
    """

    parent: FrameName
    at: Vector = (0.0, 0.0, 0.0)
    yaw: Angle | None = None
    orientation: Quaternion | None = None
    stamp_ns: StampNs = 0
    fixed: bool = False

    def require_pose(self) -> Pose:
        """Its pose in the parent. Raises BadRequest for yaw and orientation, or no unit quaternion."""
        return pose_of(self.at, self.yaw, self.orientation)


class Frame(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One frame of the tree. `pose` is that in its parent, `map_pose` that in the map's frame.

    `age_s` is how long ago its pose was heard [s], None for what is not live. Where `problem` says why it
    cannot be used (it is stale, its parent is not there), `map_pose` is None.
    """

    name: str
    parent: str
    source: FrameSource
    pose: Pose | None
    map_pose: Pose | None
    age_s: float | None = None
    stale: bool = False
    problem: str = ""
