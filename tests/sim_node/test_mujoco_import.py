"""MuJoCo is imported without GLFW, and renders as before."""

import os
import subprocess
import sys

import pytest

_CODE = """
import os, sys
from semmap.nodes.sim_node.mujoco_import import import_mujoco
before = os.environ.get("MUJOCO_GL")
import_mujoco()
assert os.environ.get("MUJOCO_GL") == before, os.environ.get("MUJOCO_GL")
import mujoco
mujoco.MjModel.from_xml_string("<mujoco/>")
print("glfw" in sys.modules)
"""


@pytest.mark.parametrize("backend", [None, "egl"])
def test_mujoco_is_imported_without_glfw_and_the_chosen_backend_stays(backend):
    environment = {name: value for name, value in os.environ.items() if name != "MUJOCO_GL"}
    environment |= {"MUJOCO_GL": backend} if backend else {}
    printed = subprocess.check_output([sys.executable, "-c", _CODE], text=True, env=environment)
    assert printed == "False\n"
