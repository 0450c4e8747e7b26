"""Subscriptions to ROS topics for perception: camera frames, and the detections of a ROS detector."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any, Final, Literal

from semmap.nodes import bus
from semmap.nodes.bus.rmw import RosNode
from semmap.nodes.extern.ros.cameras import Camera, CameraTopics, Planes
from semmap.nodes.extern.ros.detections import observations_of
from semmap.nodes.extern.ros.frames import Frames
from semmap.nodes.extern.ros.types import decode, topic
from semmap.schemas import codec, errors, keys

_REPORT_S: Final = 10.0
_PLANES: Final[tuple[Literal["rgb", "depth"], ...]] = ("rgb", "depth")


class Inbound:
    """Forwards ROS topics to the topics of perception, on threads of Zenoh."""

    def __init__(
        self,
        session: bus.Session,
        ros: RosNode,
        *,
        frame: str = "map",
        cameras: Sequence[CameraTopics] = (),
        detections: Sequence[str] = (),
        tell: Callable[[str], None] = lambda _: None,
    ) -> None:
        """`frame` is the name of the map frame in ROS; `detections` are topics of Detection3DArray."""
        self._session, self._ros, self._base, self._tell = session, ros, frame, tell
        self._reported: dict[str, float] = {}
        self._frames = Frames()
        if cameras or detections:
            self._follow("/tf", "tf2_msgs/msg/TFMessage", lambda m: self._frames.take(m, static=False))
            self._follow(
                "/tf_static", "tf2_msgs/msg/TFMessage", lambda m: self._frames.take(m, static=True), True
            )
        for camera in cameras:
            self._follow_camera(camera)
        for name in detections:
            self._follow_detections(name)

    def _follow_camera(self, topics: CameraTopics) -> None:
        camera = Camera(topics.name, self._frames, self._base)
        planes = {
            plane: bus.publisher(self._session, keys.CAMERA, keys.camera_key(topics.name, plane))
            for plane in _PLANES
        }

        def put(found: Planes | None) -> None:
            if found is not None:
                planes["rgb"].put(found.rgb, attachment=codec.encode(found.colour))
                planes["depth"].put(found.depth_m, attachment=codec.encode(found.depth))

        image = "sensor_msgs/msg/Image"
        self._follow(topics.info, "sensor_msgs/msg/CameraInfo", camera.take_info)
        self._follow(topics.colour, image, lambda message: put(camera.take_colour(message)))
        self._follow(topics.depth, image, lambda message: put(camera.take_depth(message)))

    def _follow_detections(self, name: str) -> None:
        publisher = bus.publisher(self._session, keys.DETECTIONS)

        def put(message: Any) -> None:
            found = observations_of(message, self._frames, self._base)
            publisher.put(codec.encode(found), encoding=codec.encoding_of(found))

        self._follow(name, "vision_msgs/msg/Detection3DArray", put)

    def _follow(self, name: str, kind: str, take: Callable[[Any], None], latched: bool = False) -> None:
        def receive(cdr: bytes) -> None:
            try:
                take(decode(cdr, kind))
            except errors.BadRequest as error:
                self._report(f"{name}: {error.text}")

        self._ros.subscribe(topic(name, kind, latched=latched), receive)

    def _report(self, text: str) -> None:
        """Report an error, at most once in 10 s."""
        now_s = time.monotonic()
        if now_s - self._reported.get(text, -_REPORT_S) >= _REPORT_S:
            if len(self._reported) > 100:
                self._reported.clear()
            self._reported[text] = now_s
            self._tell(text)
