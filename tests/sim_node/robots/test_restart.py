"""A robot is where it last stood when the simulator comes back, or the whole system does."""

from __future__ import annotations

import os
import signal

import pytest

from tests.conftest import running, until

WORDS = (
    "--no-record",
    "--abox",
    "none",
    "--world",
    "empty",
    "--robot",
    "porter",
    "--robot-at",
    "1",
    "0",
    "0",
)


def where(client) -> tuple[float, float] | None:
    """Where its body is just now."""
    live = client.get("robot1").live
    return None if live is None or live.stale else live.pose.position_m[:2]


@pytest.mark.parametrize("truth", ["map", "scene"])
def test_it_begins_where_it_last_stood(tmp_path, truth):
    words = (*WORDS, "--truth", truth)
    with running(tmp_path, *words) as system, system.client() as client:
        assert not any("last stood" in line for line in system.said)
        until(lambda: {"robot1", "robot1_gripper"} <= {e.name for e in client.list()}, "the robot")
        client.drive("robot1", to=((1.6, 0.8),), yaw=1.0, wait=True)
        until(lambda: abs(client.get("robot1").pose.position_m[1] - 0.8) < 0.05, "the commit")
        until(lambda: client.status().in_agreement, "that all is followed")
        stood, commit = client.get("robot1").pose, client.status().commit
        killed = system.pid("sim_node")
        os.kill(killed, signal.SIGKILL)
        until(lambda: system.pid("sim_node") != killed, "another simulator")
        until(lambda: client.status().in_agreement, "that the robot is back")
        until(lambda: where(client) == pytest.approx(stood.position_m[:2], abs=0.02), "where it stood")
        assert client.status().commit == commit
        system.stop()
    with running(tmp_path, *words) as system, system.client() as client:
        until(lambda: client.status().in_agreement, "that the robot is back")
        until(lambda: where(client) == pytest.approx(stood.position_m[:2], abs=0.02), "where it stood")
        assert client.get("robot1").pose == stood
        assert client.status().commit == commit
        (said,) = [line for line in system.said if "last stood" in line]
        assert said.startswith("robot1 ")
        assert said.rstrip().endswith("not at --robot-at; to put it there: semmap move robot1 --at 1 0 0")
