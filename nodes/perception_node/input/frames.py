"""Pairs colour and depth planes of cameras, validates them, and converts them to clouds."""

from __future__ import annotations

import math
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import Cloud, Transform
from semmap.nodes.perception_node.input.masks import Masks, masks_from_image, masks_from_runs
from semmap.nodes.perception_node.input.projection import (
    check_intrinsics,
    cloud_of,
    is_pose,
    thinned,
    thinning,
)
from semmap.schemas.errors import BadRequest
from semmap.schemas.perception import DetectedMasks
from semmap.schemas.scenes import CameraFrame

T = TypeVar("T", np.float32, np.uint8)

_SILENT_S = 2.0
"""A camera that was silent for this long may restart with another clock."""
_HELD = 8
"""Number of frames of a camera that wait for masks of a detector."""
_LATE_S = 1.0
"""Maximum time to wait for other cameras of the same moment."""


class Plane(NamedTuple):
    """One plane of one camera; `read` returns its pixels."""

    frame: CameraFrame
    read: Callable[[], bytes]


class Pair(NamedTuple):
    """The two planes of one frame, and a detector's masks."""

    rgb: Plane
    depth: Plane
    masks: DetectedMasks | None = None

    @property
    def stamp_ns(self) -> int:
        """Return the time of the frame."""
        return self.depth.frame.stamp_ns


class Frames:
    """The newest frame of each camera. Thread-safe.

    Cameras that once had the same stamp are synchronised, and wait for each other for a short time. Cameras
    with their own clocks take turns. If a detector sends masks for a camera, its frames wait for them until
    the detector falls silent.
    """

    def __init__(self) -> None:
        self._news = threading.Condition()
        self._planes: dict[tuple[str, str], tuple[Plane, float]] = {}
        self._pairs: dict[str, Pair] = {}
        self._partners: dict[str, set[str]] = {}
        self._taken_ns = 0
        self._taken: set[str] = set()
        self._turns = 0
        self._last_turn: dict[str, int] = {}
        self._masked_s: dict[str, float] = {}
        self._held: dict[str, deque[Pair]] = {}

    def put(self, frame: CameraFrame, read: Callable[[], bytes]) -> None:
        """Add a plane. Raises BadRequest if its stamp is not increasing."""
        key, now = (frame.camera, frame.encoding), time.monotonic()
        with self._news:
            before = self._planes.get(key)
            speaking = before is not None and now - before[1] < _SILENT_S
            if before is not None and speaking and frame.stamp_ns <= before[0].frame.stamp_ns:
                raise BadRequest(
                    f"camera {frame.camera}: frame ignored: its stamp is not newer than the last; stamps must"
                    " increase"
                )
            self._planes[key] = Plane(frame, read), now
            self._pair_up(frame)

    def put_masks(self, found: DetectedMasks) -> None:
        """Add a detector's masks of a frame. Raises BadRequest if that frame is not available."""
        camera, now = found.camera, time.monotonic()
        with self._news:
            first = camera not in self._masked_s
            self._masked_s[camera] = now
            held = self._held.setdefault(camera, deque(maxlen=_HELD))
            while held and held[0].stamp_ns < found.stamp_ns:
                held.popleft()
            if held and held[0].stamp_ns == found.stamp_ns:
                self._pairs[camera] = held.popleft()._replace(masks=found)
                self._news.notify_all()
            elif not first:
                raise BadRequest(
                    f"camera {camera}: masks ignored: no frame with their stamp_ns; send masks in order and"
                    f" within {_HELD} frames"
                )

    def take(self, timeout_s: float) -> tuple[Pair, ...]:
        """Return the newest frames of one moment, ordered by camera; empty after the timeout."""
        deadline = time.monotonic() + timeout_s
        with self._news:
            while not self._pairs:
                if not self._news.wait(deadline - time.monotonic()):
                    return ()
            late = time.monotonic() + _LATE_S
            while (missing := self._missing()) and self._news.wait(late - time.monotonic()):
                pass
            for camera in missing:
                self._partners.pop(camera, None)
            cameras = self._next()
            self._turns += 1
            for camera in cameras:
                self._partners[camera] = cameras | (self._partners.get(camera, set()) - missing)
                self._last_turn[camera] = self._turns
            for camera in self._outdated():
                del self._pairs[camera]
            pairs = tuple(self._pairs.pop(camera) for camera in sorted(cameras))
            self._taken, self._taken_ns = cameras, pairs[0].stamp_ns
            return pairs

    def _pair_up(self, frame: CameraFrame) -> None:
        rgb, _ = self._planes.get((frame.camera, "rgb8"), (None, 0.0))
        depth, _ = self._planes.get((frame.camera, "depth32f"), (None, 0.0))
        if rgb is None or depth is None or rgb.frame.stamp_ns != depth.frame.stamp_ns:
            return
        if frame.stamp_ns == self._taken_ns:  # too late for this moment, but later frames wait for it
            for camera in (*self._taken, frame.camera):
                self._partners.setdefault(camera, set()).update(self._taken, {frame.camera})
            return
        if time.monotonic() - self._masked_s.get(frame.camera, -math.inf) < _SILENT_S:
            self._held[frame.camera].append(Pair(rgb, depth))
            return
        self._pairs[frame.camera] = Pair(rgb, depth)
        self._news.notify_all()

    def _next(self) -> set[str]:
        """Return the cameras of one moment: the ones served longest ago and, among these, the newest."""
        current = self._pairs.keys() - self._outdated()
        first = min(current, key=lambda name: (self._last_turn.get(name, 0), -self._pairs[name].stamp_ns))
        stamp_ns = self._pairs[first].stamp_ns
        return {camera for camera, pair in self._pairs.items() if pair.stamp_ns == stamp_ns}

    def _outdated(self) -> set[str]:
        """Return cameras whose frame is older than that of a synchronised camera."""
        return {
            camera
            for camera, pair in self._pairs.items()
            for partner in self._partners.get(camera, set()) & self._pairs.keys()
            if self._pairs[partner].stamp_ns > pair.stamp_ns
        }

    def _missing(self) -> set[str]:
        cameras = self._next()
        return set().union(*(self._partners.get(camera, set()) for camera in cameras)) - cameras


def read_cloud(pair: Pair) -> Cloud:
    """Return the points of a frame, subsampled if there are too many. Raises BadRequest if it is invalid."""
    frame = pair.depth.frame
    colour = pair.rgb.frame
    if (frame.width, frame.height) != (colour.width, colour.height):
        raise BadRequest(
            f"camera {frame.camera}: its colour image has {colour.width} x {colour.height} pixels, its depth"
            f" {frame.width} x {frame.height}; they must have the same size"
        )
    shape = (frame.height, frame.width)
    (intrinsics, notes), pose = _intrinsics(frame), _pose(frame)
    depth_m = _pixels(pair.depth, np.float32, shape)
    rgb = _pixels(pair.rgb, np.uint8, (*shape, 3))
    step = thinning(frame.width, frame.height)
    depth_m, rgb, intrinsics = thinned(depth_m, rgb, intrinsics, step)
    cloud = cloud_of(depth_m, rgb, intrinsics, pose, camera=frame.camera, stamp_ns=frame.stamp_ns)
    return replace(cloud, notes=notes)


def _pixels(plane: Plane, kind: type[T], shape: tuple[int, ...]) -> NDArray[T]:
    content, wanted = plane.read(), math.prod(shape) * np.dtype(kind).itemsize
    if len(content) != wanted or not wanted:
        raise BadRequest(
            f"camera {plane.frame.camera}: {len(content)} bytes are not a {plane.frame.encoding} image of"
            f" {plane.frame.width} x {plane.frame.height} pixels, which has {wanted}"
        )
    return np.frombuffer(content, np.dtype(kind).newbyteorder("<")).astype(kind, copy=False).reshape(shape)


def _intrinsics(frame: CameraFrame) -> tuple[Transform, tuple[str, ...]]:
    """Return the intrinsics (3, 3) and notes on doubtful ones. Raises BadRequest for impossible ones."""
    numbers = np.array(frame.intrinsics, dtype=float)
    if numbers.size != 9:
        raise BadRequest(
            f"camera {frame.camera}: the intrinsics have {numbers.size} numbers; the format is fx 0 cx 0 fy"
            " cy 0 0 1"
        )
    try:
        doubt = check_intrinsics(numbers.reshape(3, 3), frame.width, frame.height)
    except ValueError as error:
        raise BadRequest(f"camera {frame.camera}: {error}") from None
    return numbers.reshape(3, 3), (doubt,) if doubt else ()


def _pose(frame: CameraFrame) -> Transform:
    numbers = np.array(frame.map_from_camera, dtype=float)
    if numbers.size == 16 and is_pose(numbers.reshape(4, 4)):
        return numbers.reshape(4, 4)
    raise BadRequest(
        f"camera {frame.camera}: map_from_camera is not a 4 x 4 pose matrix:"
        " rotation, position, last row 0 0 0 1"
    )


def read_masks(pair: Pair) -> Masks | None:
    """Return a detector's masks at the resolution of the cloud. Raises BadRequest if they are invalid."""
    found, frame = pair.masks, pair.depth.frame
    if found is None:
        return None
    try:
        if (found.width, found.height) != (frame.width, frame.height):
            raise ValueError(
                f"they are of {found.width} x {found.height} pixels,"
                f" the image of {frame.width} x {frame.height}"
            )
        if found.image is not None:
            masks = masks_from_image(found.image, frame.height, frame.width)
        else:
            masks = masks_from_runs(found.masks, frame.height, frame.width)
    except ValueError as error:
        raise BadRequest(f"camera {frame.camera}: masks ignored: {error}") from None
    return replace(masks.thinned(thinning(frame.width, frame.height)), alone=found.alone)
