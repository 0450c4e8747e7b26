"""MuJoCo's interactive viewer: double click selects a body, Ctrl-drag applies a force."""

from __future__ import annotations

import threading
import warnings

import mujoco
import numpy as np

from semmap.nodes.sim_node.world import World
from semmap.schemas.errors import BadRequest

_LABEL_M = 0.3
_LABEL_LENGTH = 99  # MuJoCo's limit


class Window:
    """The viewer window. Mouse forces are applied to the world's data."""

    def __init__(self, world: World) -> None:
        """Open the window. Raises BadRequest without a display."""
        _require_display()
        from mujoco import viewer  # loads GLFW, which requires a display

        self._world = world
        self._shown = world.model
        before = set(threading.enumerate())
        self._viewer = viewer.launch_passive(world.model, world.data, show_left_ui=False, show_right_ui=False)
        self._threads = set(threading.enumerate()) - before
        with self._viewer.lock():
            mujoco.mjv_defaultFreeCamera(world.model, self._viewer.cam)

    def refresh(self) -> None:
        """Draw the current world, and apply mouse forces."""
        if not self._viewer.is_running():
            return
        if self._world.model is not self._shown:
            # the passive viewer has no public way to change models; this is what its own reload does
            simulate = self._viewer._get_sim()
            if simulate is not None:
                simulate.load(self._world.model, self._world.data, "")
            self._shown = self._world.model
        with self._viewer.lock():
            self._label()
        self._viewer.sync()

    def _label(self) -> None:
        """Draw the name above the selected body.

        Names in the MuJoCo model may be outdated, since bodies are written into existing slots.
        """
        world, scene, number = self._world, self._viewer.user_scn, self._viewer.perturb.select
        (name,) = world.names_of(np.array([number])) if 0 < number < world.model.nbody else ("",)
        scene.ngeom = int(bool(name))
        if name:
            label, above = scene.geoms[0], world.data.xpos[number] + (0.0, 0.0, _LABEL_M)
            mujoco.mjv_initGeom(
                label,
                mujoco.mjtGeom.mjGEOM_LABEL,
                np.ones(3),
                above,
                np.eye(3).ravel(),
                np.ones(4, np.float32),
            )
            label.label = name[:_LABEL_LENGTH]

    def close(self) -> None:
        """Close the window and wait for the last frame, since the process cannot exit before."""
        self._viewer.close()
        for thread in self._threads:
            thread.join(timeout=5.0)


def _require_display() -> None:
    """Raise BadRequest without a display: the viewer would hang."""
    import glfw

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        if not glfw.init():
            raise BadRequest("cannot open a window: there is no display")
