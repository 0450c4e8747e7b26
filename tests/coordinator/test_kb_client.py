"""Requests while the knowledge base is away, and back after a while."""

from __future__ import annotations

import pytest

from semmap.nodes import bus
from semmap.nodes.coordinator.kb_client import KbClient
from semmap.nodes.runtime.loop import Node
from semmap.schemas import errors, keys
from semmap.schemas.bridge import TakeBack
from semmap.schemas.commits import Commit, Effects, Transaction
from tests.conftest import PATIENCE_S, free_endpoint, handling, until
from tests.waiting import questions_asked, until_served

TRANSACTION = Transaction(id="42", source="operator")
COMMIT = Commit(seq=1, stamp_ns=1, id="42", source="operator")


@pytest.fixture
def network():
    endpoint = free_endpoint()
    peer = bus.Network(mode="peer", listen=(endpoint,), connect=())
    with bus.open_session(peer) as session, bus.open_session(bus.Network(connect=(endpoint,))) as kb:
        node = Node("coordinator", session)
        with handling(node):
            yield KbClient(node), kb


def serve(kb):
    """Reply, but not the first time."""
    asked = []

    def receive(request):
        asked.append(request.verb)
        if len(asked) > 1:
            request.reply(COMMIT)

    bus.serve(kb, keys.BRIDGE, receive)


@pytest.mark.parametrize("how", ["change", "change_later"])
def test_a_change_waits_for_the_knowledge_base_without_blocking(network, how, monkeypatch):
    monkeypatch.setattr(bus, "RESTART_S", PATIENCE_S)
    asked = questions_asked(monkeypatch)
    bridge, kb = network
    answer = getattr(bridge, how)(TRANSACTION)
    until(lambda: len(asked) > 2, "it was queried without reply")
    assert not answer.done()
    serve(kb)
    assert answer.result(PATIENCE_S) == Effects.of(COMMIT)


@pytest.mark.parametrize("how", ["change", "change_later"])
def test_the_missing_node_is_named(network, how, monkeypatch):
    monkeypatch.setattr(bus, "RESTART_S", 0.2)
    answer = getattr(network[0], how)(TRANSACTION)
    with pytest.raises(errors.NoAnswer, match="kb_node is not running or still starting"):
        answer.result(PATIENCE_S)


def test_a_refusal_is_an_answer(network):
    bridge, kb = network
    bus.serve(kb, keys.BRIDGE, lambda request: request.refuse(errors.Refused("no")))
    with pytest.raises(errors.Refused, match="no"):
        bridge.change(TRANSACTION).result(PATIENCE_S)


def test_what_takes_long_is_not_waited_for(network):
    bridge, kb = network
    requests = []
    bus.serve(kb, keys.BRIDGE, requests.append)
    until_served(bridge._node.session, f"{keys.BRIDGE}/{TakeBack.VERB}")
    answer = bridge.change(TakeBack(id="43", source="operator"))
    assert until(lambda: requests, "it was asked")
    assert not answer.done()
    requests[0].reply(COMMIT)
    assert answer.result(PATIENCE_S) == Effects.of(COMMIT)


@pytest.mark.parametrize("how", ["change", "change_later"])
def test_a_change_whose_client_has_gone_is_not_sent_again(network, how, monkeypatch):
    asked = questions_asked(monkeypatch)
    answer = getattr(network[0], how)(TRANSACTION, lambda: True)
    with pytest.raises(errors.NoAnswer):
        answer.result(PATIENCE_S)
    assert len(asked) == (how == "change_later")
