"""Mutated payloads on every key: no node dies, and each is answered or ignored and counted."""

from __future__ import annotations

import pytest

from semmap.schemas import keys
from semmap.schemas.commands import Load
from tests.conftest import running, until
from tests.faults.mutations import Mutator, pids, queries, send, topics


def test_every_key_gets_payloads():
    prefixes = {key.rpartition("/")[0] for key in queries()}
    assert prefixes == {keys.CMD, keys.BRIDGE, keys.SIM}
    assert set(topics()) >= {keys.COMMIT.key, keys.POSES.key, keys.ACK.key, keys.health_key("x")}
    payloads = [Mutator(7).payload(kind) for kind in queries().values()]
    assert payloads == [Mutator(7).payload(kind) for kind in queries().values()]


@pytest.mark.parametrize("count", [150, pytest.param(20_000, marks=pytest.mark.long)])
def test_no_node_dies_and_every_payload_is_answered_or_counted(tmp_path, count):
    """On a system of its own: valid messages of unknown senders stay in its state."""
    with running(tmp_path / "d", "--no-record") as system:
        system.await_scene()
        before = pids(system)
        outcome = send(system.endpoint, count, seed=count)
        assert outcome.wrong == []
        assert pids(system) == before
        assert set(outcome.answered) > {"ok", "bad-request"}
        _wait_under_the_id_of_a_change_without_names(system)
        with system.client() as client:
            until(
                lambda: any(
                    n.node == "coordinator" and "malformed message" in n.detail for n in client.status().nodes
                ),
                "what was ignored is counted",
            )


def _wait_under_the_id_of_a_change_without_names(system):
    """Found by mutations: this was an internal error."""
    with system.client() as client:
        empty = Load(content=b"<urn:a> <urn:b> <urn:c> .", filename="a.ttl", id="again")
        assert client.send(empty).names == ()
        assert client.add("Cup", at=(1.0, 1.0, 0.0), wait=True, id="again").names == ()
