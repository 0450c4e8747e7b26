"""MuJoCo's interactive viewer: look around; double click selects a body, Ctrl-drag moves it."""

from __future__ import annotations

import threading
import warnings

import mujoco
import numpy as np

from semmap.nodes.sim_node.world import World
from semmap.schemas.errors import BadRequest

_LABEL_M = 0.3
_LABEL_LENGTH = 99  # what MuJoCo has room for


class Window:
    """Open until closed. What the mouse does becomes forces in the world's data."""

    def __init__(self, world: World) -> None:
        """Raises BadRequest where there is no display."""
        _require_display()
        from mujoco import viewer  # loads GLFW, which only those need who have a display

        self._world = world
        self._shown = world.model
        before = set(threading.enumerate())
        self._viewer = viewer.launch_passive(world.model, world.data, show_left_ui=False, show_right_ui=False)
        self._threads = set(threading.enumerate()) - before
        with self._viewer.lock():
            mujoco.mjv_defaultFreeCamera(world.model, self._viewer.cam)

    def refresh(self) -> None:
        """Show the world as it is now, and take over what the mouse does."""
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
        """Write its name above the selected body: names in the model are those of its compilation."""
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
        """Close it, and wait until the last frame is drawn; the process cannot end before."""
        self._viewer.close()
        for thread in self._threads:
            thread.join(timeout=5.0)


def _require_display() -> None:
    """Ask first: without a display the viewer's thread dies and its caller waits for ever."""
    import glfw

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        if not glfw.init():
            raise BadRequest("cannot open a window: there is no display")
