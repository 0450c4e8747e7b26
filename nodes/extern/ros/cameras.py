"""ROS depth cameras: colour, depth and intrinsics are combined to frames for perception."""

from __future__ import annotations

import re
import threading
from collections import deque
from typing import Any, Final, NamedTuple

import numpy as np
from msgspec import structs

from semmap.nodes.extern.ros.frames import Frames
from semmap.nodes.extern.ros.images import colour_of, depth_of
from semmap.schemas import errors
from semmap.schemas.entities import NAME_PATTERN
from semmap.schemas.scenes import CameraFrame

_APART_NS: Final = 30_000_000
"""The maximum time between colour and depth of a frame."""
_KEPT: Final = 8


class CameraTopics(NamedTuple):
    """The name of a camera, and the topics of its colour, depth (registered to colour) and intrinsics."""

    name: str
    colour: str
    depth: str
    info: str


class Planes(NamedTuple):
    """A frame: the metadata of colour and depth, and their pixels."""

    colour: CameraFrame
    depth: CameraFrame
    rgb: bytes
    depth_m: bytes


def parse_camera(text: str) -> CameraTopics:
    """Parse `NAME=COLOUR,DEPTH,INFO`. Raises BadRequest for other texts."""
    name, _, rest = text.partition("=")
    parts = rest.split(",")
    if not re.match(NAME_PATTERN, name) or len(parts) != 3 or not all(_is_topic(part) for part in parts):
        raise errors.BadRequest(
            f"'{text}' is not NAME=COLOUR,DEPTH,INFO; example: front=/camera/color/image_raw,"
            "/camera/aligned_depth_to_color/image_raw,/camera/color/camera_info"
        )
    return CameraTopics(name, *parts)


def _is_topic(name: str) -> bool:
    return re.fullmatch(r"(/[A-Za-z_][A-Za-z0-9_]*)+", name) is not None


class Camera:
    """Combines the messages of one camera to frames. It can be used from any thread."""

    def __init__(self, name: str, frames: Frames, base: str) -> None:
        """`base` is the name of the map frame in ROS."""
        self.name = name
        self._frames, self._base = frames, base
        self._lock = threading.Lock()
        self._info: Any = None
        self._colours: deque[Any] = deque(maxlen=_KEPT)
        self._depths: deque[Any] = deque(maxlen=_KEPT)

    def take_info(self, info: Any) -> None:
        """Take a `sensor_msgs/CameraInfo`."""
        self._info = info

    def take_colour(self, image: Any) -> Planes | None:
        """Take a `sensor_msgs/Image`, and return the frame that it completes. Raises BadRequest."""
        with self._lock:
            self._colours.append(image)
            return self._take_pair()

    def take_depth(self, image: Any) -> Planes | None:
        """Take a depth image, and return the frame that it completes. Raises BadRequest."""
        with self._lock:
            self._depths.append(image)
            return self._take_pair()

    def _take_pair(self) -> Planes | None:
        if not self._colours or not self._depths or self._info is None:
            return None
        apart, colour, depth = min(
            (
                (abs(_stamp_ns(colour) - _stamp_ns(depth)), colour, depth)
                for colour in self._colours
                for depth in self._depths
            ),
            key=lambda pair: pair[0],
        )
        if apart > _APART_NS:
            return None
        self._colours.clear()
        self._depths.clear()
        return self._frame(colour, depth)

    def _frame(self, colour: Any, depth: Any) -> Planes:
        info, stamp_ns = self._info, _stamp_ns(depth)
        if (info.width, info.height) != (depth.width, depth.height):
            raise errors.BadRequest(
                f"camera {self.name}: the intrinsics are for {info.width} x {info.height} pixels, the depth"
                f" image has {depth.width} x {depth.height}; use the camera_info of the depth image"
            )
        intrinsics = np.array(info.k, float).reshape(3, 3)
        intrinsics[:2, 2] += 0.5  # in ROS, the centre of the first pixel is (0, 0)
        where = self._frames.pose(depth.header.frame_id, self._base, stamp_ns)
        depth_frame = CameraFrame(
            camera=self.name,
            encoding="depth32f",
            width=depth.width,
            height=depth.height,
            stamp_ns=stamp_ns,
            sim_time_s=stamp_ns / 1e9,
            intrinsics=tuple(intrinsics.ravel().tolist()),
            map_from_camera=tuple(where.ravel().tolist()),
        )
        colour_frame = structs.replace(depth_frame, encoding="rgb8", width=colour.width, height=colour.height)
        return Planes(colour_frame, depth_frame, colour_of(colour), depth_of(depth))


def _stamp_ns(image: Any) -> int:
    return int(image.header.stamp.sec) * 1_000_000_000 + int(image.header.stamp.nanosec)
