"""Switches of an MJCF world in a whole system: commands, manual changes and the map agree."""

import pytest

from semmap.schemas import errors
from tests.conftest import until


@pytest.fixture(scope="module")
def client(robot_scene):
    with robot_scene.client() as client:
        client.add("Oven", "stove", at=(-8.0, 0.0, 0.0), wait=True)
        yield client
        client.remove("stove")


def said(client):
    return client.get("stove").properties


def test_a_hand_turns_it_and_the_map_follows(client):
    assert client.open("stove", joint="dial_1", wait=True).text == "stove: dial_1 on (-1.5 rad)"
    assert said(client)["isSwitchedOn"] is True
    assert said(client)["switchPositions"] == "dial_1=-1.5"
    assert said(client)["isOpen"] is False
    assert client.get("stove").body.switched_on is True
    assert client.history("stove", limit=1)[-1].reason == "dial_1 of stove was turned by hand"
    client.close("stove", wait=True)
    assert said(client)["isSwitchedOn"] is True


def test_what_the_map_says_is_done_in_the_scene(client):
    for on in (False, True):
        said_so = client.set("stove", "isSwitchedOn", on).commit
        assert "switchPositions" not in said(client)
        until(lambda on=on: client.get("stove").body.switched_on is on, "it is switched")
    client.undo(said_so)
    until(lambda: client.get("stove").body.switched_on is False, "it stands as before")


def test_a_joint_that_there_is_not_is_refused_with_those_that_there_are(client):
    with pytest.raises(errors.Refused, match="has no joint 'dial' to open; did you mean dial_1"):
        client.open("stove", joint="dial")
