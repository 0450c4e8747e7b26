"""What cameras and perception see, in one tab's view; followed only while it is switched on."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import math
import time
from collections.abc import Callable
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray
from viser import SceneApi

from semmap.nodes import bus
from semmap.nodes.drawing.palette import GREY, colour_of
from semmap.nodes.extern.web.live import Live
from semmap.nodes.extern.web.scene.marks import Labels, Lines
from semmap.nodes.extern.web.scene.picking import edges_of
from semmap.schemas import keys
from semmap.schemas.entities import Vector
from semmap.schemas.perception import Observation, Observations, SegmentedCloud
from semmap.schemas.scenes import CameraFrame

log = logging.getLogger(__name__)

What = Literal["observations", "cloud", "cameras"]
_PICTURE_PX: Final = 320
_PICTURE_S: Final = 0.5
"""A camera's picture is shown no more often."""
_FRUSTUM_M: Final = 0.6
_POINT_M: Final = 0.008


class Seen:
    """Boxes of observations, points and pictures as they come."""

    def __init__(self, scene: SceneApi, live: Live) -> None:
        self._scene, self._live = scene, live
        self._stops: dict[What, Callable[[], object]] = {}
        self._boxes = Lines(scene, "/seen/boxes", width=2.0)
        self._labels = Labels(scene, "/seen/names")
        self._observations: tuple[Observation, ...] = ()
        self._pictures: dict[str, float] = {}

    def switch(self, what: What, *, on: bool) -> None:
        """Begin to follow and show this, or end it."""
        if on == (what in self._stops):
            return
        if on:
            self._stops[what] = self._follow(what)
        else:
            self._stops.pop(what)()
            self._erase(what)

    def close(self) -> None:
        """Follow nothing any more."""
        for stop in self._stops.values():
            stop()
        self._stops.clear()

    def _follow(self, what: What) -> Callable[[], object]:
        match what:
            case "observations":
                return self._live.follow(keys.OBSERVATIONS, lambda _, seen: self._show_observations(seen))
            case "cloud":
                return self._live.follow(keys.CLOUD, lambda _, cloud: self._show_cloud(cloud))
        return self._follow_cameras()

    def _erase(self, what: What) -> None:
        match what:
            case "observations":
                self._boxes.show([])
                self._labels.show({})
            case "cloud":
                self._remove("/seen/cloud")
            case "cameras":
                for camera in self._pictures:
                    self._remove(f"/seen/cameras/{camera}")
                self._pictures.clear()

    def _remove(self, name: str) -> None:
        if self._scene.get_handle_by_name(name) is not None:
            self._scene.remove_by_name(name)

    def _show_observations(self, seen: Observations) -> None:
        self._observations = seen.observations
        if "observations" not in self._stops:
            return
        self._boxes.show(
            [(edges_of(one.pose, one.size_m), colour_of(one.class_)) for one in seen.observations]
        )
        self._labels.show({str(i): (_label(one), _middle(one)) for i, one in enumerate(seen.observations)})

    def _show_cloud(self, cloud: SegmentedCloud) -> None:
        if "cloud" in self._stops:
            points = np.frombuffer(cloud.positions, "<f4").reshape(-1, 3)
            colours = np.frombuffer(cloud.colors, np.uint8).reshape(-1, 3)
            self._scene.add_point_cloud("/seen/cloud", points, colours, point_size=_POINT_M)

    def _follow_cameras(self) -> Callable[[], object]:
        """Of each camera's pictures the newest, twice a second: what comes between is not even read."""
        loop, due_s = asyncio.get_running_loop(), dict[str, float]()

        def receive(frame: CameraFrame, read: Callable[[], bytes]) -> None:
            now_s = time.monotonic()
            if now_s >= due_s.get(frame.camera, 0.0):
                due_s[frame.camera] = now_s + _PICTURE_S
                pixels = read()
                with contextlib.suppress(RuntimeError):  # the loop has ended
                    loop.call_soon_threadsafe(self._show_picture, frame, pixels)

        return bus.follow_cameras(self._live.session, "rgb", receive, log.warning)

    def _show_picture(self, frame: CameraFrame, pixels: bytes) -> None:
        if "cameras" not in self._stops:
            return
        try:
            picture = picture_of(frame, pixels)
        except ValueError:
            log.warning("camera %s: a picture that has not the size it says", frame.camera)
            return
        self._pictures[frame.camera] = 0.0
        name = f"/seen/cameras/{frame.camera}"
        handle: Any = self._scene.get_handle_by_name(name)
        if handle is not None:
            handle.image = picture
        position, wxyz, fov_rad = stand_of(frame)
        if handle is None:
            self._scene.add_camera_frustum(
                name,
                fov=fov_rad,
                aspect=frame.width / frame.height,
                scale=_FRUSTUM_M,
                image=picture,
                format="jpeg",
                color=GREY,
                position=position,
                wxyz=wxyz,
            )
        else:
            handle.position, handle.wxyz = position, wxyz


def picture_of(frame: CameraFrame, pixels: bytes) -> NDArray[np.uint8]:
    """(height, width, 3): the picture, made small. Raises ValueError when the pixels are not the frame's."""
    picture = np.frombuffer(pixels, np.uint8).reshape(frame.height, frame.width, 3)
    step = max(1, frame.width // _PICTURE_PX)
    return np.ascontiguousarray(picture[::step, ::step])


def stand_of(frame: CameraFrame) -> tuple[Vector, tuple[float, float, float, float], float]:
    """Where a camera is [m], how its optical frame is turned (wxyz), and its angle of view upright [rad]."""
    pose = np.array(frame.map_from_camera, dtype=float).reshape(4, 4)
    focal = float(np.array(frame.intrinsics).reshape(3, 3)[1, 1])
    x, y, z = (float(value) for value in pose[:3, 3])
    return (x, y, z), wxyz_of(pose[:3, :3]), 2.0 * math.atan(frame.height / 2.0 / focal)


def wxyz_of(rotation: NDArray[np.float64]) -> tuple[float, float, float, float]:
    """The unit quaternion of a rotation (3, 3), by its largest component."""
    m = rotation
    squares = np.array(
        [
            1 + m[0, 0] + m[1, 1] + m[2, 2],
            1 + m[0, 0] - m[1, 1] - m[2, 2],
            1 - m[0, 0] + m[1, 1] - m[2, 2],
            1 - m[0, 0] - m[1, 1] + m[2, 2],
        ]
    )
    products = np.array(
        [
            (squares[0], m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]),
            (m[2, 1] - m[1, 2], squares[1], m[1, 0] + m[0, 1], m[0, 2] + m[2, 0]),
            (m[0, 2] - m[2, 0], m[1, 0] + m[0, 1], squares[2], m[2, 1] + m[1, 2]),
            (m[1, 0] - m[0, 1], m[0, 2] + m[2, 0], m[2, 1] + m[1, 2], squares[3]),
        ]
    )
    row = products[int(squares.argmax())]
    w, x, y, z = (float(value) for value in row / np.linalg.norm(row))
    return (w, x, y, z)


def _label(one: Observation) -> str:
    said = f"{one.class_} {one.probability:.0%}"
    return f"{one.entity}: {said}" if one.entity else said


def _middle(one: Observation) -> Vector:
    """Not above it, where the entity's name is."""
    x, y, z = one.pose.position_m
    return (x, y, z + one.size_m[2] / 2.0)
