"""Rendering with OpenGL off screen; the context is kept from one model to the next."""

from __future__ import annotations

import importlib
import os
import sys
import threading
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from semmap.nodes.sim_node.physics.build import FELT_GROUP
from semmap.nodes.sim_node.vision.view import View

_NEAR_M, _FAR_M = 0.05, 200.0
MAX_PIXELS = (2560, 1440)


_of_thread = threading.local()


def open_gl() -> Any | None:
    """This thread's OpenGL context off screen, or None where there is none to be had.

    `MUJOCO_GL` chooses (egl, osmesa, disabled); by default EGL, on macOS CGL. A thread has one for all its
    life: what is drawn with is freed, at any time, in the context that is current, and under the same
    numbers another context would have things of its own.
    """
    if not hasattr(_of_thread, "gl"):
        _of_thread.gl = _new_gl()
    return _of_thread.gl


def _new_gl() -> Any | None:
    choice = os.environ.get("MUJOCO_GL", "cgl" if sys.platform == "darwin" else "egl").lower()
    if choice not in ("egl", "osmesa", "cgl"):
        return None
    try:
        context = importlib.import_module(f"mujoco.{choice}").GLContext(*MAX_PIXELS)
        context.make_current()
    except Exception:  # the loaders fail each in its own way: ImportError, RuntimeError, AttributeError, ...
        return None
    return context


class Offscreen:
    """Renders views of a model that changes. Bound to the thread that made it."""

    def __init__(self, gl: Any) -> None:
        self._gl = gl
        self._option = mujoco.MjvOption()
        self._option.geomgroup[FELT_GROUP] = 0
        self._assets: tuple[float, ...] = ()
        self._context: mujoco.MjrContext | None = None
        self._scene: mujoco.MjvScene | None = None

    def render(
        self, model: mujoco.MjModel, data: mujoco.MjData, view: View
    ) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
        """Rgb (H, W, 3) and depth (H, W) [m] along the optical axis, 0 where nothing is seen."""
        context, scene = self._prepare(model, view)
        self._aim(model, data, scene, view)
        rect = mujoco.MjrRect(0, 0, view.width, view.height)
        mujoco.mjr_render(rect, scene, context)
        rgb = np.empty((view.height, view.width, 3), np.uint8)
        buffer = np.empty((view.height, view.width), np.float32)
        mujoco.mjr_readPixels(rgb, buffer, rect, context)
        return rgb[::-1].copy(), _depth_m(buffer[::-1])

    def segment(self, model: mujoco.MjModel, data: mujoco.MjData, view: View) -> NDArray[np.int32]:
        """(H, W) the geom that each pixel sees, -1 for none."""
        context, scene = self._prepare(model, view)
        self._aim(model, data, scene, view)
        flags = [mujoco.mjtRndFlag.mjRND_SEGMENT.value, mujoco.mjtRndFlag.mjRND_IDCOLOR.value]
        scene.flags[flags] = 1
        rect = mujoco.MjrRect(0, 0, view.width, view.height)
        mujoco.mjr_render(rect, scene, context)
        scene.flags[flags] = 0
        rgb = np.empty((view.height, view.width, 3), np.uint8)
        mujoco.mjr_readPixels(rgb, None, rect, context)
        ids = rgb[::-1].astype(np.int32) @ np.array([1, 256, 65536], np.int32)
        geoms = np.full(scene.ngeom + 1, -1, np.int32)
        for geom in scene.geoms[: scene.ngeom]:
            if geom.segid >= 0 and geom.objtype == mujoco.mjtObj.mjOBJ_GEOM:
                geoms[geom.segid + 1] = geom.objid
        return np.asarray(geoms[np.clip(ids, 0, scene.ngeom)])

    def _prepare(self, model: mujoco.MjModel, view: View) -> tuple[mujoco.MjrContext, mujoco.MjvScene]:
        """The scene is renewed with the model; the costly context only when meshes or textures change.

        The buffer has the size of the view, because all of it is cleared for each picture.
        """
        self._gl.make_current()
        assets = (
            model.nmesh,
            model.nmeshvert,
            model.nhfield,
            model.ntex,
            model.ntexdata,
            model.nskin,
            float(model.mesh_vert.sum()),
        )
        if self._context is None or assets != self._assets:
            self._context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_50.value)
            self._context.readDepthMap = mujoco.mjtDepthMap.mjDEPTH_ZEROFAR
            self._assets = assets
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._context)
        if (self._context.offWidth, self._context.offHeight) != (view.width, view.height):
            mujoco.mjr_resizeOffscreen(view.width, view.height, self._context)
        if self._scene is None or self._scene.maxgeom < model.ngeom + 100:
            self._scene = mujoco.MjvScene(model, maxgeom=2 * model.ngeom + 1000)
        return self._context, self._scene

    def _aim(self, model: mujoco.MjModel, data: mujoco.MjData, scene: mujoco.MjvScene, view: View) -> None:
        camera = mujoco.MjvCamera()
        category = mujoco.mjtCatBit.mjCAT_ALL.value
        mujoco.mjv_updateScene(model, data, self._option, None, camera, category, scene)
        top = _NEAR_M * np.tan(view.fovy_rad / 2.0)
        side = top * view.width / view.height
        for eye in scene.camera:
            eye.pos = view.map_from_camera[:3, 3]
            eye.forward, eye.up = view.map_from_camera[:3, 2], -view.map_from_camera[:3, 1]
            eye.frustum_near, eye.frustum_far = _NEAR_M, _FAR_M
            eye.frustum_bottom, eye.frustum_top = -top, top
            eye.frustum_center, eye.frustum_width = 0.0, side
            eye.orthographic = 0


def _depth_m(buffer: NDArray[np.float32]) -> NDArray[np.float32]:
    """Depth [m] from the reversed depth buffer, in which 0 is far and 1 near."""
    depth = buffer * np.float32(1.0 / _NEAR_M - 1.0 / _FAR_M)
    depth += np.float32(1.0 / _FAR_M)
    np.reciprocal(depth, out=depth)
    depth[buffer == 0.0] = 0.0
    return depth
