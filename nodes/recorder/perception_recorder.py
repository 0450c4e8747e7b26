"""Records what cameras and perception publish; images and clouds at a low rate."""

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

_PICTURE_S = 1.0
"""A camera's picture is recorded no more often."""


class PerceptionRecorder:
    """Binds the drawing of what is seen to the wire."""

    def __init__(self, node: Node, recording: Recording, at: Callable[[int], None]) -> None:
        """`at(stamp_ns)` says of when what is recorded next is."""
        self._recording = recording
        self._at = at
        self._seen = Observations(stamp_ns=0, views=(), observations=())
        self._pictures: dict[str, tuple[CameraFrame, Callable[[], bytes]]] = {}
        self._arranged: set[str] = set()
        node.follow(keys.OBSERVATIONS, self._on_observations)
        node.follow(keys.CLOUD, self._on_cloud)
        bus.follow_cameras(node.session, "rgb", self._keep, log.warning)
        node.every(_PICTURE_S, self._draw_pictures)

    def _on_observations(self, seen: Observations) -> None:
        self._seen = seen
        self._at(seen.stamp_ns)
        self._recording.show(archetypes.BOXES, *archetypes.boxes_of(seen))

    def _on_cloud(self, cloud: SegmentedCloud) -> None:
        self._at(cloud.stamp_ns)
        self._recording.show(archetypes.CLOUD, archetypes.points_of(cloud, self._seen))

    def _keep(self, frame: CameraFrame, read: Callable[[], bytes]) -> None:
        """On a thread of Zenoh's: only the newest picture of each camera is kept."""
        self._pictures[frame.camera] = (frame, read)

    def _draw_pictures(self) -> None:
        for camera in list(self._pictures):
            frame, read = self._pictures.pop(camera)
            try:
                drawn, pose = archetypes.picture_of(frame, read()), archetypes.camera_pose(frame)
            except ValueError as error:
                log.warning("camera %s: cannot record its image: %s", camera, error)
                continue
            self._at(frame.stamp_ns)
            self._recording.show(archetypes.camera_path(camera), *drawn)
            if camera not in self._arranged:
                self._arranged.add(camera)
                self._recording.arrange([pose], [camera])
