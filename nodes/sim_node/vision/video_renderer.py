"""Renders images on a separate thread, from copies, so that the simulation is never blocked."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

import mujoco
import numpy as np
from numpy.typing import NDArray

from semmap.nodes.sim_node.bodies import Floats
from semmap.nodes.sim_node.config import CameraConfig
from semmap.nodes.sim_node.vision.camera import Eye, picture_png
from semmap.nodes.sim_node.vision.noise import kinect_noise
from semmap.nodes.sim_node.vision.view import View, camera_names, camera_view
from semmap.schemas.scenes import CameraFrame, Picture

Plane = tuple[CameraFrame, NDArray[np.generic]]


@dataclass(frozen=True)
class SceneSnapshot:
    """A copy of the world at one moment. `names` (ngeom,) is the body of each geom, "" for none."""

    model: mujoco.MjModel
    data: mujoco.MjData
    names: list[str]
    stamp_ns: int = field(default_factory=time.time_ns)


class VideoRenderer:
    """Owns the rendering thread and its OpenGL context."""

    def __init__(self, config: CameraConfig, segments_wanted: Callable[[], bool] = lambda: True) -> None:
        """Start the thread.

        `segments_wanted()` returns whether segments have subscribers, since they are costly.
        """
        self._config = config
        self._segments_wanted = segments_wanted
        self._thread = ThreadPoolExecutor(max_workers=1, thread_name_prefix="renderer")
        self._eye: Eye | None = None
        self._rng = np.random.default_rng(0)
        self._rendering: Future[None] | None = None

    def close(self) -> None:
        """Finish the current image and stop."""
        self._thread.shutdown(wait=True, cancel_futures=True)

    def render_picture(
        self, snapshot: SceneSnapshot, view: View, labels: Mapping[str, Floats] = MappingProxyType({})
    ) -> Future[Picture]:
        """Render an image as PNG, with `labels` next to their points (3,) [m] of the map frame."""
        return self._thread.submit(
            lambda: Picture(png=picture_png(self._open_eye(), snapshot.model, snapshot.data, view, labels))
        )

    def render_cameras(self, snapshot: Callable[[], SceneSnapshot], publish: Callable[[Plane], None]) -> None:
        """Publish the planes of all cameras, unless the previous ones are still being rendered."""
        if self._rendering is not None:
            if not self._rendering.done():
                return
            self._rendering.result()
        current = snapshot()
        self._rendering = self._thread.submit(self._render, current, publish)

    def _render(self, snapshot: SceneSnapshot, publish: Callable[[Plane], None]) -> None:
        for camera in camera_names(snapshot.model):
            for plane in self.planes(snapshot, camera):
                publish(plane)

    def _open_eye(self) -> Eye:
        """Create the renderer when it is first needed, on the thread that it is bound to."""
        self._eye = self._eye or Eye(graphics=self._config.graphics)
        return self._eye

    def planes(self, snapshot: SceneSnapshot, camera: str) -> list[Plane]:
        """Return the planes of one camera: rgb, depth, and segments if requested."""
        config = self._config
        eye = self._open_eye()
        view = camera_view(snapshot.model, snapshot.data, camera, config.width, config.height)
        rgb, depth = eye.render(snapshot.model, snapshot.data, view)
        if config.noise:
            depth = kinect_noise(depth, self._rng)
        planes: list[Plane] = [
            (_frame(snapshot, camera, view, "rgb8"), rgb),
            (_frame(snapshot, camera, view, "depth32f"), depth),
        ]
        if config.segments and self._segments_wanted():
            names, segments = segment_bodies(eye.segment(snapshot.model, snapshot.data, view), snapshot.names)
            planes.append((_frame(snapshot, camera, view, "segments16", names), segments))
        return planes


def segment_bodies(geoms: NDArray[np.int32], owners: list[str]) -> tuple[tuple[str, ...], NDArray[np.uint16]]:
    """Convert geoms (H, W), -1 for none, to numbers of bodies (H, W): 0 for none, n for the n-th name."""
    names = tuple(sorted(set(owners) - {""}))
    number = {name: place + 1 for place, name in enumerate(names)}
    numbers = np.array([*(number.get(owner, 0) for owner in owners), 0], dtype=np.uint16)
    return names, numbers[geoms]


def _frame(
    snapshot: SceneSnapshot,
    camera: str,
    view: View,
    encoding: Literal["rgb8", "depth32f", "segments16"],
    names: tuple[str, ...] = (),
) -> CameraFrame:
    return CameraFrame(
        camera=camera,
        encoding=encoding,
        width=view.width,
        height=view.height,
        stamp_ns=snapshot.stamp_ns,
        sim_time_s=float(snapshot.data.time),
        intrinsics=tuple(view.intrinsics.ravel().tolist()),
        map_from_camera=tuple(view.map_from_camera.ravel().tolist()),
        names=names,
    )
