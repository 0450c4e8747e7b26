"""RGB-D frames of the simulated world, with OpenGL or ray casting."""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import mujoco
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from semmap.nodes.sim_node.bodies import Floats
from semmap.nodes.sim_node.vision.labels import draw_labels, project_points
from semmap.nodes.sim_node.vision.offscreen import MAX_PIXELS, Offscreen, open_gl
from semmap.nodes.sim_node.vision.raycast import raycast
from semmap.nodes.sim_node.vision.view import View, camera_view


@dataclass(frozen=True)
class Frame:
    """An RGB-D image: `rgb` (H, W, 3) and `depth_m` (H, W) along the optical axis, 0 for no measurement.

    `intrinsics` (3, 3) [pixel]; `map_from_camera` (4, 4), of the optical frame (x right, y down, z forward).
    """

    rgb: NDArray[np.uint8]
    depth_m: NDArray[np.float32]
    intrinsics: Floats
    map_from_camera: Floats
    sim_time_s: float


class Eye:
    """Renders for all cameras. Bound to one thread; without OpenGL it casts rays."""

    def __init__(self, *, graphics: bool = True) -> None:
        gl = open_gl() if graphics else None
        self._offscreen = Offscreen(gl) if gl is not None else None

    @property
    def has_graphics(self) -> bool:
        """Return whether OpenGL is used; otherwise rays are cast, with flat colours."""
        return self._offscreen is not None

    def frame(
        self, model: mujoco.MjModel, data: mujoco.MjData, camera: str, width: int, height: int
    ) -> Frame:
        """Return the frame of a named camera. Raises BadRequest for an unknown camera."""
        view = camera_view(model, data, camera, width, height)
        rgb, depth = self.render(model, data, view)
        return Frame(rgb, depth, view.intrinsics, view.map_from_camera, float(data.time))

    def render(
        self, model: mujoco.MjModel, data: mujoco.MjData, view: View
    ) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
        """Return rgb (H, W, 3) and depth (H, W) [m] of any view."""
        if self._offscreen is not None:
            return self._offscreen.render(model, data, view)
        rgb, depth, _ = raycast(model, data, view)
        return rgb, depth

    def segment(self, model: mujoco.MjModel, data: mujoco.MjData, view: View) -> NDArray[np.int32]:
        """Return (H, W) the geom of each pixel, -1 for none."""
        if self._offscreen is not None:
            return self._offscreen.segment(model, data, view)
        return raycast(model, data, view)[2]


def picture_png(
    eye: Eye,
    model: mujoco.MjModel,
    data: mujoco.MjData,
    view: View,
    labels: Mapping[str, Floats] = MappingProxyType({}),
) -> bytes:
    """Render a view as PNG, antialiased by rendering at twice the size if possible.

    `labels` are drawn next to their points (3,) [m] of the map frame.
    """
    factor = min(2.0, MAX_PIXELS[0] / view.width, MAX_PIXELS[1] / view.height) if eye.has_graphics else 2.0
    scale = np.diag([factor, factor, 1.0])
    width, height = int(factor * view.width), int(factor * view.height)
    fine = View(width, height, scale @ view.intrinsics, view.map_from_camera)
    rgb = (
        eye.render(model, data, fine)[0] if eye.has_graphics else raycast(model, data, fine, shadows=True)[0]
    )
    image = Image.fromarray(rgb).resize((view.width, view.height), Image.Resampling.BOX)
    if labels:
        image = draw_labels(image, project_points(view, labels))
    out = io.BytesIO()
    image.save(out, format="PNG")
    return out.getvalue()
