"""Attachments in a whole system: commands, manual moves and the map agree."""

import contextlib
import os
import re
import signal

import pytest

from semmap.nodes import bus
from semmap.schemas import errors, keys
from semmap.schemas.attachments import grip_of, holder_of
from semmap.schemas.entities import compose, distance_m
from semmap.schemas.scenes import Grip, GripOrder, Gripped, Scene, SceneQuery
from tests.conftest import until

HOME = (-2.0, 0.0, 0.0)
TABLE, TRAY, CUP = (0.0, 0.0, 0.0), (3.0, 0.0, 0.0), (0.0, 0.0, 0.8)


@pytest.fixture(scope="module")
def system(robot_scene):
    """A system with a robot in a corner of the kitchen; the other things are put where they are each time."""
    with robot_scene.client() as client:
        client.move("robot1", at=HOME, yaw=0.0)
        client.add("Kitchen", "kitchen1", at=(0.0, 0.0, 0.0), size=(20.0, 20.0, 3.0))
        yield robot_scene
        client.remove("kitchen1")


@pytest.fixture
def client(system):
    """A client of a map with a cup on a table, a tray beside it, and nothing attached."""
    with system.client() as client:
        yield from laid(client, table1=("Table", TABLE), tray1=("Tray", TRAY), cup1=("Cup", CUP))


@pytest.fixture
def held(system):
    """The same with the cup attached to the tray."""
    with system.client() as client:
        for _ in laid(client, table1=("Table", TABLE), tray1=("Tray", TRAY), cup1=("Cup", (3.0, 0.0, 0.5))):
            client.attach("cup1", to="tray1", force=True)
            agree(client, "cup1", "tray1")
            yield client


def laid(client, **things):
    """A client while these things are there, each of a class at a place; they are removed afterwards."""
    for name, (class_, at) in things.items():
        client.add(class_, name, at=at, wait=True)
    agree(client, *things)
    try:
        yield client
    finally:
        for name in reversed(things):  # what is attached before what it is attached to
            for other in {e.name for e in client.list()} & {*things}:
                if holder_of(client.get(other)):
                    client.detach(other)
            client.remove(name)
        until(lambda: {*things}.isdisjoint(bodies_of(client) or things), "their bodies are gone")


def bodies_of(client):
    """The names of the bodies, among them the robot's; none while there is no simulator."""
    return {body.name for body in scene_of(client).bodies}


def scene_of(client):
    """The scene; an empty one of no run while there is no simulator."""
    try:
        return bus.ask(client.session, keys.SIM, "snapshot", SceneQuery(), Scene)
    except errors.NoAnswer:
        return Scene(run="", version=0, stamp_ns=0, sim_time_s=0.0, world="", bodies=())


def agree(client, *names):
    """Wait until map and scene agree on these, whatever else moves."""
    until(lambda: client.status(names=names).in_agreement, f"map and scene agree on {', '.join(names)}")


@contextlib.contextmanager
def paused(client):
    client.pause()
    try:
        yield
    finally:
        client.pause(off=True)


def live_off_m(client):
    """How far the cup's live pose is from where its holder has it."""
    cup, tray = client.get("cup1"), client.get("tray1")
    return distance_m(cup.live.pose, compose(tray.pose, grip_of(cup)))


def test_it_is_taken_carried_and_put(client):
    assert [e.name for e in client.list(on="table1")] == ["cup1"]
    reply = client.attach("cup1", to="tray1", force=True)
    at = re.match(r"cup1 is attached to tray1, at \((.*?), (.*?), (.*?)\)", reply.text)
    x, y, z = map(float, at.groups())
    assert (x, y) == pytest.approx((-3.0, 0.0), abs=0.005)
    assert z == pytest.approx(0.78, abs=0.05)  # the table is 0.75 m high, and the cup falls onto it
    cup = client.get("cup1", where=True)
    assert holder_of(cup) == "tray1"
    assert client.list(on="table1") == ()
    assert [e.name for e in client.list(in_="kitchen1", class_="Cup")] == ["cup1"]
    assert "kitchen1" in client.sparql("SELECT ?x { :cup1 dm:isLocatedIn ?x }", inferred=True).rows[0][0]
    agree(client, "cup1", "tray1")
    attached, moved = reply.commit, len(client.history("cup1"))
    client.move("tray1", at=(3.0, 2.0, 0.0))
    until(lambda: client.get("tray1").pose.position_m[1] > 1.9, "the map follows the tray")
    agree(client, "cup1", "tray1")
    assert len(client.history("cup1")) == moved  # the tray's move does not commit the cup
    until(lambda: live_off_m(client) < 0.02, "the cup is where the tray takes it")
    assert client.get("cup1").live.pose.position_m[1] == pytest.approx(2.0, abs=0.02)
    assert client.get("cup1").pose.position_m[1] == pytest.approx(0.0, abs=0.02)
    detached = client.detach("cup1")
    assert "cup1 is detached from tray1" in detached.text
    until(lambda: client.get("cup1").pose.position_m[2] < 0.1, "it fell")
    assert holder_of(client.get("cup1")) == ""
    assert client.get("cup1").properties == {}
    agree(client, "cup1")
    with paused(client):  # else it falls again in between
        for commit in reversed(client.history("cup1")):  # it may have rolled after it fell
            if commit.seq >= detached.commit:
                client.undo(commit.seq)
    until(lambda: holder_of(client.get("cup1")) == "tray1", "it is held again")
    agree(client, "cup1", "tray1")
    assert holder_of(client.get("cup1", as_of=attached)) == "tray1"


def test_a_hand_in_the_scene_changes_the_map(client):
    asked = Grip(orders=(GripOrder(name="cup1", holder="tray1"),))
    assert bus.ask(client.session, keys.SIM, "grip", asked, Gripped).failed == {}
    until(lambda: holder_of(client.get("cup1")) == "tray1", "the map follows")
    assert client.history("cup1", limit=1)[-1].reason == "cup1 was attached to tray1 in the scene"
    bus.ask(client.session, keys.SIM, "grip", Grip(orders=(GripOrder(name="cup1"),)), Gripped)
    until(lambda: holder_of(client.get("cup1")) == "", "the map follows")
    agree(client, "cup1", "tray1")


def test_what_is_held_is_held_again_after_a_restart(system, client):
    client.attach("cup1", to="tray1", at=(0.0, 0.0, 0.5))
    agree(client, "cup1", "tray1")
    before = scene_of(client).run
    os.kill(system.pid("sim_node"), signal.SIGKILL)

    def is_held_again():
        there = scene_of(client)
        held = {b.name: b.held_by for b in there.bodies}.get("cup1") == "tray1"
        return held and there.run != before

    until(is_held_again, "it is held again")
    until(lambda: live_off_m(client) < 0.02, "where it was")
    asked = Grip(orders=(GripOrder(name="cup1", holder="table1"),))
    why = bus.ask(client.session, keys.SIM, "grip", asked, Gripped).failed
    assert why == {"cup1": "cup1 is already attached to tray1"}


def test_the_last_word_wins(client):
    client.attach("cup1", to="tray1", force=True)
    agree(client, "cup1", "tray1")
    client.set("cup1", "isGraspedBy", "table1")
    until(lambda: grip_of(client.get("cup1")) is not None, "the map says where")
    agree(client, "cup1", "tray1")
    assert holder_of(client.get("cup1")) == "table1"
    client.unset("cup1", "isGraspedBy")
    agree(client, "cup1", "tray1")
    assert holder_of(client.get("cup1")) == ""


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (("cup1", "cup1"), "cup1 cannot be attached to itself"),
        (("cup1", "kitchen1"), "kitchen1 is a place; only objects can be attached to each other"),
        (("kitchen1", "cup1"), "kitchen1 is a place"),
        (("cup1", "cup9"), "no entity is named 'cup9'"),
        (("tray1", "cup1"), "cup1 is attached to tray1, so tray1 cannot be attached to it"),
        (("cup1", "table1"), "cup1 is already attached to tray1; first: semmap detach cup1"),
    ],
)
def test_what_cannot_be_held_is_refused(held, words, why):
    name, to = words
    with pytest.raises(errors.Refused, match=why):
        held.attach(name, to=to)


def test_what_is_held_is_neither_moved_nor_left_behind(held):
    why = "cup1 is attached to tray1; to move it, first: semmap detach cup1"
    with pytest.raises(errors.Refused, match=why):
        held.move("cup1", at=(1.0, 1.0, 0.0))
    with pytest.raises(errors.Refused, match=why):
        held.update("cup1", at=(1.0, 1.0, 0.0))
    with pytest.raises(errors.Refused, match="cup1 is attached to tray1; first: semmap detach cup1"):
        held.remove("tray1")
    with pytest.raises(errors.Refused, match="table1 is not attached"):
        held.detach("table1")


@pytest.mark.usefixtures("held")
def test_on_the_command_line(system):
    assert "cup1 is already attached to tray1" in system.cli("attach", "cup1", "--to", "tray1")
    assert "from the attachment to tray1" in system.cli("get", "cup1")
    assert "dry run" in system.cli("detach", "cup1", "--dry-run")


@pytest.fixture
def porter(system):
    """A robot beside a tray with two cups on it."""
    things = {"tray1": (0.0, -2.0, 0.0), "cup1": (0.08, -2.0, 0.02), "cup2": (-0.08, -2.0, 0.02)}
    with system.client() as client:
        client.move("robot1", at=(0.0, 0.0, 0.0), yaw=0.0)
        agree(client, "robot1", "robot1_gripper")
        try:
            yield from laid(
                client, **{n: ("Tray" if n == "tray1" else "Cup", at) for n, at in things.items()}
            )
        finally:
            client.move("robot1", at=HOME, yaw=0.0)
            agree(client, "robot1", "robot1_gripper")


def off_tray_m(client, cup):
    """How far a cup is from where the tray has it, by where both are just now."""
    there = {e.name: (e.live.pose if e.live else e.pose) for e in client.list()}
    return distance_m(there[cup], compose(there["tray1"], grip_of(client.get(cup))))


def test_what_stands_on_a_tray_is_carried_by_a_robot_and_free_again(porter):
    client = porter
    dry = client.attach("tray1", to="robot1_gripper", dry_run=True, force=True)
    assert dry.notes[-1].startswith("cup1 and cup2 are on or inside tray1 but not attached")
    reply = client.attach("tray1", to="robot1/gripper", at=(0.25, 0.0, 0.0), yaw=0.0, carry=True)
    assert reply.text.endswith("; cup1 and cup2 moved with tray1")
    assert set(reply.names) == {"tray1", "cup1", "cup2"}
    agree(client, "tray1", "cup1", "cup2")
    assert client.attach("tray1", to="robot1_gripper", carry=True).commit is None
    client.drive("robot1", to=((0.5, 0.0), (0.5, 0.5), (0.0, 0.0)), wait=True)
    for cup in ("cup1", "cup2"):
        assert holder_of(client.get(cup)) == "tray1"
        until(lambda cup=cup: off_tray_m(client, cup) < 0.02, f"{cup} is where the tray takes it")
    agree(client, "tray1", "cup1", "cup2")
    with paused(client):  # else they fall before the undo
        reply = client.detach("tray1")
        assert reply.text.endswith("; also detached: cup1 and cup2")
        (commit,) = client.history(since=reply.commit, until=reply.commit)
        assert set(commit.changed) == {"tray1", "cup1", "cup2"}
        assert {holder_of(client.get(n)) for n in ("tray1", "cup1", "cup2")} == {""}
        client.undo(reply.commit)
    assert {holder_of(client.get(n)) for n in ("cup1", "cup2")} == {"tray1"}
    assert client.detach("tray1").text.endswith("; also detached: cup1 and cup2")
