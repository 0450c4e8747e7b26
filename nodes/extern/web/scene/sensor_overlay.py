"""Camera images and perception results in the scene of one tab, received only while they are switched on."""

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
from semmap.nodes.extern.web.scene.annotations import Labels, Lines
from semmap.nodes.extern.web.scene.picking import edges_of
from semmap.schemas import keys
from semmap.schemas.entities import Vector
from semmap.schemas.perception import Observation, Observations, SegmentedCloud
from semmap.schemas.scenes import CameraFrame

log = logging.getLogger(__name__)

Layer = Literal["observations", "cloud", "cameras"]
_IMAGE_PX: Final = 320
_IMAGE_S: Final = 0.5
"""Minimum interval between two images of a camera."""
_FRUSTUM_M: Final = 0.6
_POINT_M: Final = 0.008


class SensorOverlay:
    """Boxes of observations, point clouds and camera images."""

    def __init__(self, scene: SceneApi, live: Live) -> None:
        self._scene, self._live = scene, live
        self._stops: dict[Layer, Callable[[], object]] = {}
        self._boxes = Lines(scene, "/seen/boxes", width=2.0)
        self._labels = Labels(scene, "/seen/names")
        self._cameras: set[str] = set()

    def switch(self, layer: Layer, *, on: bool) -> None:
        """Show or hide a layer."""
        if on == (layer in self._stops):
            return
        if on:
            self._stops[layer] = self._subscribe(layer)
        else:
            self._stops.pop(layer)()
            self._erase(layer)

    def close(self) -> None:
        """End all subscriptions."""
        for stop in self._stops.values():
            stop()
        self._stops.clear()

    def _subscribe(self, layer: Layer) -> Callable[[], object]:
        match layer:
            case "observations":
                return self._live.follow(keys.OBSERVATIONS, lambda _, found: self._show_observations(found))
            case "cloud":
                return self._live.follow(keys.CLOUD, lambda _, cloud: self._show_cloud(cloud))
        return self._subscribe_cameras()

    def _erase(self, layer: Layer) -> None:
        match layer:
            case "observations":
                self._boxes.show([])
                self._labels.show({})
            case "cloud":
                self._remove("/seen/cloud")
            case "cameras":
                for camera in self._cameras:
                    self._remove(f"/seen/cameras/{camera}")
                self._cameras.clear()

    def _remove(self, name: str) -> None:
        if self._scene.get_handle_by_name(name) is not None:
            self._scene.remove_by_name(name)

    def _show_observations(self, found: Observations) -> None:
        if "observations" not in self._stops:
            return
        self._boxes.show(
            [(edges_of(one.pose, one.size_m), colour_of(one.class_)) for one in found.observations]
        )
        self._labels.show({str(i): (_label(one), _centre(one)) for i, one in enumerate(found.observations)})

    def _show_cloud(self, cloud: SegmentedCloud) -> None:
        if "cloud" in self._stops:
            points = np.frombuffer(cloud.positions, "<f4").reshape(-1, 3)
            colours = np.frombuffer(cloud.colors, np.uint8).reshape(-1, 3)
            self._scene.add_point_cloud("/seen/cloud", points, colours, point_size=_POINT_M)

    def _subscribe_cameras(self) -> Callable[[], object]:
        """Show the newest image of each camera twice a second; the pixels of others are not read."""
        loop, due_s = asyncio.get_running_loop(), dict[str, float]()

        def receive(frame: CameraFrame, read: Callable[[], bytes]) -> None:
            now_s = time.monotonic()
            if now_s >= due_s.get(frame.camera, 0.0):
                due_s[frame.camera] = now_s + _IMAGE_S
                pixels = read()
                with contextlib.suppress(RuntimeError):  # the loop has ended
                    loop.call_soon_threadsafe(self._show_image, frame, pixels)

        return bus.follow_cameras(self._live.session, "rgb", receive, log.warning)

    def _show_image(self, frame: CameraFrame, pixels: bytes) -> None:
        if "cameras" not in self._stops:
            return
        try:
            image = image_of(frame, pixels)
        except ValueError:
            log.warning("camera %s: the image does not have the stated size", frame.camera)
            return
        self._cameras.add(frame.camera)
        name = f"/seen/cameras/{frame.camera}"
        handle: Any = self._scene.get_handle_by_name(name)
        if handle is not None:
            handle.image = image
        position, wxyz, fov_rad = camera_pose_of(frame)
        if handle is None:
            self._scene.add_camera_frustum(
                name,
                fov=fov_rad,
                aspect=frame.width / frame.height,
                scale=_FRUSTUM_M,
                image=image,
                format="jpeg",
                color=GREY,
                position=position,
                wxyz=wxyz,
            )
        else:
            handle.position, handle.wxyz = position, wxyz


def image_of(frame: CameraFrame, pixels: bytes) -> NDArray[np.uint8]:
    """Return a smaller image (height, width, 3). Raises ValueError if the number of pixels is wrong."""
    image = np.frombuffer(pixels, np.uint8).reshape(frame.height, frame.width, 3)
    step = max(1, frame.width // _IMAGE_PX)
    return np.ascontiguousarray(image[::step, ::step])


def camera_pose_of(frame: CameraFrame) -> tuple[Vector, tuple[float, float, float, float], float]:
    """Return the position [m], the orientation (wxyz) and the vertical field of view [rad] of a camera."""
    pose = np.array(frame.map_from_camera, dtype=float).reshape(4, 4)
    focal = float(np.array(frame.intrinsics).reshape(3, 3)[1, 1])
    x, y, z = (float(value) for value in pose[:3, 3])
    return (x, y, z), wxyz_of(pose[:3, :3]), 2.0 * math.atan(frame.height / 2.0 / focal)


def wxyz_of(rotation: NDArray[np.float64]) -> tuple[float, float, float, float]:
    """Return the unit quaternion of a rotation matrix (3, 3)."""
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
    text = f"{one.class_} {one.probability:.0%}"
    return f"{one.entity}: {text}" if one.entity else text


def _centre(one: Observation) -> Vector:
    """Return the centre, because the name of the entity is shown above it."""
    x, y, z = one.pose.position_m
    return (x, y, z + one.size_m[2] / 2.0)
