"""Standing queries with a slow reader."""

from __future__ import annotations

import os
import time
from multiprocessing.connection import Connection

from msgspec import Raw, msgpack

from semmap.nodes.kb_node.sparql.protocol import CommandReply, QueryOutcome, QueryUpdate, questions
from semmap.nodes.kb_node.sparql.standing_queries.continuous_query_monitor import ContinuousQueryMonitor
from semmap.schemas.commands import Watch
from semmap.schemas.sparql import SparqlResult


class Slow:
    """A reader that replies when the test tells it to."""

    def __init__(self, lane: Connection):
        self._lane = Connection(os.dup(lane.fileno()))

    def answer(self):
        question = questions.decode(self._lane.recv_bytes())
        result = msgpack.encode(SparqlResult(kind="select", variables=("c",), seq=question.seq))
        self._lane.send_bytes(msgpack.encode(QueryOutcome(number=question.number, result=Raw(result))))

    def end(self):
        self._lane.close()


def test_a_lease_begins_with_the_first_rows():
    sent, readers = [], []

    def hire(lane):
        readers.append(Slow(lane))
        return readers[-1]

    monitor = ContinuousQueryMonitor(sent.append, hire)
    monitor.handle(1, Watch(query="SELECT ?c { ?c a dm:Chair }", watch="w", lease=0.01), seq=3)
    assert monitor.timeout_s is None
    time.sleep(0.02)
    monitor.advance()
    readers[0].answer()
    monitor.on_ready(*monitor.connections)
    assert [type(message) for message in sent] == [CommandReply]
    time.sleep(0.02)
    monitor.advance()
    assert [type(message) for message in sent] == [CommandReply, QueryUpdate]
    assert sent[1].ended
    monitor.stop_readers()
