"""Standing queries with readers that reply when the test tells them to."""

from __future__ import annotations

import os
import signal
import time
from multiprocessing.connection import Connection

import pytest
from msgspec import Raw, msgpack

from semmap.nodes.kb_node.sparql.protocol import CommandReply, QueryOutcome, QueryUpdate, questions
from semmap.nodes.kb_node.sparql.standing_queries.continuous_query_monitor import ContinuousQueryMonitor
from semmap.nodes.kb_node.sparql.triples.dataset import Delta
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import Renew, Watch
from semmap.schemas.replies import Done
from semmap.schemas.sparql import SparqlResult, Watching

CHAIRS = "SELECT ?c { ?c a dm:Chair }"
TABLES = "SELECT ?c { ?c a dm:Table }"
A, B = ("<urn:a>",), ("<urn:b>",)


class Reader:
    """A reader that replies when the test tells it to."""

    def __init__(self, lane: Connection):
        self.lane = Connection(os.dup(lane.fileno()))
        self.has_ended = False

    def answer(self, rows, error):
        question = questions.decode(self.lane.recv_bytes())
        result = SparqlResult(kind="select", variables=("c",), rows=tuple(rows), seq=question.seq)
        outcome = QueryOutcome(
            number=question.number,
            result=Raw(msgpack.encode(result)),
            error=None if error is None else errors.to_message(error),
        )
        self.lane.send_bytes(msgpack.encode(outcome))
        return question

    def end(self):
        self.has_ended = True
        self.lane.close()

    def reap(self):
        self.has_ended = True
        return signal.SIGKILL


class Monitored:
    """A monitor, its readers, and what it has sent."""

    def __init__(self):
        self._sent, self.readers = [], []
        self.monitor = ContinuousQueryMonitor(self._sent.append, self._hire)

    def _hire(self, lane):
        self.readers.append(Reader(lane))
        return self.readers[-1]

    def watch(self, name="w", seq=1, query=CHAIRS, **fields):
        self.monitor.handle(7, Watch(query=query, watch=name, **fields), seq)

    def follow(self, seq, class_name="Chair", **fields):
        self.monitor.follow(Delta(seq=seq, inserted=(("<urn:a>", v.RDF_TYPE, v.dm(class_name)),), **fields))

    def answer(self, *rows, error=None):
        """Answer the query that is being evaluated, and return its text, its commit and the reader."""
        self.monitor.advance()
        (connection,) = self.monitor.connections
        at = next(k for k, one in enumerate(self.readers) if not one.has_ended and one.lane.poll())
        question = self.readers[at].answer(rows, error)
        self.monitor.on_ready(connection)
        return question.query, question.seq, at

    def is_idle(self):
        self.monitor.advance()
        return not list(self.monitor.connections)

    def told(self):
        """Return what was sent since the last call."""
        sent, self._sent[:] = list(self._sent), []
        return [self._describe(message) for message in sent]

    def _describe(self, message):
        if isinstance(message, QueryUpdate):
            rows = message.rows
            news = rows and (rows.since, rows.seq, rows.appeared, rows.disappeared, rows.error)
            return message.watch, news, "ended" if message.ended else "goes on"
        assert isinstance(message, CommandReply)
        assert message.number == 7
        if message.error is not None:
            return message.error.text
        try:
            return msgpack.decode(message.reply, type=Done).text
        except Exception:
            watching = msgpack.decode(message.reply, type=Watching)
            return watching.watch, watching.seq, watching.rows


@pytest.fixture
def monitored():
    made = Monitored()
    yield made
    made.monitor.stop_readers()


def test_a_lease_begins_with_the_first_rows(monitored):
    monitored.watch(seq=3, lease=0.01)
    assert monitored.monitor.timeout_s is None
    time.sleep(0.02)
    monitored.answer()
    assert monitored.told() == [("w", 3, ())]
    assert 0.0 <= monitored.monitor.timeout_s <= 0.01
    time.sleep(0.02)
    assert monitored.is_idle()
    assert monitored.told() == [("w", None, "ended")]
    assert monitored.monitor.timeout_s is None


def test_changed_rows_are_published_commit_by_commit(monitored):
    monitored.watch(seq=1)
    assert monitored.answer(A) == (CHAIRS, 1, 0)
    assert monitored.told() == [("w", 1, (A,))]
    monitored.follow(2)
    monitored.follow(3, "Table")  # which the query does not read
    monitored.follow(4)
    monitored.follow(5)
    assert [monitored.answer(*rows)[1] for rows in ([A, B], [A, B], [B])] == [2, 4, 5]
    assert monitored.is_idle()
    assert monitored.told() == [
        ("w", (1, 2, (B,), (), ""), "goes on"),
        ("w", (4, 5, (), (A,), ""), "goes on"),
    ]


def test_each_query_is_evaluated_for_itself(monitored):
    monitored.watch("chairs", 1, CHAIRS)
    monitored.watch("tables", 1, TABLES, inferred=True)
    assert list(monitored.monitor.inferred_queries) == [TABLES]
    assert [monitored.answer()[0] for _ in range(2)] == [CHAIRS, TABLES]
    monitored.follow(2, "Table")
    assert monitored.answer(A)[:2] == (TABLES, 2)
    assert monitored.is_idle()
    monitored.monitor.evaluate_all(3)
    assert [monitored.answer(B)[:2] for _ in range(2)] == [(CHAIRS, 3), (TABLES, 3)]
    assert monitored.told()[2:] == [
        ("tables", (1, 2, (A,), (), ""), "goes on"),
        ("chairs", (2, 3, (B,), (), ""), "goes on"),
        ("tables", (2, 3, (B,), (A,), ""), "goes on"),
    ]
    assert len(monitored.readers) == 1


def test_a_query_is_renewed_and_ended(monitored):
    monitored.watch("w", lease=30.0)
    monitored.watch("other", query=TABLES)
    monitored.answer()
    monitored.answer()
    monitored.told()
    monitored.monitor.handle(7, Renew(watch="w"), 2)
    assert monitored.told() == ["w is renewed for 30 s"]
    assert monitored.monitor.timeout_s > 29.0
    monitored.follow(2)
    monitored.monitor.evaluate_all(3)
    monitored.monitor.handle(7, Renew(watch="w", end=True), 3)
    assert monitored.told() == [("w", None, "ended"), "w has ended"]
    assert monitored.answer()[:2] == (TABLES, 3)
    assert monitored.is_idle()
    for end in (True, False):
        with pytest.raises(errors.UnknownName, match="there is no standing query 'w', or it has ended"):
            monitored.monitor.handle(7, Renew(watch="w", end=end), 3)


def test_a_query_that_ends_while_it_is_evaluated_publishes_nothing_more(monitored):
    monitored.watch()
    monitored.answer()
    monitored.follow(2)
    monitored.monitor.advance()
    monitored.monitor.handle(7, Renew(watch="w", end=True), 2)
    monitored.told()
    monitored.answer(A)
    assert monitored.told() == []


def test_a_query_that_fails_ends_with_the_reason(monitored):
    monitored.watch("first")
    monitored.answer(error=errors.Refused("too many rows"))
    failed = ("first", (1, 1, (), (), "too many rows"), "ended")
    assert monitored.told() == ["too many rows", failed]
    monitored.watch("w")
    monitored.answer(A)
    monitored.told()
    monitored.follow(4)
    monitored.follow(5)
    monitored.answer(error=errors.Refused("too slow"))
    assert monitored.told() == [("w", (5, 5, (), (), "too slow"), "ended")]
    assert monitored.is_idle()


def test_a_reader_that_was_killed_is_replaced(monitored):
    monitored.watch("w")
    monitored.watch("other", query=TABLES)
    monitored.answer()
    monitored.answer()
    monitored.told()
    monitored.monitor.evaluate_all(2)
    monitored.monitor.evaluate_all(3)
    monitored.monitor.advance()
    (connection,) = monitored.monitor.connections
    monitored.readers[0].lane.close()
    monitored.monitor.on_ready(connection)
    error = "the query was cancelled: its process was killed; repeat it"
    assert monitored.told() == [("w", (3, 3, (), (), error), "ended")]
    assert monitored.answer(A) == (TABLES, 3, 1)  # both evaluations in one step
    assert monitored.told() == [("other", (1, 3, (A,), (), ""), "goes on")]
    assert monitored.is_idle()


def test_a_new_reader_continues_where_the_present_one_cannot_follow(monitored):
    monitored.monitor.renew_reader()
    assert monitored.readers == []  # there is none yet
    monitored.watch()
    monitored.answer()
    monitored.told()
    monitored.follow(2)
    monitored.monitor.renew_reader()
    monitored.follow(3)
    assert monitored.answer(A) == (CHAIRS, 2, 0)
    assert monitored.answer(B) == (CHAIRS, 3, 1)
    assert [reader.has_ended for reader in monitored.readers] == [True, False]
    assert [news[:2] for _, news, _ in monitored.told()] == [(1, 2), (2, 3)]


def test_a_new_reader_that_is_too_far_behind_as_well_is_replaced_and_evaluates_in_one_step(monitored):
    monitored.watch()
    monitored.watch("other", query=TABLES)
    monitored.answer()
    monitored.answer()
    monitored.told()
    monitored.follow(2)
    monitored.monitor.advance()
    monitored.monitor.renew_reader()
    monitored.follow(3)
    monitored.monitor.renew_reader()
    monitored.follow(4)
    monitored.monitor.evaluate_all(5)
    assert monitored.answer(A) == (CHAIRS, 2, 0)  # it had begun
    assert monitored.answer(B) == (CHAIRS, 5, 2)
    assert monitored.answer(B) == (TABLES, 5, 2)
    assert monitored.is_idle()
    assert [reader.has_ended for reader in monitored.readers] == [True, True, False]
    assert [(watch, *news[:2]) for watch, news, _ in monitored.told()] == [
        ("w", 1, 2),
        ("w", 2, 5),
        ("other", 4, 5),
    ]


def test_queries_have_names_of_their_own_and_a_limited_number(monitored):
    monitored.watch("w")
    with pytest.raises(errors.NameTaken, match="there is a standing query 'w' already"):
        monitored.watch("w")
    with pytest.raises(errors.BadRequest, match="only a SELECT query can be watched"):
        monitored.watch("ask", query="ASK { ?a ?b ?c }")
    for _ in range(63):
        monitored.watch(None)
    with pytest.raises(errors.Refused, match="there are 64 standing queries already; end one first"):
        monitored.watch(None)
    for _ in range(64):
        monitored.answer()
    assert len({watch for watch, _, _ in monitored.told()}) == 64
