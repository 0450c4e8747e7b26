"""Commands that move bodies return after the commit, so that `undo` undoes the move."""

import asyncio

import pytest

from semmap import aio
from semmap.nodes import bus
from semmap.schemas import errors, keys
from semmap.schemas.scenes import Scene, SceneQuery
from tests.conftest import until
from tests.depth import tries

TIMES = tries(12)
PLACE = "(2, 1.2,"


@pytest.fixture(scope="module")
def system(robot_scene):
    with robot_scene.client() as client:
        client.move("robot1", at=(7.4, 2.0, 0.0), yaw=0.0)
        client.add("Fridge", "fridge9", at=(-3.0, -3.0, 0.0), wait=True)
        client.add("Chair", "chair9", at=(-3.0, 0.0, 0.0), wait=True)
        mine = ("robot1", "robot1_gripper", "fridge9", "chair9")
        until(lambda: client.status(names=mine).in_agreement, "map and scene agree")
        yield robot_scene
        client.remove("fridge9", "chair9")


@pytest.fixture
def client(system):
    with system.client() as client:
        client.pause(off=True)
        yield client
        client.pause(off=True)


def placed(client, name="chair9"):
    return client.get(name).pose.position_m


def height(client, name):
    bodies = bus.ask(client.session, keys.SIM, "snapshot", SceneQuery(), Scene).bodies
    return next(body.pose.position_m[2] for body in bodies if body.name == name)


def test_by_python_an_undo_takes_back_the_move_and_not_what_was_added_before(client):
    for turn in range(TIMES):
        added = client.add("Beer", f"beer{90 + turn}", at=(8.1, 2.3, 0.0), wait=True)
        before = placed(client)
        moved = client.move("chair9", (-2.0, 0.5 + turn % 2, 0.05))
        assert moved.commit is not None
        assert moved.commit > added.commit
        assert moved.text.startswith("moved chair9 to (-2, ")
        assert not moved.notes
        undone = client.undo()
        assert undone.text.startswith(f"undid commit {moved.commit}: moved chair9 from (-3, 0, 0")
        (pose,) = [change for change in undone.undone if change.kind == "pose"]
        assert (pose.name, pose.was.position_m) == ("chair9", before)
        assert placed(client) == before
        client.remove(f"beer{90 + turn}")


def test_on_the_command_line_an_undo_takes_back_the_move_and_not_what_was_added_before(system):
    for turn in range(TIMES):
        system.cli("add", "Beer", "beer80", "--at", "8.1", "2.3", "0", "--wait")
        wait = ("--wait",) if turn % 2 else ()
        moved = system.cli("move", "chair9", "--at", "-2", "1.5", "0.05", *wait)
        assert moved.startswith("moved chair9 to (-2, 1.5, ")
        assert "(commit " in moved
        number = moved.rpartition("(commit ")[2].rstrip(")\n")
        assert system.cli("undo").startswith(f"undid commit {number}: moved chair9 from (-3, 0, 0")
        system.cli("remove", "beer80")


def test_on_an_event_loop_too(system, client):
    async def session():
        async with aio.connect(system.endpoint) as own:
            moved = await own.move("chair9", (-2.0, 0.5, 0.05))
            return moved, await own.undo()

    moved, undone = asyncio.run(session())
    assert undone.text.startswith(f"undid commit {moved.commit}: moved chair9")


def test_doors_are_committed_when_the_reply_comes(client):
    opened = client.open("fridge9", to=0.5, joint="door")
    assert client.get("fridge9").joint_provenance.commit == opened.commit
    assert client.undo().text.startswith(f"undid commit {opened.commit}")
    client.open("fridge9", joint="door")
    closed = client.close("fridge9")
    assert client.history(limit=1)[-1].seq == closed.commit, closed


def test_a_robot_is_committed_where_it_was_driven_and_an_undo_takes_that_back(client):
    for turn in range(tries(6)):
        before = placed(client, "robot1")
        driven = client.drive("robot1", to=((7.4, 1.6 - 0.4 * (turn % 2)),))
        assert driven.text.startswith("robot1 is at (7.4")
        assert driven.commit is not None
        newest = client.history("robot1", limit=1)[-1]
        assert (newest.seq, newest.verb, newest.reason) == (driven.commit, "drive", "robot1 was driven")
        undone = client.undo()
        assert undone.text.startswith(f"undid commit {driven.commit}: moved robot1 from")
        assert placed(client, "robot1") == before


def test_who_does_not_wait_is_answered_at_once_and_an_undo_stops_the_move(client):
    before, commit = placed(client), client.status().commit
    client.pause()
    said = client.move("chair9", (-2.0, 0.5, 1.5), wait=False)
    assert (said.commit, said.text) == (None, "put chair9 at (-2, 0.5, 1.5) and released it")
    stopped = client.undo()
    assert (stopped.commit, stopped.names) == (None, ("chair9",))
    assert stopped.text == "stopped the move of chair9: it returns to its committed pose"
    client.pause(off=True)
    moved = client.move("chair9", before)
    assert moved.commit is None
    assert moved.notes == ("no commit: chair9 rests at its committed pose",)
    assert client.status().commit == commit


def test_a_move_in_paused_time_is_committed_when_time_runs_again(system, client):
    system.cli("pause")
    said = system.cli("move", "chair9", "--at", "-2", "0.5", "0.05")
    assert said.startswith("put chair9 at (-2, 0.5, 0.05)")
    assert "note: time is paused: the map is updated when it runs again" in said
    for words in (("open", "fridge9"), ("drive", "robot1", "--to", "7.4", "1.4")):
        assert "note: time is paused" in system.cli(*words)
    with client.commits(timeout=60.0) as commits:
        system.cli("pause", "--off")
        verbs = {"move", "open", "drive"}
        while verbs:
            verbs.discard(next(commits).verb)
    for _ in range(3):
        client.undo()
    assert placed(client) == pytest.approx((-3.0, 0.0, 0.0), abs=0.01)


def test_who_waits_while_time_is_paused_is_answered(system, client):
    async def session():
        async with aio.connect(system.endpoint) as own:
            driving = asyncio.create_task(own.drive("robot1", to=((7.4, -3.0),), speed=0.1))
            start = (await own.get("robot1")).pose.position_m
            while (await own.get("robot1")).live.pose.position_m[1] > start[1] - 0.1:
                await asyncio.sleep(0.02)
            await own.pause()
            return await driving, await own.undo(), await own.pause(off=True)

    driving, undone, _ = asyncio.run(session())
    assert driving.commit is None
    assert driving.notes[0].startswith("time is paused")
    assert undone.text.startswith("stopped the drive of robot1 at (7.4")
    client.drive("robot1", stop=True)


def test_what_is_removed_before_it_rests_is_said_in_one_sentence(system, client):
    async def session():
        async with aio.connect(system.endpoint) as own:
            await own.add("Beer", "beer70", at=(-4.0, -4.0, 0.0), wait=True)
            moving = asyncio.create_task(own.move("beer70", (-4.0, -4.0, 60.0)))
            while height(client, "beer70") < 1.0:
                await asyncio.sleep(0.02)
            await own.remove("beer70")
            return await asyncio.gather(moving, return_exceptions=True)

    (error,) = asyncio.run(session())
    assert isinstance(error, errors.Refused)
    assert error.text == "beer70 was removed before it came to rest"
