"""Joint queries to several robots: the replies with their commits, and the errors."""

from __future__ import annotations

import json

import pytest

from semmap.nodes import bus
from semmap.nodes.extern.client import connect
from semmap.nodes.extern.fleet.robots import Robots, robots
from semmap.schemas import errors


@pytest.fixture
def silent(two_robots):
    """A robot of which a node is there, but none that answers commands."""
    network = bus.Network(connect=(two_robots[0].endpoint,), namespace="mute1")
    with bus.open_session(network) as session:
        token = bus.declare_presence(session, "recorder")
        yield "mute1"
        token.undeclare()


def test_a_robot_is_asked_in_its_namespace_wherever_it_is_met(two_robots):
    for system in two_robots:
        with connect(system.endpoint, namespace="arm1") as client:
            assert [entity.name for entity in client.list()] == ["cup1"]
        with connect(system.endpoint, namespace="arm2") as client:
            assert client.list() == ()


def test_a_system_of_this_machine_is_asked_in_its_own(two_robots):
    arm1, arm2 = two_robots
    assert "1 entity" in arm1.cli("list")
    assert "0 entities" in arm2.cli("list")


def test_the_variable_says_which_robot(two_robots, monkeypatch):
    monkeypatch.setenv("SEMMAP_NAMESPACE", "arm1")
    assert "cup1" in two_robots[1].cli("list")


def test_every_robot_answers_with_its_commit(two_robots):
    with robots("*", two_robots[0].endpoint) as found:
        assert found.names == ("arm1", "arm2")
        answers = found.list("Cup")
        assert [(one.robot, len(one.value)) for one in answers] == [("arm1", 1), ("arm2", 0)]
        commits = {one.robot: one.commit for one in found.status()}
        assert {one.robot: one.commit for one in answers} == commits
        asked = found.sparql("ASK { ?s a dm:Cup }")
        assert [(one.value.verdict, one.commit) for one in asked] == [
            (True, commits["arm1"]),
            (False, commits["arm2"]),
        ]


def test_a_reply_is_about_the_commit_that_it_says_though_another_one_comes_meanwhile(two_robots):
    with robots("arm1", two_robots[0].endpoint) as found:
        client = found.clients["arm1"]
        before = client.status().commit

        class Racing:
            """One whose map changes whenever it has answered a question about now."""

            send = client.send

            def list(self, class_, *, as_of=None):
                reply = client.list(class_, as_of=as_of)
                if as_of is None:
                    client.add("Cup", "cup9", at=(3.0, 3.0, 0.7))
                return reply

        (answer,) = Robots({"arm1": Racing()}, ()).list("Cup")
        client.remove("cup9")
    assert answer.commit == before
    assert [entity.name for entity in answer.value] == ["cup1"]


def test_a_robot_that_rejects_is_distinguished_from_those_that_reply(two_robots):
    with robots("*", two_robots[0].endpoint) as found:
        one, other = found.get("cup1")
        assert one.value.name == "cup1"
        with pytest.raises(errors.UnknownName):
            _ = other.value


def test_a_robot_that_does_not_answer_is_named(two_robots, silent):
    system = two_robots[0]
    said = system.cli("list", "--robots", "arm1,mute*", "--class", "Cup", status=3)
    assert "arm1 (commit " in said
    assert "semmap: mute1: no response on semmap/cmd/status: coordinator is not running" in said


def test_a_robot_that_is_not_there_is_named(two_robots):
    said = two_robots[0].cli("status", "--robots", "arm1,arm7", status=3)
    assert "arm1 (commit " in said
    assert "arm7: robot arm7 not found; available robots: arm1, arm2" in said


def test_an_endpoint_that_does_not_answer_is_named(two_robots):
    system = two_robots[0]
    said = system.cli("status", "--robots", "*", "--connect", f"{system.endpoint},tcp/127.0.0.1:1", status=3)
    assert "arm2 (commit " in said
    assert "at tcp/127.0.0.1:1: no response" in said


def test_no_robot_at_all(two_robots):
    assert "no robot matches lift*; available robots: arm1, arm2" in two_robots[0].cli(
        "list", "--robots", "lift*", status=3
    )


def test_json_has_a_robots_name_beside_its_reply(two_robots):
    said = two_robots[0].cli(
        "get", "cup1", "--robots", "*", "--format", "json", "--connect", two_robots[0].endpoint
    )
    one, other = json.loads(said.partition("\nsemmap: ")[0])
    assert (one["robot"], one["reply"]["name"], one["error"]) == ("arm1", "cup1", None)
    assert (other["robot"], other["reply"], other["error"]["code"]) == ("arm2", None, "unknown-name")


def test_sparql_and_its_formats(two_robots):
    system = two_robots[0]
    said = system.cli("sparql", "SELECT ?s { ?s a dm:Cup }", "--robots", "arm1")
    assert ":cup1" in said
    assert "use table or json" in system.cli("sparql", "ASK {}", "--robots", "*", "--format", "csv", status=2)


def test_a_namespace_without_a_robot_names_the_others(two_robots):
    said = two_robots[0].cli("list", "--namespace", "arm3", status=3)
    assert said.endswith("available robots: arm1, arm2\n")


@pytest.mark.parametrize("name", ["a/b", "*", "-x", "a b"])
def test_what_no_robot_can_be_called(two_robots, name):
    assert "is not a valid robot name" in two_robots[0].cli("list", f"--namespace={name}", status=2)


def test_robots_and_namespace_exclude_one_another(two_robots):
    said = two_robots[0].cli("list", "--robots", "*", "--namespace", "arm1", status=2)
    assert "--robots and --namespace exclude each other" in said
