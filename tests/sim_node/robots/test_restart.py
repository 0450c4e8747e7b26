"""A robot is at its last pose after a restart of the simulator, or of the whole system."""

from __future__ import annotations

import os
import signal

import pytest

from semmap.nodes import bus
from semmap.schemas import errors, keys
from semmap.schemas.scenes import Scene, SceneQuery
from tests.conftest import running, until

ROBOT = ("robot1", "robot1_gripper")

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
    """Return the current pose of its body."""
    live = client.get("robot1").live
    return None if live is None or live.stale else live.pose.position_m[:2]


def run_of(client) -> str:
    """Return the run of the simulator; "" while there is none."""
    try:
        return bus.ask(client.session, keys.SIM, "snapshot", SceneQuery(), Scene).run
    except errors.NoAnswer:
        return ""


def agree(client) -> None:
    """Wait until robot and gripper rest at their poses in the map."""
    until(lambda: client.status(names=ROBOT).in_agreement, "map and scene agree on the robot")


def commits(client) -> list[tuple[int, str]]:
    """Return the commits on the robot and its gripper, in order."""
    found = {commit.seq: commit.reason for name in ROBOT for commit in client.history(name)}
    return sorted(found.items())


FURNISHED = """<mujoco><worldbody><geom type="plane" size="5 5 .1"/>
<body name="cup 1" pos="-2 0 .05"><freejoint/><geom type="cylinder" size=".04 .05"/></body>
<body name="cabinet_1" pos="-2 -2 0"><geom type="box" size=".3 .3 .4" pos="0 0 .4"/>
 <body name="door" pos=".32 .3 .4"><joint name="hinge" axis="0 0 -1" range="-90 0" damping="1"/>
  <geom type="box" size=".01 .3 .4" pos="0 -.3 0"/></body></body>
</worldbody></mujoco>"""


def furniture(client) -> list[float]:
    """Return where the cup stands and how far the cabinet is open, in the scene."""
    scene = bus.ask(client.session, keys.SIM, "snapshot", SceneQuery(), Scene)
    there = {body.name: body for body in scene.bodies}
    return [*there["cup_1"].pose.position_m[:2], there["cabinet_1"].joints[0].position]


# Where a robot is placed is decided in the same way for each truth: see `test_reconcile_robots.py`.
@pytest.mark.parametrize("truth", [pytest.param("map", marks=pytest.mark.long), "scene"])
def test_it_begins_where_it_last_stood(tmp_path, truth):
    (tmp_path / "world.xml").write_text(FURNISHED)
    world = ("--world", str(tmp_path / "world.xml")) if truth == "scene" else ()
    words = (*WORDS, "--truth", truth, *world)
    with running(tmp_path, *words) as system, system.client() as client:
        assert not any("last committed position" in line for line in system.said)
        until(lambda: {*ROBOT} <= {e.name for e in client.list()}, "the robot")
        client.drive("robot1", to=((1.6, 0.8),), yaw=1.0, wait=True)
        until(lambda: abs(client.get("robot1").pose.position_m[1] - 0.8) < 0.05, "the commit")
        agree(client)
        stood = [client.get(name).pose for name in ROBOT]
        furnished: list[float] = []
        if truth == "scene":
            client.move("cup_1", (-1.0, 1.0, 0.0))
            client.open("cabinet_1", wait=True)
            until(lambda: client.status(names=("cup_1", "cabinet_1")).in_agreement, "the map follows")
            furnished = furniture(client)
            assert furnished[:2] == pytest.approx([-1.0, 1.0], abs=0.02)
            assert abs(furnished[2]) > 1.0
        seq = client.status().commit
        committed = commits(client)
        assert [reason for _, reason in committed[:2]] == [f"{name} stands in the scene" for name in ROBOT]
        before = run_of(client)
        killed = system.pid("sim_node")
        os.kill(killed, signal.SIGKILL)
        until(lambda: system.pid("sim_node") != killed, "another simulator")
        until(lambda: run_of(client) not in ("", before), "its scene")
        until(lambda: where(client) == pytest.approx(stood[0].position_m[:2], abs=0.02), "where it stood")
        agree(client)
        assert commits(client) == committed
        assert not furnished or furniture(client) == pytest.approx(furnished, abs=0.01)
        assert client.status().commit == seq
        system.stop()
    with running(tmp_path, *words) as system, system.client() as client:
        until(lambda: where(client) == pytest.approx(stood[0].position_m[:2], abs=0.02), "where it stood")
        agree(client)
        assert [client.get(name).pose for name in ROBOT] == stood
        assert not furnished or furniture(client) == pytest.approx(furnished, abs=0.01)
        assert commits(client) == committed
        (said,) = [line for line in system.said if "last committed position" in line]
        assert said.startswith("robot1 ")
        assert said.rstrip().endswith("not at --robot-at; to move it: semmap move robot1 --at 1 0 0")
