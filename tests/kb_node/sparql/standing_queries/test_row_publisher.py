"""Changed rows are published on the key of their query."""

from __future__ import annotations

import pytest

from semmap.nodes.kb_node.sparql.protocol import QueryUpdate
from semmap.nodes.kb_node.sparql.standing_queries.row_publisher import RowPublisher
from semmap.schemas import codec, keys
from semmap.schemas.sparql import RowsChanged


class Publisher:
    def __init__(self, key):
        self.key, self.rows, self.is_there = key, [], True

    def put(self, payload, encoding):
        assert self.is_there
        self.rows.append(codec.decode(bytes(payload), RowsChanged))

    def undeclare(self):
        self.is_there = False


@pytest.fixture
def publishers(monkeypatch):
    made = []

    def declare(session, topic, key):
        made.append(Publisher(key))
        return made[-1]

    monkeypatch.setattr("semmap.nodes.bus.publisher", declare)
    return made


def rows(seq):
    return RowsChanged(watch="w", seq=seq, since=0, appeared=(("<urn:a>",),), disappeared=())


def test_each_query_has_a_publisher_until_it_ends(publishers):
    out = RowPublisher(None)
    out.publish(QueryUpdate(watch="w1", rows=rows(1)))
    out.publish(QueryUpdate(watch="w2", rows=rows(1)))
    out.publish(QueryUpdate(watch="w1", rows=rows(2)))
    assert [one.key for one in publishers] == [keys.query_key("w1"), keys.query_key("w2")]
    assert [one.seq for one in publishers[0].rows] == [1, 2]
    out.publish(QueryUpdate(watch="w1", ended=True))
    assert [one.is_there for one in publishers] == [False, True]
    out.publish(QueryUpdate(watch="w1", ended=True))
    out.publish(QueryUpdate(watch="w2", rows=rows(3), ended=True))
    assert [len(one.rows) for one in publishers] == [2, 2]
    assert not publishers[1].is_there


def test_a_change_that_is_too_large_is_replaced_by_an_error(publishers, monkeypatch):
    out = RowPublisher(None)
    size = len(codec.encode(rows(1)))
    for most, error in ((size, None), (size - 1, "run the query again")):
        monkeypatch.setattr("semmap.nodes.bus.PUBLICATION_BYTES", most)
        out.publish(QueryUpdate(watch="w1", rows=rows(1)))
        sent = publishers[0].rows[-1]
        assert bool(sent.appeared) == (error is None)
        assert error is None or error in sent.error
