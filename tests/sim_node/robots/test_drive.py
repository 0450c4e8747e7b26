"""A robot in a complete system: it becomes an entity, is tracked, drives, and is committed where it stops."""

from __future__ import annotations

import re

import pytest

from semmap.schemas import errors
from tests.conftest import until


# What the truth changes is decided in `test_reconcile.py` and `test_agreement.py`.
@pytest.fixture(scope="module")
def system(robot_scene):
    with robot_scene.client() as client:
        client.move("robot1", at=(7.4, 2.0, 0.0), yaw=0.0)
        client.add("Fridge", "fridge7", at=(7.0, -1.0, 0.0), wait=True)
        yield robot_scene
        client.remove("fridge7")


def test_it_drives_live_and_is_committed_where_it_stops(system):
    with system.client() as client:
        robot = until(lambda: (e := client.get("robot1")).live and e, "where it is, live")
        assert (robot.class_, robot.tracked, robot.live.source) == ("Robot", "sim", "sim")
        until(lambda: client.status(names=("robot1",)).in_agreement, "map and scene agree on it")
        before = {commit.seq for commit in client.history("robot1")}
        to = ((7.4, 2.0), (7.0, 1.2))  # at this speed it is on its way for many seconds
        said = client.drive("robot1", to=to, yaw=0.0, speed=0.1, wait=False).text
        assert "on its way" in said
        moving = re.compile(r"robot1 is moving: [\d.]+ m from its committed pose")  # it turns first
        status = until(
            lambda: any(map(moving.fullmatch, (now := client.status(names=("robot1",))).displaced)) and now,
            "that it is on its way",
        )
        assert status.in_agreement is False
        assert not any("moving" in problem for problem in status.problems)
        driven = client.drive("robot1", to=((7.0, 1.0),), yaw=0.0)
        assert "is at (7.0" in driven.text
        assert client.get("robot1").pose.position_m[1] == pytest.approx(1.0, abs=0.03)
        assert driven.commit in {commit.seq for commit in client.history("robot1")} - before
        until(lambda: not client.status(names=("robot1",)).displaced, "it is no longer displaced")


def test_what_cannot_be_driven_there_is_said(system):
    with system.client() as client:
        with pytest.raises(errors.BadRequest, match="--to X Y"):
            client.drive("robot1")
        with pytest.raises(errors.BadRequest, match="--to X Y"):
            client.drive("robot1", to=((1.0, 1.0),), stop=True)
        with pytest.raises(errors.UnknownName):
            client.drive("nobody1", to=((1.0, 1.0),))
        with pytest.raises(errors.Refused, match="is blocked at"):
            client.drive("robot1", to=((7.0, -3.0),))
        assert "stopped at" in client.drive("robot1", stop=True).text


def test_the_command_line_drives(system):
    said = system.cli("drive", "robot1", "--to", "7", "1", "--yaw", "90deg")
    found = re.fullmatch(r"robot1 is at \((.*), (.*)\), facing (.*)° \(commit \d+\)\n", said)
    assert [float(number) for number in found.groups()] == pytest.approx([7.0, 1.0, 90.0], abs=2.0)
    system.cli("drive", "robot1", "--to", "7", status=2)
