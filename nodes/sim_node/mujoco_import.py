"""Imports MuJoCo without the libraries for its windows and its own rendering."""

from __future__ import annotations

import importlib
import os
from typing import Final

_BACKEND: Final = "MUJOCO_GL"


def import_mujoco() -> None:
    """Import MuJoCo without its OpenGL backend.

    The backend loads GLFW, which starts another Python interpreter to find out its version. That takes more
    than half of the time to import MuJoCo. `vision/offscreen.py` opens OpenGL itself, and `window.py` imports
    GLFW when it opens a window.
    """
    chosen = os.environ.get(_BACKEND)
    os.environ[_BACKEND] = "disabled"
    try:
        importlib.import_module("mujoco")
    finally:
        if chosen is None:
            del os.environ[_BACKEND]
        else:
            os.environ[_BACKEND] = chosen
