"""The worker thread that processes the newest frames without blocking the node or the session."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Sequence

from semmap.nodes.perception_node.input.cloud import FARTHEST_M, FEWEST_POINTS, NEAREST_M, Cloud
from semmap.nodes.perception_node.input.frames import Frames, Pair, read_cloud, read_masks
from semmap.nodes.perception_node.input.live_robot import LiveRobot
from semmap.nodes.perception_node.input.masks import Masks
from semmap.nodes.perception_node.input.projection import thinning
from semmap.nodes.perception_node.pipeline import FrameResult
from semmap.schemas.errors import BadRequest
from semmap.schemas.perception import DetectedMasks
from semmap.schemas.scenes import CameraFrame

log = logging.getLogger(__name__)

_TAKE_S = 0.5

Seen = Callable[[Sequence[Cloud], FrameResult, float], None]
"""Callback with the clouds of one moment, the result, and the processing time [s]."""


class FrameWorker:
    """Processes frames as fast as possible; frames that arrive in between are skipped."""

    def __init__(
        self,
        look: Callable[[Sequence[Cloud], Sequence[Masks | None]], FrameResult],
        on_look: Seen,
        complain: Callable[[str], None],
        robot: LiveRobot | None = None,
    ) -> None:
        """Start the thread. `look(clouds, masks)` processes one frame, without the points on `robot`.

        `on_look` and `complain(text)` are called on the worker's thread.
        """
        self._look = look
        self._on_look = on_look
        self._complain = complain
        self._robot = robot
        self._frames = Frames()
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._run, name="frames", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Finish the current frame and stop."""
        self._stopping.set()
        self._thread.join()

    def keep(self, frame: CameraFrame, read: Callable[[], bytes]) -> None:
        """Store a plane of a camera. Thread-safe, does not block."""
        try:
            self._frames.put(frame, read)
        except BadRequest as error:
            self._complain(error.text)

    def keep_masks(self, found: DetectedMasks) -> None:
        """Store a detector's masks of a camera frame. Thread-safe, does not block."""
        try:
            self._frames.put_masks(found)
        except BadRequest as error:
            self._complain(error.text)

    def _run(self) -> None:
        while not self._stopping.is_set():
            pairs = self._frames.take(_TAKE_S)
            try:
                read = [(pair, cloud) for pair in pairs if (cloud := self._read(pair)) is not None]
                if read:
                    clouds, masks = [cloud for _, cloud in read], [self._masks(pair) for pair, _ in read]
                    start = time.perf_counter()
                    found = self._look(clouds, masks)
                    self._on_look(clouds, found, time.perf_counter() - start)
            except Exception as error:
                log.exception("processing a frame failed")
                self._complain(f"processing a frame failed: {type(error).__name__}: {error}")

    def _masks(self, pair: Pair) -> Masks | None:
        try:
            return read_masks(pair)
        except BadRequest as error:
            self._complain(error.text)
            return None

    def _read(self, pair: Pair) -> Cloud | None:
        frame = pair.depth.frame
        try:
            cloud = read_cloud(pair)
        except BadRequest as error:
            self._complain(error.text)
            return None
        for note in cloud.notes:
            self._complain(f"camera {frame.camera}: {note}")
        step = thinning(frame.width, frame.height)
        if step > 1:
            size = f"{frame.width} x {frame.height} pixels"
            self._complain(f"camera {frame.camera}: {size} reduced by a factor of {step}")
        if cloud.measured < FEWEST_POINTS:
            self._complain(
                f"camera {frame.camera} has no depth values from {NEAREST_M:g} to {FARTHEST_M:g} m"
            )
        return cloud if self._robot is None else self._without_robot(self._robot, cloud)

    def _without_robot(self, robot: LiveRobot, cloud: Cloud) -> Cloud:
        try:
            return robot.remove_from(cloud)
        except BadRequest as error:
            self._complain(error.text)
            return cloud
