"""Diffs of a planning scene: obstacles, and the objects that a robot holds."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from semmap.nodes.drawing.articulation import articulated
from semmap.nodes.extern.ros import solids
from semmap.nodes.extern.ros.messages import Moment, class_colour
from semmap.nodes.extern.ros.things import Thing, is_near, pose_of
from semmap.nodes.extern.ros.types import new
from semmap.schemas import errors
from semmap.schemas.entities import Pose, compose, relative
from semmap.schemas.scenes import Surface

_ADD, _REMOVE, _MOVE = 0, 1, 3
_SAME_GRIP_M = 0.005
_SAME_GRIP = 0.02
"""The largest change of a quaternion component, 2 degrees, for which a grip is the same."""

Surfaces = Mapping[str, Surface]
"""The known meshes of objects, by name."""
Things = Mapping[str, Thing]


def planning_scene(now: Things, before: Things, surfaces: Surfaces, at: Moment) -> Any | None:
    """Return a `moveit_msgs/PlanningScene` with the differences of two states; None without any.

    `before` is the state that a planner has, which `follow_scene` returns.

    The id of an object is its name, and the `type` its class. Its shape is the mesh in `surfaces` with its
    joints moved, its parts, or its bounding box. Places, objects without a size, and robots with their parts
    are not obstacles. An object that a part of a robot holds is attached to the link with that part's name,
    and attached again when its pose in the frame of the link changes.
    """
    free, was_free = _obstacles(now), _obstacles(before)
    held, was_held = _held(now), _held(before)
    objects = [_object(name, at, _REMOVE) for name in was_free if name not in free]
    colours, attached = [], []
    for name, thing in was_held.items():
        if name not in held:
            attached.append(_detached(thing, at))
            if name not in free:  # a detached object returns to the world
                objects.append(_object(name, at, _REMOVE))
    for name, thing in held.items():
        if (
            name not in was_held
            or not thing.has_same_shape(was_held[name])
            or _is_regripped(thing, now, was_held[name], before)
        ):
            attached.append(_attached(thing, surfaces.get(name), at))
            colours.append(_colour(thing))
    for name, thing in free.items():
        if name not in was_free or not thing.has_same_shape(was_free[name]):
            objects.append(_obstacle(thing, surfaces.get(name), at))
            colours.append(_colour(thing))
        elif not thing.has_same_pose(was_free[name]):
            objects.append(_object(name, at, _MOVE, pose=pose_of(thing.pose)))
    if not objects and not attached:
        return None
    return new(
        "moveit_msgs/msg/PlanningScene",
        robot_state=new("moveit_msgs/msg/RobotState", attached_collision_objects=attached, is_diff=True),
        object_colors=colours,
        world=new("moveit_msgs/msg/PlanningSceneWorld", collision_objects=objects),
        is_diff=True,
    )


def forget_scene(sent: Things, now: Things) -> dict[str, Thing]:
    """Return the sent objects whose removal is still to be sent, for a planning scene that is sent whole.

    `planning_scene` then sends all objects of `now`. Objects that are not in `now` are kept, and so are
    attached objects that no robot holds now: without a detachment they would stay attached.
    """
    return {
        name: thing
        for name, thing in sent.items()
        if name not in now or (thing.grasp is not None and now[name].grasp is None)
    }


def follow_scene(sent: Things, now: Things) -> dict[str, Thing]:
    """Return the objects as a planner has them after `planning_scene` was sent from `sent` to `now`.

    Changes within the tolerances are not sent. The poses that a planner has are kept, so that the changes add
    up until they are sent. It moves attached objects with their links.
    """
    followed = dict(now)
    for name, thing in now.items():
        was = sent.get(name)
        if was is None or not _is_solid(thing) or not thing.has_same_shape(was):
            continue
        if thing.grasp is None:
            if thing.has_same_pose(was):
                followed[name] = thing._replace(pose=was.pose)
        elif not _is_regripped(thing, now, was, sent):
            link, earlier = now.get(thing.grasp.link), _find_grip(was, sent)
            if link is not None and earlier is not None:
                followed[name] = thing._replace(pose=compose(link.pose, earlier))
    return followed


def _is_regripped(thing: Thing, now: Things, was: Thing, before: Things) -> bool:
    """Return whether the pose of a held object in the frame of its link has changed."""
    grip, earlier = _find_grip(thing, now), _find_grip(was, before)
    if grip is None or earlier is None:
        return False
    return not is_near(grip, earlier, _SAME_GRIP_M, _SAME_GRIP)


def _find_grip(thing: Thing, things: Things) -> Pose | None:
    """Return the pose of a held object in the frame of its link, or None if the link has no pose."""
    link = None if thing.grasp is None else things.get(thing.grasp.link)
    return None if link is None else relative(thing.pose, link.pose)


def _obstacles(things: Things) -> dict[str, Thing]:
    return {name: thing for name, thing in things.items() if _is_solid(thing) and thing.grasp is None}


def _held(things: Things) -> dict[str, Thing]:
    return {name: thing for name, thing in things.items() if _is_solid(thing) and thing.grasp is not None}


def _is_solid(thing: Thing) -> bool:
    return thing.size_m is not None and not thing.place and not thing.robot


def _obstacle(thing: Thing, surface: Surface | None, at: Moment) -> Any:
    if thing.size_m is None:
        raise errors.InternalError(f"{thing.name} has no size")
    shape: dict[str, Any]
    if surface is not None:
        mesh, origin = _mesh(articulated(surface, thing.joint_positions)), new("geometry_msgs/msg/Pose")
        shape = {"meshes": [mesh], "mesh_poses": [origin]}
    else:
        made = solids.solids_of(thing.parts) if thing.parts else solids.box_of(thing.size_m)
        shape = made._asdict()
    kind = new("object_recognition_msgs/msg/ObjectType", key=thing.class_)
    return _object(thing.name, at, _ADD, pose=pose_of(thing.pose), type=kind, **shape)


def _attached(thing: Thing, surface: Surface | None, at: Moment) -> Any:
    """Return an object that is attached to a link. Its pose is that in the map."""
    if thing.grasp is None:
        raise errors.InternalError(f"{thing.name} is not held")
    return new(
        "moveit_msgs/msg/AttachedCollisionObject",
        link_name=thing.grasp.link,
        object=_obstacle(thing, surface, at),
        touch_links=list(thing.grasp.touch_links),
    )


def _detached(thing: Thing, at: Moment) -> Any:
    link = "" if thing.grasp is None else thing.grasp.link
    return new(
        "moveit_msgs/msg/AttachedCollisionObject", link_name=link, object=_object(thing.name, at, _REMOVE)
    )


def _object(name: str, at: Moment, operation: int, **fields: Any) -> Any:
    return new("moveit_msgs/msg/CollisionObject", header=at.header, id=name, operation=operation, **fields)


def _colour(thing: Thing) -> Any:
    return new("moveit_msgs/msg/ObjectColor", id=thing.name, color=class_colour(thing.class_))


def _mesh(surface: Surface) -> Any:
    """Return a `shape_msgs/Mesh` in the frame of the object; corners that triangles share are one."""
    points = np.frombuffer(surface.points, "<f4").reshape(-1, 3).astype(float)
    triangles = np.frombuffer(surface.triangles, "<u4").reshape(-1, 3)
    corners, rows = np.unique(points.round(6), axis=0, return_inverse=True)
    return solids.mesh_message(corners, rows.reshape(-1)[triangles])
