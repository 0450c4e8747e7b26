"""The published state of a node."""

from __future__ import annotations

import os
import re
import time
from types import SimpleNamespace

import pytest

from semmap.nodes import bus
from semmap.nodes.runtime import heartbeat
from semmap.nodes.runtime.heartbeat import Heartbeat
from semmap.schemas import keys
from semmap.schemas.health import Health
from tests.conftest import free_endpoint, until


@pytest.fixture
def heard():
    """A heartbeat, its subscriber, and the received messages."""
    endpoint = free_endpoint()
    peer = bus.Network(mode="peer", listen=(endpoint,), connect=())
    with bus.open_session(peer) as session, bus.open_session(bus.Network(connect=(endpoint,))) as client:
        beats: list[Health] = []
        bus.follow(client, keys.HEALTH, lambda _, health: beats.append(health))
        one = Heartbeat("test_node", session)
        until(lambda: one._health.matching_status.matching, "a subscriber")
        yield one, client, beats


def count(beats, number):
    return until(lambda: len(beats) == number and beats[-1], f"{number} beats")


def test_it_is_published_when_due_and_not_earlier(heard, monkeypatch):
    one, _, beats = heard
    now_s = 100.0
    clock = SimpleNamespace(monotonic=lambda: now_s, time_ns=time.time_ns)
    monkeypatch.setattr(heartbeat, "time", clock)
    one.beat()
    due_s, now_s = one.due_s, one.due_s - 0.01
    one.beat()
    assert (due_s, one.due_s) == (101.0, 101.0)
    now_s = due_s
    one.beat()
    count(beats, 2)
    first = beats[0]
    assert (first.node, first.pid, first.state) == ("test_node", os.getpid(), "starting")


def test_ready_is_published_immediately(heard):
    one, client, beats = heard
    one.beat()
    assert not list(client.liveliness().get(keys.live_key("*")))
    one.ready("so many entities")
    assert (count(beats, 2).state, beats[-1].detail) == ("ready", "so many entities")
    (token,) = until(lambda: list(client.liveliness().get(keys.live_key("*"))), "the token")
    assert str(token.ok.key_expr) == keys.live_key("test_node", str(one._session.info.zid()))


def test_an_error_is_in_the_next_heartbeats_for_a_while(heard, monkeypatch):
    one, _, beats = heard
    one.beat()
    one.report("oops")
    one.beat()
    assert re.fullmatch(r"\d\d:\d\d:\d\d oops", count(beats, 2).last_error)
    monkeypatch.setattr(heartbeat, "_ERROR_SHOWN_S", 0.0)
    one.report("oops again")
    one.beat()
    assert not count(beats, 3).last_error


def test_dropped_messages_are_counted_and_their_reason_is_noted_once(heard):
    one, _, beats = heard
    one.note(("a note",))
    for _ in range(3):
        one.drop("poses dropped: a number is not finite")
    one.beat()
    last = count(beats, 1)
    assert last.notes == ("a note", "poses dropped: a number is not finite")
    assert last.ignored == 3
    for number in range(100):
        one.drop(f"reason {number}")
    one.due_s = 0.0
    one.beat()
    last = count(beats, 2)
    assert (len(last.notes), last.ignored) == (1 + heartbeat._MAX_DROPPED, 103)
