"""The router of a robot with a name: its rules are for whole keys with the namespace."""

from __future__ import annotations

import contextlib

import pytest
from msgspec import structs

from semmap.nodes import bus
from semmap.nodes.identity import Identity
from semmap.nodes.identity.register import Register
from semmap.nodes.router.access import access_control
from semmap.schemas import errors, keys
from semmap.schemas.commands import Status
from semmap.schemas.replies import Done
from tests.conftest import PATIENCE_S, free_endpoint, until
from tests.router.conftest import opened, router_network


def test_with_a_namespace_the_rules_are_about_whole_keys(folder):
    members = Register.read(folder).admitted
    for namespace in ("robot1", "*"):
        rules = access_control(members, namespace)["rules"]
        there = {key for rule in rules for key in rule["key_exprs"]}
        assert {key.partition("/")[0] for key in there} == {namespace, "*"}
        asked = {key for rule in rules for key in rule["key_exprs"] if rule["messages"] == ["query"]}
        assert f"{namespace}/semmap/as/viewer/cmd/*" in asked


@pytest.fixture(scope="module")
def robot1(folder):
    """The endpoint of the router of robot1, whose coordinator replies to all."""
    endpoint = bus.to_tls(free_endpoint())
    network = structs.replace(
        router_network(folder, endpoint),
        access=access_control(Register.read(folder).admitted, "robot1"),
        namespace="robot1",
    )
    with bus.open_session(network), contextlib.ExitStack() as stack:
        node = opened(stack, endpoint, Identity.read(folder / "coordinator"), namespace="robot1")
        bus.serve(node, keys.commands_as(), lambda request: request.reply(Done(text=request.who)))
        token = bus.declare_presence(node, "coordinator")
        yield endpoint
        token.undeclare()


def asked(folder, endpoint, name, namespace, patience_s=PATIENCE_S):
    with contextlib.ExitStack() as stack:
        session = opened(stack, endpoint, Identity.read(folder / name), namespace=namespace)
        return bus.ask(session, keys.commands_as(name), "status", Status(), Done, patience_s=patience_s).text


def test_clients_send_commands_under_their_own_name_in_it(folder, robot1):
    assert asked(folder, robot1, "viewer", "robot1") == "viewer"


@pytest.mark.parametrize("namespace", ["", "robot2", "robot1/semmap"])
def test_no_client_sends_commands_in_another_namespace(folder, robot1, namespace):
    with pytest.raises(errors.NoAnswer):
        asked(folder, robot1, "viewer", namespace, patience_s=0.2)


def test_a_query_for_all_robots_is_answered(folder, robot1):
    with contextlib.ExitStack() as stack:
        session = opened(stack, robot1, Identity.read(folder / "viewer"))
        until(lambda: bus.find_robots(session) == {"robot1": frozenset({"coordinator"})}, "the robot")
