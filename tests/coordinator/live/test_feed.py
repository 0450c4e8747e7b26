"""Live poses in a whole system: published by a program, returned by get, list and status."""

from __future__ import annotations

import os
import signal
from datetime import datetime

import pytest

from semmap.schemas import errors, keys
from semmap.schemas.entities import orientation_from_yaw
from tests.conftest import until


@pytest.fixture(scope="module")
def system(flat_scene):
    return flat_scene


def test_a_robot_is_tracked_while_it_drives_and_committed_where_it_stops(system):
    with system.client() as client:
        client.add("Robot", "robot1", at=(7.0, 2.0, 0.0))
        assert "tracked from a stream" in client.track("robot1").text

        def drive(x: float) -> bool:
            client.publish_pose("robot1", (x, 2.0, 0.0), yaw=0.5)
            live = client.get("robot1").live
            return live is not None and live.pose.position_m[0] == x

        for i in range(20):
            until(lambda i=i: drive(7.0 + 0.05 * i), "the pose that was published")
        entity = client.get("robot1")
        assert entity.live.source == "stream"
        assert entity.live.pose.orientation_wxyz == pytest.approx(orientation_from_yaw(0.5), abs=1e-5)
        near = until(
            lambda: [e.name for e in client.list(near="robot1", within=0.6)], "an entity near it, live"
        )
        assert near
        until(lambda: client.get("robot1").pose.position_m[0] == 7.95, "the commit of where it stopped")
        last = next(commit for commit in client.history() if (commit.reason or "").startswith("robot1"))
        assert (last.source, last.reason) == ("perception", "robot1 stopped")
        trail = client.trail("robot1", in_="kitchen1")
        assert [visit.place for visit in trail.visits] == ["kitchen1"]
        assert [point.name for point in trail.track][-1:] == ["robot1"]
        assert client.when("robot1", "isLocatedIn", "kitchen1").visits == trail.visits
        assert " m in dining_corner1, kitchen1 and flat1" in client.last_seen("robot1").text
        then = datetime.fromtimestamp(trail.track[-1].ns / 1e9)
        assert "robot1 was at (7." in system.cli("trail", "robot1", "--at", f"{then:%Y-%m-%dT%H:%M:%S}")
        assert "kitchen1" in system.cli("trail", "Robot", "--in", "kitchen1")
        assert "no live poses of chair1 are stored" in system.cli("trail", "chair1", status=1)
        assert "robot1 was never in bathroom1 (" in client.trail("robot1", in_="bathroom1").text


def test_a_silent_stream_is_reported_as_stale(system):
    with system.client() as client:
        client.add("Robot", "robot2", at=(1.0, 4.0, 0.0), track="stream")
        assert any("no live pose has been received yet" in problem for problem in client.status().problems)
        client.publish_pose("robot2", (1.0, 4.5, 0.0))
        until(lambda: client.get("robot2").live, "the pose")
        until(lambda: client.get("robot2").live.stale, "that it is stale")
        assert any(
            problem.startswith("robot2: its live pose is stale") for problem in client.status().problems
        )
        assert "(stale)" in system.cli("get", "robot2")


def test_invalid_live_poses_are_reported(system):
    with system.client() as client:
        client.add("Robot", "robot3", at=(7.0, 3.0, 0.0), track="stream")
        for key, payload in (
            ("semmap/live/unknown1", b'{"at": [1, 2, 0]}'),
            ("semmap/live/fridge1", b'{"at": [1, 2, 0]}'),
            ("semmap/live/robot3", b'{"at": [1, NaN, 0]}'),
            ("semmap/live/robot3", b"\xc1"),
        ):
            client.session.put(key, payload)

        def ignored() -> list[str]:
            return [problem for problem in client.status().problems if "ignored" in problem]

        until(lambda: len(ignored()) == 3, "three that are ignored")
        said = ignored()
        assert any("no entity is named 'unknown1'" in problem for problem in said)
        assert any("fridge1 is not tracked" in problem for problem in said)
        with pytest.raises(errors.BadRequest, match="yaw or orientation"):
            client.publish_pose("robot3", (1.0, 2.0, 0.0), yaw=1.0, orientation=(1.0, 0.0, 0.0, 0.0))


def test_tracking_survives_the_coordinator(system):
    with system.client() as client:
        client.add("Robot", "robot4", at=(7.0, 4.0, 0.0), track="stream")
    pid = system.pid("coordinator")
    os.kill(pid, signal.SIGKILL)

    def drive() -> bool:
        try:
            with system.client() as client:
                client.publish_pose("robot4", (8.5, 4.0, 0.0))
                live = client.get("robot4").live
                return live is not None and live.pose.position_m[0] == 8.5
        except errors.NoAnswer:
            return False

    until(drive, "the pose, after a restart")
    assert system.pid("coordinator") != pid


def test_the_simulator_provides_the_pose_of_a_body(system):
    with system.client() as client:
        client.add("Ball", "ball1", at=(2.0, 2.0, 1.5), track="sim")
        live = until(lambda: client.get("ball1").live, "the simulator's pose")
        assert live.source == "sim"
        until(lambda: client.get("ball1").pose.position_m[2] < 1.0, "that it has fallen and rests")


def test_tracking_on_the_command_line(system):
    assert "unchanged: fridge1 is not tracked" in system.cli("track", "fridge1", "--off")
    assert "is a place" in system.cli("track", "kitchen1", status=1)
    assert "no entity is named" in system.cli("track", "unknown1", status=1)
    system.cli("add", "Robot", "robot5", "--at", "7", "5", "0", "--track", "stream")
    system.cli("track", "robot5", "--from", "lidar", status=2)
    assert "would be" in system.cli("track", "fridge1", "--dry-run")
    assert "no longer tracked" in system.cli("track", "robot5", "--off")
    assert "semmap track robot5" in system.cli("set", "robot5", "trackedFrom", "sim", status=2)


def test_all_live_poses_are_published_together(system):
    heard = []
    with system.client() as client:
        subscriber = client.session.declare_subscriber(keys.LIVE_POSES.key, heard.append)
        client.add("Robot", "robot6", at=(1.0, 5.0, 0.0), track="stream")
        client.publish_pose("robot6", (1.0, 5.5, 0.0))
        until(lambda: heard, "where all are")
        subscriber.undeclare()
