"""Where the scene is the truth, bodies become entities, and stand as before after a restart.

The simulator is killed, and then the whole system is stopped and started again.
"""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest

from semmap.nodes import bus
from semmap.schemas import errors, keys
from semmap.schemas.entities import Pose
from semmap.schemas.scenes import BodyOrder, Scene, SceneQuery, Spawn, Spawned
from tests.conftest import running, until

ROBOT = ("robot1", "robot1_gripper")

WORDS = (
    "--no-record",
    "--abox",
    "none",
    "--truth",
    "scene",
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


WORLD = """<mujoco><custom><text name="semmap:mug" data="Cup"/><text name="semmap:seat" data="Seat"/>
<text name="semmap:stool_9" data="Stool"/></custom>
<worldbody><geom type="plane" size="5 5 .1"/>
<body name="cup 1" pos="-2 0 .05"><freejoint/><geom type="cylinder" size=".04 .05"/></body>
<body name="cabinet_1" pos="-2 -2 0"><geom type="box" size=".3 .3 .4" pos="0 0 .4"/>
 <body name="door" pos=".32 .3 .4"><joint name="hinge" axis="0 0 -1" range="-90 0" damping="1"/>
  <geom type="box" size=".01 .3 .4" pos="0 -.3 0"/></body></body>
<body name="chair_3" pos="3 3 .25"><freejoint/><geom type="box" size=".2 .2 .25" mass="5"/>
 <body name="seat"><geom type="box" size=".1 .1 .01" mass=".1"/></body></body>
<body name="mug" pos="3 -1 .05"><freejoint/><geom type="cylinder" size=".04 .05" mass=".2"/></body>
<body name="gizmo_1" pos="-3 1 .05"><freejoint/><geom type="box" size=".05 .05 .05" mass=".2"/></body>
</worldbody></mujoco>"""
CLASSES = {
    "cup_1": "Cup", "cabinet_1": "Cabinet", "chair_3": "Chair", "seat": "Seat", "mug": "Cup",
    "gizmo_1": "Object",
}  # fmt: skip


def require_entities(system, client) -> None:
    """Require that the bodies of the world are entities, and so are those that are created later."""

    def classes():
        return {entity.name: entity.class_ for entity in client.list() if entity.name not in ROBOT}

    until(lambda: {*ROBOT} <= {entity.name for entity in client.list()}, "the robot")
    until(lambda: classes() == CLASSES, "bodies become entities")
    assert client.get("seat").properties["isDirectPartOf"] == "chair_3"
    assert client.get("mug").provenance.source == "scene"
    until(
        lambda: {client.get(name, where=True).shape for name in CLASSES} == {"world"},
        "bodies have their own shapes",
    )
    unknown = "unknown class of 1 body of the world: gizmo_1; name the classes in a JSON file"
    assert any(unknown in line for line in system.said)
    assert any(unknown in note for node in client.status().nodes for note in node.notes)
    ignored = "declared but ignored: stool_9 (no such body)"
    assert any(ignored in line for line in system.said)
    assert any(ignored in node.detail for node in client.status().nodes)
    order = BodyOrder(
        name="cup_2", class_="Cup", model="cup", pose=Pose(position_m=(2.0, -3.0, 0.0)), commit=0
    )
    bus.ask(client.session, keys.SIM, "spawn", Spawn(bodies=(order,)), Spawned)
    until(lambda: classes() == CLASSES | {"cup_2": "Cup"}, "the cup follows")
    client.remove("cup_2")


def furniture(client) -> list[float]:
    """Return where the cup stands and how far the cabinet is open, in the scene."""
    scene = bus.ask(client.session, keys.SIM, "snapshot", SceneQuery(), Scene)
    there = {body.name: body for body in scene.bodies}
    return [*there["cup_1"].pose.position_m[:2], there["cabinet_1"].joints[0].position]


# Where a robot is placed is decided in the same way for each truth: see `test_reconcile_robots.py`.
def test_bodies_become_entities_and_stand_as_before_after_a_restart(tmp_path):
    (tmp_path / "world.xml").write_text(WORLD)
    words = (*WORDS, "--world", str(tmp_path / "world.xml"))
    with running(tmp_path, *words) as system, system.client() as client:
        assert not any("last committed position" in line for line in system.said)
        require_entities(system, client)
        client.drive("robot1", to=((1.6, 0.8),), yaw=1.0, wait=True)
        until(lambda: abs(client.get("robot1").pose.position_m[1] - 0.8) < 0.05, "the commit")
        agree(client)
        stood = [client.get(name).pose for name in ROBOT]
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
        assert furniture(client) == pytest.approx(furnished, abs=0.01)
        assert client.status().commit == seq
        pids = [node.pid for node in client.status().nodes]
        system.stop()
        assert system.process.returncode == 0
    assert not any(Path(f"/proc/{pid}").exists() for pid in pids)
    with running(tmp_path, *words) as system, system.client() as client:
        until(lambda: where(client) == pytest.approx(stood[0].position_m[:2], abs=0.02), "where it stood")
        agree(client)
        assert [client.get(name).pose for name in ROBOT] == stood
        assert furniture(client) == pytest.approx(furnished, abs=0.01)
        assert commits(client) == committed
        (said,) = [line for line in system.said if "last committed position" in line]
        assert said.startswith("robot1 ")
        assert said.rstrip().endswith("not at --robot-at; to move it: semmap move robot1 --at 1 0 0")
