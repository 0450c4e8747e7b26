"""RGB-D frames of the simulated world, with graphics or without."""

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
    """An RGB-D picture: `rgb` (H, W, 3) and `depth_m` (H, W) along the optical axis, 0 where nothing is seen.

    `intrinsics` (3, 3) [pixel]; `map_from_camera` (4, 4), of the optical frame (x right, y down, z forward).
    """

    rgb: NDArray[np.uint8]
    depth_m: NDArray[np.float32]
    intrinsics: Floats
    map_from_camera: Floats
    sim_time_s: float


class Eye:
    """Sees for all cameras. Bound to one thread; where there is no OpenGL it casts rays."""

    def __init__(self, *, graphics: bool = True) -> None:
        gl = open_gl() if graphics else None
        self._offscreen = Offscreen(gl) if gl is not None else None

    @property
    def has_graphics(self) -> bool:
        """Whether OpenGL renders; else rays are cast, with flat colours."""
        return self._offscreen is not None

    def frame(
        self, model: mujoco.MjModel, data: mujoco.MjData, camera: str, width: int, height: int
    ) -> Frame:
        """What the named camera sees. Raises BadRequest for a camera that the world does not have."""
        view = camera_view(model, data, camera, width, height)
        rgb, depth = self.render(model, data, view)
        return Frame(rgb, depth, view.intrinsics, view.map_from_camera, float(data.time))

    def render(
        self, model: mujoco.MjModel, data: mujoco.MjData, view: View
    ) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
        """Rgb (H, W, 3) and depth (H, W) [m] of any view."""
        if self._offscreen is not None:
            return self._offscreen.render(model, data, view)
        rgb, depth, _ = raycast(model, data, view)
        return rgb, depth

    def segment(self, model: mujoco.MjModel, data: mujoco.MjData, view: View) -> NDArray[np.int32]:
        """(H, W) the geom that each pixel sees, -1 for none."""
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
    """A picture for people as PNG, with smooth edges: drawn at twice the size, where OpenGL allows that.

    `labels` are draw_labels beside their points (3,) [m] of the map frame.
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
