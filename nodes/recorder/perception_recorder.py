"""Records the output of cameras and perception; images and clouds at a low rate."""

from __future__ import annotations

import logging
from collections.abc import Callable

from semmap.nodes import bus
from semmap.nodes.recorder.drawing import perception_archetypes as archetypes
from semmap.nodes.recorder.recording import Recording
from semmap.nodes.runtime.loop import Node
from semmap.schemas import keys
from semmap.schemas.perception import Observations, SegmentedCloud
from semmap.schemas.scenes import CameraFrame

log = logging.getLogger(__name__)

_IMAGE_S = 1.0
"""Minimum time between two recorded images of a camera."""


class PerceptionRecorder:
    """Subscribes to perception and records it."""

    def __init__(self, node: Node, recording: Recording, at: Callable[[int], None]) -> None:
        """Register the subscribers. `at(stamp_ns)` sets the time of the next record."""
        self._node = node
        self._recording = recording
        self._at = at
        self._seen = Observations(stamp_ns=0, views=(), observations=())
        self._images: dict[str, tuple[CameraFrame, Callable[[], bytes]]] = {}
        self._arranged: set[str] = set()
        node.follow(keys.OBSERVATIONS, self._on_observations)
        node.follow(keys.CLOUD, self._on_cloud)
        bus.follow_cameras(node.session, "rgb", self._keep, log.warning)
        node.every(_IMAGE_S, self._draw_images)

    def _on_observations(self, seen: Observations) -> None:
        self._seen = seen
        self._at(seen.stamp_ns)
        self._recording.show(archetypes.BOXES, *archetypes.boxes_of(seen))

    def _on_cloud(self, cloud: SegmentedCloud) -> None:
        try:
            points = archetypes.points_of(cloud, self._seen)
        except ValueError as error:
            self._node.drop(f"cloud dropped: {error}")
            return
        self._at(cloud.stamp_ns)
        self._recording.show(archetypes.CLOUD, points)

    def _keep(self, frame: CameraFrame, read: Callable[[], bytes]) -> None:
        """Keep the newest image of each camera. Called on a thread of Zenoh."""
        self._images[frame.camera] = (frame, read)

    def _draw_images(self) -> None:
        for camera in list(self._images):
            frame, read = self._images.pop(camera)
            try:
                drawn, pose = archetypes.image_of(frame, read()), archetypes.camera_pose(frame)
            except ValueError as error:
                self._node.drop(f"image of camera {camera} dropped: {error}")
                continue
            self._at(frame.stamp_ns)
            self._recording.show(archetypes.camera_path(camera), *drawn)
            if camera not in self._arranged:
                self._arranged.add(camera)
                self._recording.arrange([pose], [camera])
