"""What others hear of a node's state."""

from __future__ import annotations

import os
import re
import time

import pytest

from nodes import bus
from nodes.runtime import heartbeat
from nodes.runtime.heartbeat import Heartbeat
from schemas import keys
from schemas.health import Health
from tests.conftest import free_endpoint, until


@pytest.fixture
def heard():
    """A heartbeat, who listens to it, and what it has heard."""
    endpoint = free_endpoint()
    peer = bus.Network(mode="peer", listen=(endpoint,), connect=())
    with bus.open_session(peer) as session, bus.open_session(bus.Network(connect=(endpoint,))) as client:
        beats: list[Health] = []
        bus.follow(client, keys.HEALTH, lambda _, health: beats.append(health))
        one = Heartbeat("test_node", session)
        until(lambda: one._health.matching_status.matching, "somebody who listens")
        yield one, client, beats


def count(beats, number):
    return until(lambda: len(beats) == number and beats[-1], f"{number} beats")


def test_it_beats_when_it_is_due_and_no_sooner(heard):
    one, _, beats = heard
    one.beat()
    first = count(beats, 1)
    assert (first.node, first.pid, first.state) == ("test_node", os.getpid(), "starting")
    one.beat()
    assert one.due_s > time.monotonic()
    time.sleep(max(0.0, one.due_s - time.monotonic()))
    one.beat()
    assert count(beats, 2).stamp_ns > first.stamp_ns + 0.9e9


def test_that_a_node_is_ready_is_told_at_once(heard):
    one, client, beats = heard
    one.beat()
    assert not list(client.liveliness().get(keys.live_key("*")))
    one.ready("so many entities")
    assert (count(beats, 2).state, beats[-1].detail) == ("ready", "so many entities")
    (token,) = until(lambda: list(client.liveliness().get(keys.live_key("*"))), "the token")
    assert str(token.ok.key_expr) == keys.live_key("test_node", str(one._session.info.zid()))


def test_an_error_is_told_with_the_next_beat_and_for_a_while(heard, monkeypatch):
    one, _, beats = heard
    one.beat()
    one.report("oops")
    one.beat()
    assert re.fullmatch(r"\d\d:\d\d:\d\d oops", count(beats, 2).last_error)
    monkeypatch.setattr(heartbeat, "_ERROR_SHOWN_S", 0.0)
    one.report("oops again")
    one.beat()
    assert not count(beats, 3).last_error
