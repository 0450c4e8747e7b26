"""Things that are held over the wire: words, hands and the map agree on who holds what."""

import json
import os
import signal

import pytest

from nodes import bus
from schemas import errors, keys
from schemas.entities import compose, distance_m
from schemas.grips import grip_of, holder_of
from schemas.scenes import Grip, GripOrder, Gripped, Scene, SceneQuery
from tests.conftest import running, until

OPTIONS = ("--abox", "none", "--world", "empty")


@pytest.fixture
def system(tmp_path):
    with running(tmp_path, *OPTIONS) as system:
        with system.client() as client:
            client.add("Table", "table1", at=(0.0, 0.0, 0.0), wait=True)
            client.add("Tray", "tray1", at=(3.0, 0.0, 0.0), wait=True)
            client.add("Cup", "cup1", at=(0.0, 0.0, 0.8), wait=True)
            client.add("Kitchen", "kitchen1", at=(0.0, 0.0, 0.0), size=(20.0, 20.0, 3.0))
            until(lambda: client.status().in_agreement, "all is at rest")
        yield system


@pytest.fixture
def client(system):
    with system.client() as client:
        yield client


def in_agreement(client):
    return until(lambda: client.status().in_agreement, "map and scene agree")


def live_off_m(client):
    """How far the cup's live pose is from where its holder has it."""
    cup, tray = client.get("cup1"), client.get("tray1")
    return distance_m(cup.live.pose, compose(tray.pose, grip_of(cup)))


def test_it_is_taken_carried_and_put(client):
    assert [e.name for e in client.list(on="table1")] == ["cup1"]
    reply = client.attach("cup1", to="tray1")
    assert reply.text.startswith("tray1 holds cup1, at (-3, 0, 0.7")
    cup = client.get("cup1", where=True)
    assert holder_of(cup) == "tray1"
    assert client.list(on="table1") == ()
    assert [e.name for e in client.list(in_="kitchen1", class_="Cup")] == ["cup1"]
    assert "kitchen1" in client.sparql("SELECT ?x { :cup1 dm:isLocatedIn ?x }", inferred=True).rows[0][0]
    in_agreement(client)
    before = client.status().commit
    client.move("tray1", at=(3.0, 2.0, 0.0))
    until(lambda: client.get("tray1").pose.position_m[1] > 1.9, "the map follows the tray")
    in_agreement(client)
    assert client.status().commit == before + 1  # the tray's
    assert client.get("cup1").live.pose.position_m[1] == pytest.approx(2.0, abs=0.02)
    assert live_off_m(client) < 0.02
    assert client.get("cup1").pose.position_m[1] == pytest.approx(0.0, abs=0.02)
    assert "tray1 let go of cup1" in client.detach("cup1").text
    until(lambda: client.get("cup1").pose.position_m[2] < 0.1, "it fell")
    assert holder_of(client.get("cup1")) == ""
    assert client.get("cup1").properties == {}
    in_agreement(client)
    client.undo()
    until(lambda: holder_of(client.get("cup1")) == "tray1", "it is held again")
    in_agreement(client)
    assert holder_of(client.get("cup1", as_of=1 + before)) == "tray1"


def test_a_hand_in_the_scene_changes_the_map(client):
    asked = Grip(orders=(GripOrder(name="cup1", holder="tray1"),))
    assert bus.ask(client.session, keys.SIM, "grip", asked, Gripped).failed == {}
    until(lambda: holder_of(client.get("cup1")) == "tray1", "the map follows")
    assert client.history(limit=1)[-1].reason == "cup1 was taken by tray1 in the scene"
    bus.ask(client.session, keys.SIM, "grip", Grip(orders=(GripOrder(name="cup1"),)), Gripped)
    until(lambda: holder_of(client.get("cup1")) == "", "the map follows")
    in_agreement(client)


def test_what_is_held_is_held_again_after_a_restart(system, client):
    client.attach("cup1", to="tray1", at=(0.0, 0.0, 0.5))
    in_agreement(client)
    before = bus.ask(client.session, keys.SIM, "snapshot", SceneQuery(), Scene).run
    os.kill(system.pid("sim_node"), signal.SIGKILL)

    def scene():
        try:
            return bus.ask(client.session, keys.SIM, "snapshot", SceneQuery(), Scene)
        except errors.NoAnswer:
            return None

    def is_held_again():
        there = scene()
        held = there is not None and {b.name: b.held_by for b in there.bodies}.get("cup1") == "tray1"
        return held and there.run != before

    until(is_held_again, "it is held again")
    until(lambda: live_off_m(client) < 0.02, "where it was")
    asked = Grip(orders=(GripOrder(name="cup1", holder="table1"),))
    why = bus.ask(client.session, keys.SIM, "grip", asked, Gripped).failed
    assert why == {"cup1": "cup1 is held by tray1 already"}


def test_the_last_word_wins(client):
    client.attach("cup1", to="tray1")
    in_agreement(client)
    client.set("cup1", "isGraspedBy", "table1")
    until(lambda: grip_of(client.get("cup1")) is not None, "the map says where")
    in_agreement(client)
    assert holder_of(client.get("cup1")) == "table1"
    client.unset("cup1", "isGraspedBy")
    in_agreement(client)
    assert holder_of(client.get("cup1")) == ""


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (("cup1", "cup1"), "cup1 cannot hold itself"),
        (("cup1", "kitchen1"), "kitchen1 is a place, which neither holds anything nor is held"),
        (("kitchen1", "cup1"), "kitchen1 is a place"),
        (("cup1", "cup9"), "no entity is named 'cup9'"),
        (("tray1", "cup1"), "cup1 is held by tray1, so it cannot hold tray1"),
        (("cup1", "table1"), "cup1 is held by tray1 already; first: semmap detach cup1"),
    ],
)
def test_what_cannot_be_held_is_refused(shared, words, why):
    name, to = words
    with shared.client() as client, pytest.raises(errors.Refused, match=why):
        client.attach(name, to=to)


@pytest.fixture(scope="module")
def shared(tmp_path_factory):
    with running(tmp_path_factory.mktemp("grips"), *OPTIONS) as system:
        with system.client() as client:
            client.add("Table", "table1", at=(0.0, 0.0, 0.0), wait=True)
            client.add("Tray", "tray1", at=(3.0, 0.0, 0.0), wait=True)
            client.add("Cup", "cup1", at=(3.0, 0.0, 0.5), wait=True)
            client.add("Kitchen", "kitchen1", at=(0.0, 0.0, 0.0), size=(20.0, 20.0, 3.0))
            client.attach("cup1", to="tray1")
            until(lambda: client.status().in_agreement, "map and scene agree")
        yield system


def test_what_is_held_is_neither_moved_nor_left_behind(shared):
    with shared.client() as client:
        why = "cup1 is held by tray1; to put it elsewhere, first: semmap detach cup1"
        with pytest.raises(errors.Refused, match=why):
            client.move("cup1", at=(1.0, 1.0, 0.0))
        with pytest.raises(errors.Refused, match=why):
            client.update("cup1", at=(1.0, 1.0, 0.0))
        with pytest.raises(errors.Refused, match="tray1 holds cup1; first: semmap detach cup1"):
            client.remove("tray1")
        with pytest.raises(errors.Refused, match="nothing holds table1"):
            client.detach("table1")


def test_on_the_command_line(shared):
    assert "tray1 holds cup1 already" in shared.cli("attach", "cup1", "--to", "tray1")
    assert "where tray1 holds it" in shared.cli("get", "cup1")
    assert "dry run" in shared.cli("detach", "cup1", "--dry-run")


@pytest.fixture
def porter(tmp_path):
    """A robot beside a tray with two cups on it."""
    with running(tmp_path, *OPTIONS, "--robot", "porter") as system, system.client() as client:
        client.add("Tray", "tray1", at=(0.0, -2.0, 0.0), wait=True)
        client.add("Cup", "cup1", at=(0.08, -2.0, 0.02), wait=True)
        client.add("Cup", "cup2", at=(-0.08, -2.0, 0.02), wait=True)
        until(lambda: client.status().in_agreement, "all is at rest")
        yield system


def off_tray_m(client, cup):
    """How far a cup is from where the tray has it, by where both are just now."""
    there = {e.name: (e.live.pose if e.live else e.pose) for e in client.list()}
    return distance_m(there[cup], compose(there["tray1"], grip_of(client.get(cup))))


def test_what_stands_on_a_tray_is_carried_by_a_robot_and_free_again(porter):
    with porter.client() as client:
        dry = client.attach("tray1", to="robot1_gripper", dry_run=True)
        assert dry.notes[-1].startswith("cup1 and cup2 are on or inside tray1 and held by nothing")
        reply = client.attach("tray1", to="robot1/gripper", at=(0.25, 0.0, 0.0), yaw=0.0, carry=True)
        assert reply.text.endswith("; tray1 carried cup1 and cup2 along")
        assert set(reply.names) == {"tray1", "cup1", "cup2"}
        in_agreement(client)
        assert client.attach("tray1", to="robot1_gripper", carry=True).commit is None
        client.drive("robot1", to=((1.0, 0.0), (1.0, 1.0), (0.0, 0.0)), wait=True)
        for cup in ("cup1", "cup2"):
            assert holder_of(client.get(cup)) == "tray1"
            assert off_tray_m(client, cup) < 0.02
        before = in_agreement(client) and client.status().commit
        reply = client.detach("tray1")
        assert reply.text.endswith("; cup1 and cup2 are free again, too")
        assert reply.commit == before + 1
        assert {holder_of(client.get(n)) for n in ("tray1", "cup1", "cup2")} == {""}
        in_agreement(client)
        client.undo(reply.commit)
        assert {holder_of(client.get(n)) for n in ("cup1", "cup2")} == {"tray1"}
        assert client.detach("tray1").text.endswith("; cup1 and cup2 are free again, too")


WORLD = {
    "entities": [
        {"class": "Table", "name": "table1", "at": [3.0, 0.0, 0.0]},
        {"class": "Tray", "name": "tray1", "at": [0.0, -2.0, 0.0]},
        {"class": "Cup", "name": "cup1", "at": [0.08, -2.0, 0.02]},
        {"class": "Cup", "name": "cup2", "at": [-0.08, -2.0, 0.02]},
    ]
}


def test_where_the_scene_is_the_truth_what_stands_on_it_is_taken_along_there_first(tmp_path):
    (tmp_path / "world.json").write_text(json.dumps(WORLD))
    options = ("--abox", "none", "--world", tmp_path / "world.json", "--truth", "scene")
    with running(tmp_path, *options) as system, system.client() as client:
        until(lambda: [e.name for e in client.list(on="tray1")] == ["cup1", "cup2"], "the map follows")
        in_agreement(client)
        with pytest.raises(errors.BadRequest, match="--leave says what is not to be carried along"):
            client.attach("tray1", to="table1", leave=("cup1",))
        reply = client.attach("tray1", to="table1", at=(0.0, 0.0, 0.8), carry=True, leave=("cup1",))
        assert "tray1 carried cup2 along" in reply.text
        in_agreement(client)
        assert [holder_of(client.get(n)) for n in ("cup1", "cup2")] == ["", "tray1"]
        scene = bus.ask(client.session, keys.SIM, "snapshot", SceneQuery(), Scene)
        there = {body.name: body for body in scene.bodies}
        assert {name: body.held_by for name, body in there.items()} == {
            "table1": "", "tray1": "table1", "cup1": "", "cup2": "tray1"
        }  # fmt: skip
        assert there["cup2"].pose.position_m == pytest.approx((2.92, 0.0, 0.81), abs=0.03)
        assert client.detach("tray1").names == ("tray1", "cup2")
        in_agreement(client)
        assert holder_of(client.get("cup2")) == ""
