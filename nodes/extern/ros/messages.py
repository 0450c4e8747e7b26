"""The map as ROS messages: detections, markers, transforms, and diffs of a planning scene."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any, Final, NamedTuple

import numpy as np

from semmap.nodes.drawing.articulation import articulated
from semmap.nodes.drawing.palette import colour_of
from semmap.nodes.extern.ros.things import Thing, header, middle, pose_of, time_of, transform_of, vector
from semmap.nodes.extern.ros.types import new
from semmap.nodes.navigation.grid import OccupancyGrid
from semmap.schemas import errors
from semmap.schemas.entities import Pose
from semmap.schemas.frames import MAP
from semmap.schemas.scenes import Surface

_ADD, _REMOVE, _MOVE = 0, 1, 3
_BOX: Final = 1
_CUBE, _TEXT, _DELETE_ALL = 1, 9, 3
_LETTERS_M: Final = 0.12
_OPAQUE: Final = 0.85

Surfaces = Mapping[str, Surface]
"""The known meshes of objects, by name."""


class Moment(NamedTuple):
    """The frame and the time of poses."""

    frame: str
    stamp_ns: int

    @property
    def header(self) -> Any:
        """The `std_msgs/Header`."""
        return header(self.frame, self.stamp_ns)


def detections(things: Iterable[Thing], at: Moment) -> Any:
    """Return a `vision_msgs/Detection3DArray`: the id is the name, the hypothesis the class."""
    return new(
        "vision_msgs/msg/Detection3DArray",
        header=at.header,
        detections=[_detection(thing, at) for thing in things if not thing.place],
    )


def _detection(thing: Thing, at: Moment) -> Any:
    size = thing.size_m or (0.0, 0.0, 0.0)
    centre = pose_of(middle(thing.pose, size))
    hypothesis = new(
        "vision_msgs/msg/ObjectHypothesisWithPose",
        hypothesis=new(
            "vision_msgs/msg/ObjectHypothesis", class_id=thing.class_, score=float(thing.probability)
        ),
        pose=new("geometry_msgs/msg/PoseWithCovariance", pose=pose_of(thing.pose)),
    )
    box = new("vision_msgs/msg/BoundingBox3D", center=centre, size=vector(size))
    return new("vision_msgs/msg/Detection3D", header=at.header, results=[hypothesis], bbox=box, id=thing.name)


def markers(things: Iterable[Thing], at: Moment) -> Any:
    """Return a `visualization_msgs/MarkerArray` that deletes all markers, then adds boxes and names."""
    drawn = [new("visualization_msgs/msg/Marker", header=at.header, action=_DELETE_ALL)]
    for number, thing in enumerate(things):
        if thing.size_m is not None and not thing.place:
            drawn.append(_marker(thing, number, at, _CUBE, "things"))
        drawn.append(_marker(thing, number, at, _TEXT, "names"))
    return new("visualization_msgs/msg/MarkerArray", markers=drawn)


def _marker(thing: Thing, number: int, at: Moment, kind: int, space: str) -> Any:
    size = thing.size_m or (0.0, 0.0, 0.0)
    place = middle(thing.pose, size)
    scale, colour, text = size, _colour(thing.class_, _OPAQUE), ""
    if kind == _TEXT:
        x, y, z = place.position_m
        place = Pose(position_m=(x, y, z + size[2] / 2.0 + _LETTERS_M))
        scale, colour = (0.0, 0.0, _LETTERS_M), new("std_msgs/msg/ColorRGBA", r=1.0, g=1.0, b=1.0, a=1.0)
        text = thing.name
    return new(
        "visualization_msgs/msg/Marker",
        header=at.header,
        ns=space,
        id=number,
        type=kind,
        pose=pose_of(place),
        scale=vector(scale),
        color=colour,
        text=text,
    )


def transforms(
    things: Iterable[Thing], at: Moment, frames: Mapping[str, tuple[str, Pose]] = MappingProxyType({})
) -> Any:
    """Return a `tf2_msgs/TFMessage` with a frame at the bottom centre of each object, with its name.

    `frames` are additional frames: by name, the parent and the pose in it.
    """
    rows = [(at.frame, thing.name, thing.pose) for thing in things]
    rows += [(at.frame if parent == MAP else parent, name, pose) for name, (parent, pose) in frames.items()]
    return new(
        "tf2_msgs/msg/TFMessage",
        transforms=[
            new(
                "geometry_msgs/msg/TransformStamped",
                header=header(parent, at.stamp_ns),
                child_frame_id=name,
                transform=transform_of(pose),
            )
            for parent, name, pose in rows
        ],
    )


def occupancy_grid(grid: OccupancyGrid, at: Moment) -> Any:
    """Return a `nav_msgs/OccupancyGrid` of the floor, including furniture."""
    frame = grid.frame
    info = new(
        "nav_msgs/msg/MapMetaData",
        map_load_time=time_of(at.stamp_ns),
        resolution=frame.resolution,
        width=frame.width,
        height=frame.height,
        origin=pose_of(Pose(position_m=(frame.x, frame.y, 0.0))),
    )
    return new("nav_msgs/msg/OccupancyGrid", header=at.header, info=info, data=grid.cells.ravel())


def planning_scene(
    now: Mapping[str, Thing], before: Mapping[str, Thing], surfaces: Surfaces, at: Moment
) -> Any | None:
    """Return a `moveit_msgs/PlanningScene` with the added, moved and removed objects; None without changes.

    The id of an object is its name, and the `type` its class. Its shape is the mesh in `surfaces` with its
    joints moved, or its bounding box. Places and objects without a size are not obstacles.
    """
    solid = {name: thing for name, thing in now.items() if _is_solid(thing)}
    was = {name: thing for name, thing in before.items() if _is_solid(thing)}
    objects = [_gone(name, at) for name in was.keys() - solid.keys()]
    colours = []
    for name, thing in solid.items():
        if name not in was or not thing.has_same_shape(was[name]):
            objects.append(_obstacle(thing, surfaces.get(name), at))
            colours.append(new("moveit_msgs/msg/ObjectColor", id=name, color=_colour(thing.class_, _OPAQUE)))
        elif not thing.has_same_pose(was[name]):
            objects.append(_moved(thing, at))
    if not objects:
        return None
    world = new("moveit_msgs/msg/PlanningSceneWorld", collision_objects=objects)
    state = new("moveit_msgs/msg/RobotState", is_diff=True)
    return new(
        "moveit_msgs/msg/PlanningScene", robot_state=state, object_colors=colours, world=world, is_diff=True
    )


def _is_solid(thing: Thing) -> bool:
    return thing.size_m is not None and not thing.place


def _obstacle(thing: Thing, surface: Surface | None, at: Moment) -> Any:
    if thing.size_m is None:
        raise errors.InternalError(f"{thing.name} has no size")
    what = new("object_recognition_msgs/msg/ObjectType", key=thing.class_)
    shape: dict[str, Any]
    if surface is None:
        box = new("shape_msgs/msg/SolidPrimitive", type=_BOX, dimensions=np.array(thing.size_m))
        own = Pose(position_m=(0.0, 0.0, thing.size_m[2] / 2.0))
        shape = {"primitives": [box], "primitive_poses": [pose_of(own)]}
    else:
        shape = {
            "meshes": [_mesh(articulated(surface, thing.joint_positions))],
            "mesh_poses": [new("geometry_msgs/msg/Pose")],
        }
    return _object(thing.name, at, _ADD, pose=pose_of(thing.pose), type=what, **shape)


def _moved(thing: Thing, at: Moment) -> Any:
    return _object(thing.name, at, _MOVE, pose=pose_of(thing.pose))


def _gone(name: str, at: Moment) -> Any:
    return _object(name, at, _REMOVE)


def _object(name: str, at: Moment, operation: int, **fields: Any) -> Any:
    return new("moveit_msgs/msg/CollisionObject", header=at.header, id=name, operation=operation, **fields)


def _mesh(surface: Surface) -> Any:
    """Return a `shape_msgs/Mesh` in the frame of the object."""
    points = np.frombuffer(surface.points, "<f4").reshape(-1, 3).astype(float)
    triangles = np.frombuffer(surface.triangles, "<u4").reshape(-1, 3)
    corners, rows = np.unique(points.round(6), axis=0, return_inverse=True)
    return new(
        "shape_msgs/msg/Mesh",
        triangles=[
            new("shape_msgs/msg/MeshTriangle", vertex_indices=row.astype(np.uint32))
            for row in rows.reshape(-1)[triangles]
        ],
        vertices=[new("geometry_msgs/msg/Point", x=x, y=y, z=z) for x, y, z in corners.tolist()],
    )


def _colour(class_name: str, opacity: float) -> Any:
    r, g, b = (part / 255.0 for part in colour_of(class_name))
    return new("std_msgs/msg/ColorRGBA", r=r, g=g, b=b, a=opacity)
