"""The map as ROS messages: detections, markers, transforms and the occupancy grid."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any, Final, NamedTuple

from semmap.nodes.drawing.palette import colour_of
from semmap.nodes.extern.ros.things import Thing, header, middle, pose_of, time_of, transform_of, vector
from semmap.nodes.extern.ros.types import new
from semmap.nodes.navigation.grid import OccupancyGrid
from semmap.schemas.entities import Pose
from semmap.schemas.frames import MAP

_CUBE, _TEXT, _DELETE_ALL = 1, 9, 3
_LETTERS_M: Final = 0.12
OPAQUE: Final = 0.85


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
    scale, colour, text = size, class_colour(thing.class_), ""
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


def class_colour(class_name: str, opacity: float = OPAQUE) -> Any:
    """Return the `std_msgs/ColorRGBA` of a class."""
    r, g, b = (part / 255.0 for part in colour_of(class_name))
    return new("std_msgs/msg/ColorRGBA", r=r, g=g, b=b, a=opacity)
