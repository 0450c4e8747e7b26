"""Presence of nodes, and cancellation of queries to nodes that are gone."""

from __future__ import annotations

import pytest

from semmap.nodes import bus
from semmap.schemas import keys
from tests.conftest import until


@pytest.fixture
def lifelines_and_token(pair):
    """A session's view of a kb_node that came before it."""
    server, client = pair
    token = server.liveliness().declare_token(keys.live_key("kb_node", "7"))
    liveliness = bus.LivelinessMonitor(client)
    until(lambda: liveliness.is_there("kb_node"), "it is seen")
    return liveliness, token


def test_a_node_with_a_token_is_there(pair, lifelines_and_token):
    liveliness, token = lifelines_and_token
    assert not liveliness.is_there("coordinator")
    newer = pair[0].liveliness().declare_token(keys.live_key("kb_node", "8"))
    cut = liveliness.token_for(("kb_node",))
    token.undeclare()
    until(lambda: cut.is_cancelled, "the older one is gone")
    assert liveliness.is_there("kb_node")
    newer.undeclare()
    until(lambda: not liveliness.is_there("kb_node"), "both are gone")


def test_present_robots_are_reported_before_it_returns(pair):
    server, client = pair
    names = ("arm1", "arm2")
    tokens = [server.liveliness().declare_token(f"{name}/{keys.live_key('kb_node', '7')}") for name in names]
    until(lambda: set(names) <= set(bus.find_robots(client)), "they are seen")
    there = bus.Network(connect=(f"{client.info.links()[0].dst}",))
    for _ in range(20):  # publications are sometimes as fast without it
        told = []
        with bus.open_session(there) as newcomer:
            _follower = bus.follow_robots(newcomer, "kb_node", lambda *said, told=told: told.append(said))
            assert sorted(told) == [(name, "7", True) for name in names]
    told = []
    with bus.open_session(there) as newcomer:
        _follower = bus.follow_robots(newcomer, "kb_node", lambda *said: told.append(said))
        tokens[0].undeclare()
        until(lambda: len(told) > 2, "that one has gone")
        later = server.liveliness().declare_token(f"arm3/{keys.live_key('kb_node', '8')}")
        until(lambda: len(told) > 3, "that another has come")
    assert told[2:] == [("arm1", "7", False), ("arm3", "8", True)]
    later.undeclare()


def test_queries_to_a_node_are_cancelled_when_it_goes(lifelines_and_token):
    liveliness, token = lifelines_and_token
    old = [liveliness.token_for(("kb_node",)), liveliness.token_for(("kb_node", "coordinator"))]
    others = liveliness.token_for(("coordinator",))
    assert liveliness.token_for(("kb_node",)) is old[0]
    token.undeclare()
    until(lambda: all(lifeline.is_cancelled for lifeline in old), "the liveliness are cut")
    assert not others.is_cancelled
    assert not liveliness.token_for(("kb_node",)).is_cancelled


def test_a_session_has_gone_when_it_ends(pair):
    server, client = pair
    departures = bus.DepartureMonitor(server)
    with bus.open_session(bus.Network(connect=(f"{client.info.links()[0].dst}",))) as third:
        instance = str(third.zid())
        until(lambda: third.info.peers_zid() or third.info.routers_zid(), "it is linked")
        assert not departures.has_gone(instance)
    until(lambda: departures.has_gone(instance), "it has gone")
    assert not departures.has_gone(str(client.zid()))
    assert not departures.has_gone("never there")
