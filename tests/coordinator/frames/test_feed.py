"""Frames in a whole system: publications, `frames`, and positions in frames."""

from __future__ import annotations

import contextlib
import json
import math
import threading

import pytest

from semmap.schemas import errors
from tests.conftest import PATIENCE_S, until


@pytest.fixture(scope="module")
def system(flat_map):
    return flat_map


@contextlib.contextmanager
def repeated(publish):
    """Publish repeatedly on another thread, so that nothing becomes stale."""
    done = threading.Event()

    def repeat():
        publish()
        while not done.wait(0.1):
            publish()

    thread = threading.Thread(target=repeat)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join(PATIENCE_S)


def test_positions_in_the_frame_of_a_robot_that_is_tracked(system):
    with system.client() as client, system.client() as robot:
        client.add("Robot", "robot1", at=(0.0, 0.0, 0.0), track="stream")
        with pytest.raises(errors.Refused, match="robot1 is tracked, but its current pose is unknown"):
            client.add("Cup", at=(1.0, 0.0, 0.0), frame="robot1")

        def publish() -> None:
            robot.publish_pose("robot1", (2.0, 1.0, 0.0), yaw=math.pi / 2)
            robot.publish_frame("robot1/lidar", "robot1", at=(0.5, 0.0, 0.25))

        def there() -> bool:
            frames = [frame for frame in client.frames() if frame.name == "robot1/lidar"]
            return bool(frames) and frames[0].map_pose is not None

        with repeated(publish):
            until(there, "the robot's frames")
            client.add("Cup", "held1", at=(1.0, 0.0, 0.5), frame="robot1/lidar")
            assert client.get("held1").pose.position_m == (2.0, 2.5, 0.75)
            client.update("held1", at=(1.0, 0.0, 0.0), yaw=0.0, frame="robot1")
            held = client.get("held1")
            assert held.pose.position_m == (2.0, 2.0, 0.0)
            assert held.pose.yaw_rad == pytest.approx(math.pi / 2, abs=1e-5)
            seen = client.get("held1", frame="robot1/lidar")
            assert seen.frame == "robot1/lidar"
            assert seen.pose.position_m == pytest.approx((0.5, 0.0, -0.25), abs=1e-5)
            near = client.list("Cup", near="1,0,0", within=0.5, frame="robot1")
            assert [cup.name for cup in near] == ["held1"]
            assert near[0].pose.position_m == pytest.approx((1.0, 0.0, 0.0), abs=1e-5)
            (nearest,) = client.list("Cup", nearest=1, to="2,2,0")
            assert (nearest.name, nearest.pose.position_m) == ("held1", (2.0, 2.0, 0.0))
            assert "pose in robot1" in system.cli("get", "held1", "--frame", "robot1")
            told = json.loads(system.cli("frames", "robot1", "--format", "json"))
            assert [frame["name"] for frame in told] == ["map", "robot1", "robot1/lidar"]
            assert "robot1/lidar" in system.cli("frames")


def test_a_stale_frame_is_rejected_and_reported(system):
    with system.client() as client:
        client.publish_frame("beacon", "map", at=(1.0, 1.0, 0.0))
        until(lambda: "beacon" in [f.name for f in client.frames()], "the frame")
        until(lambda: client.frames("beacon")[-1].stale, "that it is stale")
        with pytest.raises(errors.Refused, match="the frame beacon is stale: no message on"):
            client.add("Cup", at=(1.0, 0.0, 0.0), frame="beacon")
        assert any("beacon is stale" in problem for problem in client.status().problems)


def test_cycles_and_unknown_frames_are_rejected_with_a_reason(system):
    with system.client() as client:
        client.publish_frame("dock", "map", at=(5.0, 0.0, 0.0), fixed=True)
        until(lambda: "dock" in [f.name for f in client.frames()], "the frame")
        client.publish_frame("hook", "dock", fixed=True)
        until(lambda: "hook" in [f.name for f in client.frames()], "the other frame")
        client.publish_frame("dock", "hook", fixed=True)
        until(
            lambda: [p for p in client.status().problems if "form a cycle: dock in hook in dock" in p],
            "that it is a cycle",
        )
        assert client.get("fridge1", frame="dock").pose is not None
        with pytest.raises(errors.UnknownName, match=r"unknown frame 'dok'.*did you mean dock"):
            client.get("fridge1", frame="dok")
        with pytest.raises(errors.BadRequest, match="--near with a position requires a distance"):
            client.list(near="1,2,0")
        client.withdraw_frame("hook")
        client.withdraw_frame("dock")
        until(lambda: {"dock", "hook"}.isdisjoint(f.name for f in client.frames()), "that they are gone")


def test_a_change_that_comes_again_is_done_once_though_its_frame_is_gone(system):
    with system.client() as client:
        client.publish_frame("belt", "map", at=(3.0, 0.0, 0.0), fixed=True)
        until(lambda: "belt" in [f.name for f in client.frames()], "the frame")
        first = client.add("Cup", at=(1.0, 0.0, 0.0), frame="belt", id="once-only")
        client.withdraw_frame("belt")
        until(lambda: "belt" not in [f.name for f in client.frames()], "that it is gone")
        again = client.add("Cup", at=(1.0, 0.0, 0.0), frame="belt", id="once-only")
        assert again.commit == first.commit
        with pytest.raises(errors.UnknownName):
            client.add("Cup", at=(1.0, 0.0, 0.0), frame="belt", id="another")
