"""The entities of the map with their current poses, and their conversion to parts of ROS messages."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Final, NamedTuple

from semmap.nodes.drawing.articulation import JointPositions, joint_positions_of
from semmap.nodes.extern.ros.types import new
from semmap.schemas.entities import IDENTITY, Entity, Pose, Size, carried
from semmap.schemas.scenes import Body

_ORIGIN: Final = Pose(position_m=(0.0, 0.0, 0.0))
_STILL_M: Final = 1e-3
_STILL: Final = 1e-3
"""The maximum change of a quaternion component that counts as no change."""


class Thing(NamedTuple):
    """An entity with a pose: the live pose, else that of its body, else that in the map."""

    name: str
    class_: str
    pose: Pose
    size_m: Size | None
    probability: float
    model: str
    place: bool
    resting: bool
    joint_positions: JointPositions = ()

    def has_same_shape(self, other: Thing) -> bool:
        """Return whether it differs only in its pose."""
        return self._replace(pose=_ORIGIN, resting=True) == other._replace(pose=_ORIGIN, resting=True)

    def has_same_pose(self, other: Thing) -> bool:
        """Return whether both have the same pose, to a millimetre."""
        return _near(self.pose.position_m, other.pose.position_m, _STILL_M) and _near(
            self.pose.orientation_wxyz, other.pose.orientation_wxyz, _STILL
        )


def located_things(
    entities: Iterable[Entity], bodies: Mapping[str, Body], live: Mapping[str, Pose]
) -> dict[str, Thing]:
    """Return the entities with a pose, by name; tracked ones have their `live` pose."""
    found = {}
    for entity in entities:
        body = bodies.get(entity.name)
        pose = live.get(entity.name) or (body.pose if body is not None else entity.pose)
        if pose is None:
            continue
        confidence = entity.pose_provenance.confidence
        found[entity.name] = Thing(
            name=entity.name,
            class_=entity.class_,
            pose=pose,
            size_m=entity.size_m or (None if body is None else body.size_m),
            probability=1.0 if confidence is None else confidence,
            model="" if body is None else body.model,
            place=entity.place,
            resting=body is None or body.resting,
            joint_positions=() if body is None else joint_positions_of(body.joints),
        )
    return found


def middle(pose: Pose, size_m: Size) -> Pose:
    """Return the pose of the centre of a box with its bottom centre at `pose`."""
    up = Pose(position_m=(0.0, 0.0, size_m[2] / 2.0), orientation_wxyz=IDENTITY)
    return carried(up, _ORIGIN, pose)


def header(frame: str, stamp_ns: int) -> Any:
    """Return a `std_msgs/Header`."""
    return new("std_msgs/msg/Header", frame_id=frame, stamp=time_of(stamp_ns))


def time_of(stamp_ns: int) -> Any:
    """Return a `builtin_interfaces/Time`."""
    seconds, rest = divmod(stamp_ns, 1_000_000_000)
    return new("builtin_interfaces/msg/Time", sec=seconds, nanosec=rest)


def pose_of(pose: Pose) -> Any:
    """Return a `geometry_msgs/Pose`."""
    x, y, z = pose.position_m
    return new(
        "geometry_msgs/msg/Pose",
        position=new("geometry_msgs/msg/Point", x=x, y=y, z=z),
        orientation=quaternion(pose),
    )


def transform_of(pose: Pose) -> Any:
    """Return a `geometry_msgs/Transform`."""
    return new("geometry_msgs/msg/Transform", translation=vector(pose.position_m), rotation=quaternion(pose))


def quaternion(pose: Pose) -> Any:
    """Return a `geometry_msgs/Quaternion`."""
    w, x, y, z = pose.orientation_wxyz
    return new("geometry_msgs/msg/Quaternion", x=x, y=y, z=z, w=w)


def vector(xyz: tuple[float, float, float]) -> Any:
    """Return a `geometry_msgs/Vector3`."""
    x, y, z = xyz
    return new("geometry_msgs/msg/Vector3", x=x, y=y, z=z)


def _near(one: tuple[float, ...], other: tuple[float, ...], within: float) -> bool:
    return all(abs(a - b) <= within for a, b in zip(one, other, strict=True))
