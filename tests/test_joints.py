"""Doors in a whole system: commands, manual changes and the map agree on the openness."""

import pytest

from semmap.nodes import bus
from semmap.schemas import errors, keys
from semmap.schemas.scenes import JointOrder, JointsMoving, MoveJoints
from tests.conftest import until


@pytest.fixture(scope="module")
def system(empty_scene):
    """A system with a fridge and a cup, beside the walls of the flat."""
    with empty_scene.client() as client:
        client.add("Fridge", "fridge1", at=(-5.0, 0.0, 0.0), wait=True)
        client.add("Cup", "cup1", at=(-3.0, 0.0, 0.0), wait=True)
    return empty_scene


@pytest.fixture
def client(system):
    with system.client() as client:
        client.close("fridge1")
        yield client


def said(client):
    properties = client.get("fridge1").properties
    return {name: properties.get(name) for name in ("isOpen", "openness", "jointPositions")}


def test_a_hand_opens_it_and_the_map_follows(client):
    reply = client.open("fridge1", to=0.5, joint="door")
    assert reply.text == "fridge1: door open to 50% (0.873 rad)"
    assert said(client) == {"isOpen": True, "openness": 0.5, "jointPositions": "door=0.873 freezer=0"}
    entity = client.get("fridge1")
    assert entity.body.openness == pytest.approx(0.5, abs=0.01)
    assert entity.joint_provenance.source == "scene"
    newest = client.history("fridge1", limit=1)[-1]
    assert (newest.verb, newest.reason) == ("open", "fridge1 was opened by hand")
    assert client.close("fridge1").text == "fridge1: door closed (0 rad), freezer closed (0 rad)"
    assert said(client) == {"isOpen": False, "openness": 0.0, "jointPositions": "door=0 freezer=0"}


def test_what_the_map_says_is_done_in_the_scene(client):
    client.set("fridge1", "isOpen", True)
    assert said(client)["jointPositions"] is None

    def is_open():
        body = client.get("fridge1").body
        agrees = client.status(names=("fridge1",)).in_agreement
        return body if agrees and body.openness > 0.99 else None

    until(is_open, "the doors open")
    client.set("fridge1", "openness", 0.25)
    assert said(client)["isOpen"] is True
    until(lambda: abs(client.get("fridge1").body.openness - 0.25) < 0.01, "the doors close a little")
    closed = client.set("fridge1", "isOpen", False).commit
    until(lambda: client.get("fridge1").body.openness < 0.01, "the doors close")
    client.undo(closed)
    until(lambda: abs(client.get("fridge1").body.openness - 0.25) < 0.01, "they stand as before")


def test_a_robot_that_opens_it_changes_the_map(client):
    client.set("fridge1", "isOpen", False)
    until(lambda: client.get("fridge1").body.openness < 0.01, "the doors close")
    asked = MoveJoints(orders=(JointOrder(name="fridge1", joint="freezer", openness=1.0),))
    assert bus.ask(client.session, keys.SIM, "move-joints", asked, JointsMoving).failed == {}
    until(lambda: said(client)["openness"] == 1.0, "the map follows")
    assert client.history("fridge1", limit=1)[-1].reason == "fridge1 was opened to 100% in the scene"
    rows = client.sparql("SELECT ?x { ?x dm:isOpen true ; dm:openness ?o FILTER(?o > 0.9) }").rows
    assert len(rows) == 1


def test_what_is_in_a_drawer_is_inside_it_open_or_shut(client):
    client.add("Drawer", "chest1", at=(-5.0, 3.0, 0.0), wait=True)
    client.add("Apple", "apple1", at=(-4.95, 3.1, 0.72), wait=True)

    def inside():
        found = client.list(in_="chest1")
        return [entity.name for entity in found] == ["apple1"]

    assert inside()
    client.open("chest1", joint="drawer_1")
    assert client.get("apple1").pose.position_m[0] > -4.75
    assert inside()
    why = client.explain("apple1", "isInside", "chest1")
    assert "within drawer_1 of chest1, which is open to 100%" in why.text
    assert "cannot be seen" not in client.last_seen("apple1").text
    client.close("chest1")
    assert client.get("apple1").pose.position_m[0] < -4.9
    assert inside()
    assert "not observable: chest1 has been closed since" in client.last_seen("apple1").text
    client.open("chest1", joint="drawer_2")
    assert "not observable: drawer_1 of chest1 is closed" in client.last_seen("apple1").text
    client.remove("apple1", "chest1")


@pytest.mark.parametrize(
    ("name", "why"),
    [("cup1", "cup1 has no door, lid or drawer to open"), ("fridge2", "no entity is named 'fridge2'")],
)
def test_what_does_not_open_is_refused(client, name, why):
    with pytest.raises(errors.Refused, match=why):
        client.open(name)


def test_on_the_command_line(system):
    assert "door open to 30% (0.524 rad)" in system.cli("open", "fridge1", "--to", "0.3", "--joint", "door")
    assert "isOpen" in system.cli("get", "fridge1")
    assert "door closed" in system.cli("close", "fridge1", "--wait")
