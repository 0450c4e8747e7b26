"""A program that serves the key of a node without being that node."""

from __future__ import annotations

import contextlib
import logging
import queue
import threading

import pytest

from semmap.nodes import bus
from semmap.schemas import commands, keys, replies
from tests.bus.conftest import answer
from tests.conftest import PATIENCE_S, free_endpoint, until
from tests.waiting import until_served

ASKED = (commands.Get(name="x"), replies.Done)


@pytest.fixture
def three():
    """A node, a foreign program and a client; the foreign program is preferred, because it is nearer."""
    endpoint = free_endpoint()
    with (
        bus.open_session(bus.Network(mode="peer", listen=(endpoint,), connect=())) as thief,
        bus.open_session(bus.Network(connect=(endpoint,))) as node,
        bus.open_session(bus.Network(connect=(endpoint,))) as client,
    ):
        stolen = []

        def steal(request):
            stolen.append(request)
            return replies.Done(text="stolen")

        bus.serve(thief, keys.BRIDGE, answer(steal), verb="get")
        until_served(client, f"{keys.BRIDGE}/get")
        yield node, client, stolen


def ready(node, client):
    """The node also serves, and its token is seen."""
    bus.serve(node, keys.BRIDGE, answer(lambda _: replies.Done(text="true")))
    liveliness = bus.LivelinessMonitor(client)
    token = bus.declare_presence(node, "kb_node")
    until(lambda: liveliness.is_there("kb_node"), "the token is seen")
    return liveliness, token


def test_a_foreign_reply_is_ignored_if_the_node_replies(three, caplog):
    node, client, stolen = three
    liveliness, _token = ready(node, client)
    said = "a program that is not kb_node answers on semmap/bridge/get"
    with caplog.at_level(logging.WARNING):
        for _ in range(300):  # the order of the replies is not defined
            assert bus.ask(client, keys.BRIDGE, "get", *ASKED, liveliness=liveliness).text == "true"
            if said in caplog.text:
                break
    assert stolen
    assert caplog.text.count(said) <= 1


def test_a_foreign_reply_is_ignored_before_the_token_of_the_node_arrives(three):
    node, client, stolen = three
    bus.serve(node, keys.BRIDGE, answer(lambda _: replies.Done(text="true")))
    _token = bus.declare_presence(node, "kb_node")
    probe = bus.LivelinessMonitor(client)
    until(lambda: probe.is_there("kb_node"), "the token is seen")
    for _ in range(300):
        liveliness = bus.LivelinessMonitor(client)
        liveliness._instances.clear()  # as if its thread had not run yet
        assert bus.ask(client, keys.BRIDGE, "get", *ASKED, liveliness=liveliness).text == "true"
        if len(stolen) > 3:
            break
    assert stolen


def test_without_a_reply_of_the_node_a_foreign_reply_is_an_error(three):
    node, client, _ = three
    liveliness = bus.LivelinessMonitor(client)
    token = bus.declare_presence(node, "kb_node")
    until(lambda: liveliness.is_there("kb_node"), "the token is seen")
    with pytest.raises(bus.ForeignReply, match="its replies are ignored"):
        bus.ask(client, keys.BRIDGE, "get", *ASKED, liveliness=liveliness, patience_s=0.3)
    del token


def test_ask_later_reports_a_foreign_reply_and_can_query_all(three):
    node, client, _ = three
    liveliness = bus.LivelinessMonitor(client)
    token = bus.declare_presence(node, "kb_node")
    until(lambda: liveliness.is_there("kb_node"), "the token is seen")

    def ask(ask_all):
        answers, done = [], threading.Event()

        def take(read):
            answers.append(read)
            done.set()

        bus.ask_later(client, keys.BRIDGE, "get", *ASKED, take, liveliness=liveliness, ask_all=ask_all)
        assert done.wait(PATIENCE_S)
        return answers[0]

    with pytest.raises(bus.ForeignReply):
        ask(ask_all=False)()
    bus.serve(node, keys.BRIDGE, answer(lambda _: replies.Done(text="true")))

    def is_true():
        with contextlib.suppress(bus.ForeignReply):
            return ask(ask_all=True)().decode().text == "true"

    until(is_true, "the node is asked, too")
    del token


def test_foreign_replies_are_accepted_while_no_node_is_ready(three):
    _, client, stolen = three
    liveliness = bus.LivelinessMonitor(client)
    reply = until(lambda: bus.ask(client, keys.BRIDGE, "get", *ASKED, liveliness=liveliness), "a reply")
    assert (reply.text, bool(stolen)) == ("stolen", True)


@pytest.fixture
def slow():
    """A node that does not reply, and a client that is connected to another node."""
    endpoint = free_endpoint()
    with (
        bus.open_session(bus.Network(mode="peer", listen=(endpoint,), connect=())),
        bus.open_session(bus.Network(connect=(endpoint,))) as node,
        bus.open_session(bus.Network(mode="client", connect=(endpoint,))) as client,
    ):
        held = []
        bus.serve(node, keys.BRIDGE, held.append)
        liveliness = bus.LivelinessMonitor(client)
        token = bus.declare_presence(node, "kb_node")
        until(lambda: liveliness.is_there("kb_node"), "the token is seen")
        yield client, liveliness
        del token


_OFTEN = 150
"""In one of about ten time-outs, the neighbour reports it before the client notices."""


def test_a_late_node_is_not_foreign(slow, caplog):
    client, liveliness = slow
    for _ in range(_OFTEN):
        with pytest.raises(bus.TimedOut, match="did not answer within"):
            bus.ask(client, keys.BRIDGE, "get", *ASKED, timeout_s=0.01, patience_s=0.1, liveliness=liveliness)
    assert "a program that is not kb_node" not in caplog.text


def test_a_late_node_is_not_foreign_with_ask_later(slow):
    client, liveliness = slow
    answers = queue.SimpleQueue()
    for _ in range(_OFTEN):
        bus.ask_later(client, keys.BRIDGE, "get", *ASKED, answers.put, timeout_s=0.01, liveliness=liveliness)
        with pytest.raises(bus.TimedOut, match="did not answer within"):
            answers.get(timeout=PATIENCE_S)()
