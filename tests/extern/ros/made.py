"""Objects, entities and images for tests of ROS messages."""

from __future__ import annotations

from typing import Any

import numpy as np

from semmap.nodes.extern.ros.messages import Moment
from semmap.nodes.extern.ros.things import Thing
from semmap.nodes.extern.ros.types import new
from semmap.schemas.entities import Pose, orientation_from_yaw

AT = Moment("map", 1_500_000_002)


def thing(name: str = "cup1", class_: str = "Cup", *, yaw: float = 0.0, **fields: Any) -> Thing:
    """A cup of 8 by 8 by 10 cm at (1, 2, 0.7), unless said otherwise."""
    at = fields.pop("at", (1.0, 2.0, 0.7))
    known = {
        "size_m": (0.08, 0.08, 0.1),
        "probability": 1.0,
        "model": "cup",
        "place": False,
        "resting": True,
    }
    return Thing(
        name=name,
        class_=class_,
        pose=Pose(position_m=at, orientation_wxyz=orientation_from_yaw(yaw)),
        **{**known, **fields},
    )


def by_name(*things: Any) -> dict[str, Any]:
    """As the bridge keeps them."""
    return {each.name: each for each in things}


def image(
    pixels: np.ndarray, encoding: str, *, stamp_ns: int = 0, padding: int = 0, frame: str = "lens"
) -> Any:
    """A `sensor_msgs/Image` of (height, width[, channels]) pixels, with so many bytes after each row."""
    height, width = pixels.shape[:2]
    rows = np.ascontiguousarray(pixels).view(np.uint8).reshape(height, -1)
    rows = np.pad(rows, ((0, 0), (0, padding)))
    return new(
        "sensor_msgs/msg/Image",
        header=stamped(frame, stamp_ns),
        height=height,
        width=width,
        encoding=encoding,
        step=rows.shape[1],
        data=rows.ravel(),
    )


def info(width: int, height: int, frame: str = "lens") -> Any:
    """A `sensor_msgs/CameraInfo`: fx, fy 100, the middle at the middle of a pixel."""
    k = np.array([100.0, 0.0, width / 2, 0.0, 100.0, height / 2, 0.0, 0.0, 1.0])
    return new("sensor_msgs/msg/CameraInfo", header=stamped(frame, 0), width=width, height=height, k=k)


def stamped(frame: str, stamp_ns: int) -> Any:
    """A `std_msgs/Header`."""
    time = new("builtin_interfaces/msg/Time", sec=stamp_ns // 1_000_000_000, nanosec=stamp_ns % 1_000_000_000)
    return new("std_msgs/msg/Header", frame_id=frame, stamp=time)


def transforms(*links: tuple[str, str, tuple[float, float, float]], stamp_ns: int = 0) -> Any:
    """A `tf2_msgs/TFMessage`: child, parent, and where the child is in it, not turned."""
    return new(
        "tf2_msgs/msg/TFMessage",
        transforms=[
            new(
                "geometry_msgs/msg/TransformStamped",
                header=stamped(parent, stamp_ns),
                child_frame_id=child,
                transform=new(
                    "geometry_msgs/msg/Transform",
                    translation=new("geometry_msgs/msg/Vector3", x=at[0], y=at[1], z=at[2]),
                ),
            )
            for child, parent, at in links
        ],
    )
