"""Publishers and subscribers between real sessions on loopback."""

from __future__ import annotations

import queue

import pytest

from semmap.nodes import bus
from semmap.schemas import codec, keys
from semmap.schemas.commits import Commit
from tests.conftest import PATIENCE_S
from tests.waiting import until_followed


def commit(seq: int) -> Commit:
    return Commit(seq=seq, stamp_ns=seq, id=str(seq), source="operator")


def test_commits_arrive_in_order_and_none_is_lost(pair):
    server, client = pair
    arrived: queue.SimpleQueue = queue.SimpleQueue()
    publisher = bus.publisher(server, keys.COMMIT)
    bus.follow(client, keys.COMMIT, lambda _, message: arrived.put(message.seq))
    until_followed(server, keys.COMMIT.key)
    for seq in range(1, 501):
        publisher.put(codec.encode(commit(seq)))
    assert [arrived.get(timeout=PATIENCE_S) for _ in range(500)] == list(range(1, 501))


def test_malformed_publications_are_ignored(pair):
    server, client = pair
    arrived: queue.SimpleQueue = queue.SimpleQueue()
    bus.follow(client, keys.COMMIT, lambda _, message: arrived.put(message))
    until_followed(server, keys.COMMIT.key)
    server.put(keys.COMMIT.key, b"\xc1 nonsense")
    server.put(keys.COMMIT.key, codec.encode(commit(1)))
    assert arrived.get(timeout=PATIENCE_S).seq == 1


@pytest.mark.parametrize(
    ("key_expr", "is_met"),
    [
        ("semmap/**", True),
        ("robot1/semmap/jena/commit", True),
        ("semmap/jena/entity/Cup/*", True),
        ("semmap/cmd/add", True),
        ("semmap/as/bob/cmd/add", True),
        ("no//expression", True),
        ("nosuch/key", False),
        ("semmap/jena/commits", False),
    ],
)
def test_key_expressions_are_compared_with_topics(key_expr, is_met):
    assert bus.intersects(keys.published(), key_expr) is is_met
