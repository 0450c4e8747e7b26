"""MuJoCo's window in a whole system: mouse actions on a virtual display change the map."""

import os
import shutil
import subprocess
import time

import pytest

from semmap.schemas.entities import distance_m
from tests.conftest import running, until

START = (5.0, 4.0, 0.0)
"""The middle of the empty world, at which the window looks first."""


@pytest.fixture
def display(monkeypatch):
    """An X server without a screen."""
    for program in ("Xvfb", "xdotool"):
        if shutil.which(program) is None:
            pytest.skip(f"needs {program} (apt-get install xvfb xdotool)")
    reading, writing = os.pipe()
    command = ["Xvfb", "-displayfd", str(writing), "-screen", "0", "1280x960x24", "-nolisten", "tcp"]
    with subprocess.Popen(
        command, pass_fds=[writing], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    ) as server:
        try:
            os.close(writing)
            with os.fdopen(reading) as said:
                number = said.readline().strip()
            if not number:
                pytest.skip("no X server can be started here")
            monkeypatch.setenv("DISPLAY", f":{number}")
            yield
        finally:
            server.terminate()


def mouse(*words: object) -> str:
    return subprocess.run(
        ["xdotool", *map(str, words)], capture_output=True, text=True, timeout=20.0, check=False
    ).stdout


def window_middle() -> tuple[int, int]:
    window = until(lambda: mouse("search", "--name", "MuJoCo"), "the window is there").split()[0]
    shape = dict(line.split("=") for line in mouse("getwindowgeometry", "--shell", window).split())
    return int(shape["X"]) + int(shape["WIDTH"]) // 2, int(shape["Y"]) + int(shape["HEIGHT"]) // 2


def drag(right_px: int) -> None:
    """Double click takes what is in the middle; Ctrl, Shift and the right button pull it over the floor."""
    x, y = window_middle()
    mouse("mousemove", x, y)
    mouse("click", "--repeat", 2, "--delay", 80, 1)
    time.sleep(0.3)
    mouse("keydown", "ctrl", "keydown", "shift", "mousedown", 3)
    for _ in range(20):
        mouse("mousemove_relative", right_px // 20, 0)
        time.sleep(0.05)
    mouse("mouseup", 3, "keyup", "shift", "keyup", "ctrl")


def test_what_the_mouse_pulls_in_the_window_the_map_follows(display, tmp_path):
    words = ("--window", "--world", "empty", "--abox", "none", "--no-record")
    with running(tmp_path, *words) as system, system.client() as client:
        client.add("Box", "box1", at=START, size=(1.0, 1.0, 1.0), wait=True)
        before = client.get("box1")

        def pulled():
            drag(240)
            now = client.get("box1")
            return now if distance_m(now.pose, before.pose) > 0.3 else None

        after = until(pulled, "the map follows the mouse")
        assert after.pose_provenance.source == "scene"
        assert after.pose.position_m[0] > before.pose.position_m[0] + 0.3  # the window looks north
        until(lambda: client.status(names=("box1",)).in_agreement, "map and scene agree on the box")
