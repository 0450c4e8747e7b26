"""The entities of the map with their current poses, and their conversion to parts of ROS messages."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Final, NamedTuple

from semmap.nodes.drawing.articulation import JointPositions, joint_positions_of
from semmap.nodes.extern.ros.robots import Grasp, Robots
from semmap.nodes.extern.ros.types import new
from semmap.ontology.model_shapes import ConvexPart, ModelShape
from semmap.schemas.attachments import grip_of, holder_of
from semmap.schemas.entities import IDENTITY, Entity, Pose, Size, carried, compose
from semmap.schemas.scenes import Body

_ORIGIN: Final = Pose(position_m=(0.0, 0.0, 0.0))
_STILL_M: Final = 1e-3
_STILL: Final = 1e-3
"""The maximum change of a quaternion component that counts as no change."""


class Thing(NamedTuple):
    """An entity with a pose: the live pose, else that of its body, of its holder, or in the map.

    `parts` are the convex parts of its shape in its own frame, with the asserted joint positions.
    """

    name: str
    class_: str
    pose: Pose
    size_m: Size | None
    probability: float
    model: str
    place: bool
    resting: bool
    joint_positions: JointPositions = ()
    parts: tuple[ConvexPart, ...] = ()
    robot: bool = False
    """Whether it is a robot or a part of one."""
    grasp: Grasp | None = None
    """The part of a robot that holds it."""

    def has_same_shape(self, other: Thing) -> bool:
        """Return whether it differs at most in its pose."""
        return self._replace(pose=_ORIGIN, resting=True) == other._replace(pose=_ORIGIN, resting=True)

    def has_same_pose(self, other: Thing) -> bool:
        """Return whether both have the same pose, to a millimetre."""
        return is_near(self.pose, other.pose, _STILL_M, _STILL)


def located_things(
    entities: Mapping[str, Entity],
    bodies: Mapping[str, Body],
    live: Mapping[str, Pose],
    shape_of: Callable[[Entity], ModelShape | None] = lambda _: None,
) -> dict[str, Thing]:
    """Return the entities with a pose, by name; tracked ones have their `live` pose.

    A size that the map does not state is that of the body, or of the shape.
    """
    found = {}
    robots = Robots(entities, bodies)
    for entity in entities.values():
        body = bodies.get(entity.name)
        pose = _find_pose(entity, entities, bodies, live, ())
        if pose is None:
            continue
        confidence = entity.pose_provenance.confidence
        shape = shape_of(entity)
        found[entity.name] = Thing(
            name=entity.name,
            class_=entity.class_,
            pose=pose,
            size_m=entity.size_m or (body.size_m if body else shape.size_m if shape else None),
            probability=1.0 if confidence is None else confidence,
            model="" if body is None else body.model,
            place=entity.place,
            resting=body is None or body.resting,
            joint_positions=() if body is None else joint_positions_of(body.joints),
            parts=() if shape is None else shape.parts,
            robot=entity.name in robots.names,
            grasp=robots.grasp_of(entity),
        )
    return found


def _find_pose(
    entity: Entity,
    entities: Mapping[str, Entity],
    bodies: Mapping[str, Body],
    live: Mapping[str, Pose],
    above: tuple[str, ...],
) -> Pose | None:
    """Return the best known pose: live, of the body, from the holder, or committed."""
    if (pose := live.get(entity.name)) is not None:
        return pose
    if (body := bodies.get(entity.name)) is not None:
        return body.pose
    holder, grip = entities.get(holder_of(entity)), grip_of(entity)
    if holder is None or grip is None or holder.name in above:
        return entity.pose
    held_at = _find_pose(holder, entities, bodies, live, (*above, entity.name))
    return entity.pose if held_at is None else compose(held_at, grip)


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


def is_near(one: Pose, other: Pose, within_m: float, within: float) -> bool:
    """Return whether two poses differ by at most a length [m], and a difference of quaternion components.

    Opposite quaternions are the same orientation.
    """
    turn, its = one.orientation_wxyz, other.orientation_wxyz
    side = 1.0 if sum(a * b for a, b in zip(turn, its, strict=True)) >= 0.0 else -1.0
    return all(abs(a - b) <= within_m for a, b in zip(one.position_m, other.position_m, strict=True)) and all(
        abs(a - side * b) <= within for a, b in zip(turn, its, strict=True)
    )
