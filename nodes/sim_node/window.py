"""MuJoCo's own window on the world: look around; double click and Ctrl-drag take things with the mouse."""

from __future__ import annotations

import threading
import warnings

import mujoco

from nodes.sim_node.world import World
from schemas.errors import BadRequest


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
        self._viewer.sync()

    def close(self) -> None:
        """Close it, and wait until nothing draws any more: the process could not end before."""
        self._viewer.close()
        for thread in self._threads:
            thread.join(timeout=5.0)


def _require_display() -> None:
    """Ask first: without a display the viewer's thread dies and its caller waits for ever."""
    import glfw

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        if not glfw.init():
            raise BadRequest("no window can be opened here: there is no display")
