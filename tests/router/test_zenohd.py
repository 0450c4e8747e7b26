"""Configuration files for a plain Zenoh router."""

from __future__ import annotations

import contextlib
import json
from pathlib import Path

import pytest
import zenoh

from semmap.nodes import bus
from semmap.nodes.extern.cli.app import execute
from semmap.nodes.identity import Identity
from semmap.schemas import keys
from tests.conftest import PATIENCE_S, free_endpoint, until
from tests.router.conftest import opened

EXAMPLE = Path(__file__).parents[2] / "examples" / "zenohd" / "site.json5"
HERE = ("tcp/10.0.0.1:7447",)


def test_the_example_has_the_settings_of_our_own_routers():
    example = zenoh.Config.from_file(str(EXAMPLE))
    ours = bus.Network(mode="router", listen=("tcp/0.0.0.0:7447",), connect=HERE).as_config()
    for path in bus.Network(mode="router").values().keys() - {"scouting/delay"}:  # which no router waits
        assert json.loads(example.get_json(path)) == json.loads(ours.get_json(path)), path


def test_a_network_as_a_file_is_the_same():
    network = bus.Network(mode="router", listen=("tcp/0.0.0.0:7447",), connect=HERE, namespace="robot1")
    assert str(zenoh.Config.from_json5(network.as_file())) == str(network.as_config())


@pytest.fixture
def printed(folder, capsys):
    """What `semmap keys zenohd` prints for a router at an endpoint."""

    def printed(endpoint, *words):
        assert execute(["keys", "zenohd", "--dir", str(folder), "--listen", endpoint, *words]) == 0
        return capsys.readouterr().out

    return printed


def test_a_router_with_the_printed_file_admits_the_same_clients(folder, printed):
    endpoint = bus.to_tls(free_endpoint())
    with contextlib.ExitStack() as stack:
        stack.enter_context(zenoh.open(zenoh.Config.from_json5(printed(endpoint))))
        coordinator, viewer, router = (
            opened(stack, endpoint, Identity.read(folder / name), patience_s=PATIENCE_S)
            for name in ("coordinator", "viewer", "router")
        )

        def answer(query):
            with query:
                query.reply(query.key_expr, "served")

        coordinator.declare_queryable(f"{keys.commands_as()}/*", answer)

        def asked(session, name):
            return [r for r in session.get(f"{keys.commands_as(name)}/get", timeout=PATIENCE_S) if r.ok]

        until(lambda: asked(viewer, "viewer"), "an answer")
        assert not asked(viewer, "operator")
        assert asked(router, "operator")  # in whose name the router of another host passes it on


def test_a_printed_file_is_for_certificates_only(folder, capsys):
    words = ["keys", "zenohd", "--dir", str(folder), "--connect", "tcp/10.0.0.1:7447"]
    assert execute(words) == 2
    assert "is not a plain TLS endpoint" in capsys.readouterr().err


def test_keys_for_a_robot_have_its_name(printed):
    access = json.loads(printed("tls/127.0.0.1:7447", "--namespace", "robot1"))["access_control"]
    key_exprs = {key for rule in access["rules"] for key in rule["key_exprs"]}
    assert {key for key in key_exprs if not key.startswith("robot1/")} == {keys.robots_live()}
