"""Queries between real sessions on loopback."""

from __future__ import annotations

import itertools
import queue
import threading
import time

import psutil
import pytest

from semmap.nodes import bus
from semmap.nodes.bus import query_client
from semmap.schemas import commands, errors, keys, replies
from tests.bus.conftest import PREFIX, answer
from tests.conftest import PATIENCE_S, until
from tests.waiting import until_served


def test_a_query_gets_its_reply(pair):
    server, client = pair
    bus.serve(server, PREFIX, answer(lambda request: replies.Done(text=request.read(commands.Get).name)))
    reply = bus.ask(client, PREFIX, "get", commands.Get(name="chair1"), replies.Done)
    assert reply == replies.Done(text="chair1")


def test_an_error_reply_is_raised_with_its_code(pair):
    server, client = pair

    def refuse(request):
        raise errors.NameTaken("the name 'x' is taken")

    bus.serve(server, PREFIX, answer(refuse))
    with pytest.raises(errors.NameTaken, match="taken"):
        bus.ask(client, PREFIX, "add", commands.Get(name="x"), replies.Done)


def test_without_a_queryable_it_is_no_answer(pair):
    _, client = pair
    with pytest.raises(errors.NoAnswer, match="no node serves it"):
        bus.ask(client, PREFIX, "get", commands.Get(name="x"), replies.Done, patience_s=0.2)


def test_a_late_reply_is_no_answer(pair):
    server, client = pair
    kept = []
    bus.serve(server, PREFIX, kept.append)
    with pytest.raises(errors.NoAnswer, match=r"within 0\.2 s"):
        bus.ask(client, PREFIX, "get", commands.Get(name="x"), replies.Done, timeout_s=0.2)


def test_only_quick_queries_are_repeated_after_a_time_out(pair, monkeypatch):
    server, client = pair
    monkeypatch.setattr("semmap.nodes.bus.query_client._ROUND_S", 0.3)
    asked = []

    def receive(request):
        asked.append(request)
        if len(asked) == 2:
            request.reply(replies.Done(text="the second time"))

    bus.serve(server, PREFIX, receive)
    reply = bus.ask(client, PREFIX, "get", commands.Get(name="x"), replies.Done, timeout_s=20)
    assert reply.text == "the second time"
    asked.clear()
    with pytest.raises(errors.NoAnswer, match=r"within 0\.7 s"):
        bus.ask(client, PREFIX, "export", commands.Export(), replies.Done, timeout_s=0.7)
    until(lambda: asked, "it has come")
    assert len(asked) == 1


def test_queries_with_long_time_outs_leave_no_memory_when_they_were_quick(pair, monkeypatch):
    server, client = pair
    monkeypatch.setattr("semmap.nodes.bus.query_client._ROUND_S", 0.2)
    bus.serve(server, PREFIX, answer(lambda request: replies.Done(text="here")))
    process = psutil.Process()

    def ask_often() -> None:
        for _ in range(3000):
            bus.ask(client, PREFIX, "get", commands.Get(name="x"), replies.Done, timeout_s=3600.0)

    def leave_nothing() -> bool:
        before = process.memory_full_info().uss
        ask_often()
        for _ in range(50):  # they are forgotten when their time is up
            if process.memory_full_info().uss - before < 1.5e6:
                return True
            time.sleep(0.1)
        return False

    # with a time-out of an hour each round would leave 3.4 MB; what Zenoh sets up for itself comes once
    assert any(leave_nothing() for _ in range(4))


ASKED = (commands.Get(name="x"), replies.Done)


def gone_when_asked(server, liveliness):
    """A node that received a query and loses its token without ending it, as if the query were lost."""
    kept = []
    token = server.liveliness().declare_token(keys.live_key("kb_node", "1"))
    until(lambda: liveliness.is_there("kb_node"), "the token is seen")

    def lose(request):
        if not kept:
            token.undeclare()
        kept.append(request)

    return lose


def test_a_query_that_was_lost_with_its_node_is_repeated(pair):
    server, client = pair
    liveliness = bus.LivelinessMonitor(client)
    lose = gone_when_asked(server, liveliness)
    asked = []

    def receive(request):
        asked.append(request)
        lose(request) if len(asked) == 1 else request.reply(replies.Done(text="here"))

    bus.serve(server, keys.BRIDGE, receive)
    assert bus.ask(client, keys.BRIDGE, "get", *ASKED, liveliness=liveliness).text == "here"
    assert len(asked) == 2


def test_a_query_to_a_node_of_a_single_verb_is_repeated(pair):
    server, client = pair
    liveliness = bus.LivelinessMonitor(client)
    bus.serve(server, keys.CMD, gone_when_asked(server, liveliness), verb="sparql")
    until_served(client, f"{keys.CMD}/sparql")
    bus.serve(client, keys.CMD, answer(lambda _: replies.Done(text="second hand")))
    reply = bus.ask(client, keys.CMD, "sparql", *ASKED, prefer_complete=True, liveliness=liveliness)
    assert reply.text == "second hand"


class Clock:
    """A clock that can be put forward."""

    def __init__(self):
        self.ahead_s = 0.0
        self.sleep = time.sleep

    def monotonic(self):
        return time.monotonic() + self.ahead_s


def test_patience_begins_when_the_node_with_the_query_goes(pair, monkeypatch):
    server, client = pair
    clock = Clock()
    monkeypatch.setattr(query_client, "time", clock)
    liveliness = bus.LivelinessMonitor(client)
    token = server.liveliness().declare_token(keys.live_key("kb_node", "1"))
    kept = []
    numbers = itertools.count()

    def receive(request):
        number = next(numbers)
        if number == 0:
            kept.append(request)
            clock.ahead_s += 2 * PATIENCE_S  # the node has the query for this time
            token.undeclare()
        elif number == 2:
            request.reply(replies.Done(text="back"))

    bus.serve(server, keys.BRIDGE, receive)
    until(lambda: liveliness.is_there("kb_node"), "the token is seen")
    how = {"patience_s": PATIENCE_S, "liveliness": liveliness}
    assert bus.ask(client, keys.BRIDGE, "get", *ASKED, **how).text == "back"


def test_a_busy_machine_is_not_taken_for_a_restarting_node(pair, monkeypatch):
    _, client = pair
    asked = itertools.count()

    def ask_slowly(*args, **how):
        assert next(asked) < 20, "it was to give up"
        time.sleep(0.15)
        return ()

    monkeypatch.setattr("semmap.nodes.bus.query_client._get", ask_slowly)
    with pytest.raises(errors.NoAnswer):
        bus.ask(client, keys.BRIDGE, "get", *ASKED, patience_s=0.3, liveliness=bus.LivelinessMonitor(client))


def test_ask_later_reports_that_the_node_went(pair):
    server, client = pair
    answers: queue.SimpleQueue = queue.SimpleQueue()
    liveliness = bus.LivelinessMonitor(client)
    bus.serve(server, keys.BRIDGE, gone_when_asked(server, liveliness))
    until_served(client, f"{keys.BRIDGE}/get")
    bus.ask_later(client, keys.BRIDGE, "get", *ASKED, answers.put, liveliness=liveliness)
    with pytest.raises(errors.NoAnswer, match="kb_node is not running"):
        answers.get(timeout=PATIENCE_S)()


def test_a_query_with_a_cancelled_token_ends(pair):
    _, client = pair
    liveliness = bus.LivelinessMonitor(client)
    liveliness.token_for(("kb_node",)).cancel()
    answers: queue.SimpleQueue = queue.SimpleQueue()
    bus.ask_later(client, keys.BRIDGE, "get", *ASKED, answers.put, liveliness=liveliness)
    with pytest.raises(errors.NoAnswer):
        answers.get(timeout=PATIENCE_S)()
    with pytest.raises(errors.NoAnswer):
        bus.ask(client, keys.BRIDGE, "get", *ASKED, patience_s=0.0, liveliness=liveliness)


def test_a_query_is_repeated_until_a_node_serves(pair):
    server, client = pair
    serve = threading.Timer(
        0.4, lambda: bus.serve(server, PREFIX, answer(lambda _: replies.Done(text="here")))
    )
    serve.start()
    reply = bus.ask(client, PREFIX, "get", commands.Get(name="x"), replies.Done, patience_s=PATIENCE_S)
    assert reply.text == "here"
    serve.join()


def test_ask_later_calls_back_once_without_a_queryable(pair):
    _, client = pair
    answers: queue.SimpleQueue = queue.SimpleQueue()
    bus.ask_later(client, PREFIX, "get", commands.Get(name="x"), replies.Done, answers.put)
    read = answers.get(timeout=PATIENCE_S)
    with pytest.raises(errors.NoAnswer, match="no node serves it"):
        read()
    assert answers.empty()
