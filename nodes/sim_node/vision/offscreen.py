"""Offscreen rendering with OpenGL; the context is reused for several models."""

from __future__ import annotations

import importlib
import os
import sys
import threading
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from semmap.nodes.sim_node.physics.build import COLLISION_GROUP
from semmap.nodes.sim_node.vision.view import View

_NEAR_M, _FAR_M = 0.05, 200.0
MAX_PIXELS = (2560, 1440)


_of_thread = threading.local()


def open_gl() -> Any | None:
    """Return this thread's offscreen OpenGL context, or None if OpenGL is not available.

    `MUJOCO_GL` selects the backend (egl, osmesa, disabled); the default is EGL, on macOS CGL. A thread keeps
    one context forever: resources are freed at any time in the current context, and in another one the same
    ids would be other resources.
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
    except Exception:  # each loader raises other errors: ImportError, RuntimeError, AttributeError, ...
        return None
    return context


class Offscreen:
    """Renders views of a changing model. Bound to the thread that created it."""

    def __init__(self, gl: Any) -> None:
        self._gl = gl
        self._option = mujoco.MjvOption()
        self._option.geomgroup[COLLISION_GROUP] = 0
        self._assets: tuple[float, ...] = ()
        self._context: mujoco.MjrContext | None = None
        self._scene: mujoco.MjvScene | None = None

    def render(
        self, model: mujoco.MjModel, data: mujoco.MjData, view: View
    ) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
        """Return rgb (H, W, 3) and depth (H, W) [m] along the optical axis, 0 for no measurement."""
        context, scene = self._prepare(model, view)
        self._aim(model, data, scene, view)
        rect = mujoco.MjrRect(0, 0, view.width, view.height)
        mujoco.mjr_render(rect, scene, context)
        rgb = np.empty((view.height, view.width, 3), np.uint8)
        buffer = np.empty((view.height, view.width), np.float32)
        mujoco.mjr_readPixels(rgb, buffer, rect, context)
        return rgb[::-1].copy(), _depth_m(buffer[::-1])

    def segment(self, model: mujoco.MjModel, data: mujoco.MjData, view: View) -> NDArray[np.int32]:
        """Return (H, W) the geom of each pixel, -1 for none."""
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
        """Update the scene for the model; the expensive context is only recreated with meshes or textures.

        The buffer has the size of the view, because all of it is cleared for each image.
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
    """Return depth [m] from the reversed depth buffer, in which 0 is far and 1 near."""
    depth = buffer * np.float32(1.0 / _NEAR_M - 1.0 / _FAR_M)
    depth += np.float32(1.0 / _FAR_M)
    np.reciprocal(depth, out=depth)
    depth[buffer == 0.0] = 0.0
    return depth
