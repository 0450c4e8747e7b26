"""The SPARQL worker in this process, with its own readers, and lanes that the test uses."""

from multiprocessing.connection import Pipe, wait

import pytest
from msgspec import msgpack

from semmap.nodes.kb_node.sparql import worker
from semmap.nodes.kb_node.sparql.protocol import (
    Committed,
    Load,
    QueryRequest,
    ReaderExited,
    StartReader,
    outcomes,
)
from semmap.nodes.kb_node.sparql.triples.dataset import Delta
from semmap.ontology import vocabulary as v
from semmap.schemas.sparql import SparqlResult
from tests.conftest import until
from tests.kb_node import home

WAIT_S = 60.0
SEATS = "SELECT ?c { ?c a dm:Seat }"
CHAIRS = "SELECT ?c { ?c a dm:Chair }"


class Process:
    """A worker, the remote ends of its lanes, and the messages that it sent."""

    def __init__(self, *, infers):
        self.sent = []
        self.lanes, self._theirs = zip(*(Pipe() for _ in range(2)), strict=True)
        self.worker = worker.Worker(self.sent.append, self._theirs)
        self.worker.take(Load(seq=0, asserted=tuple(home.TBOX), infers=infers))
        self.seq = 0

    def commit(self):
        """Add a chair."""
        self.seq += 1
        chair = (v.entity_iri(f"c{self.seq}"), v.RDF_TYPE, v.dm("Chair"))
        self.worker.take(Committed(delta=Delta(seq=self.seq, inserted=(chair,))))

    def ask(self, lane, query, *, seq=None, inferred=False):
        question = QueryRequest(
            number=1,
            seq=self.seq if seq is None else seq,
            query=query,
            inferred=inferred,
            limit=100,
            timeout_s=10.0,
        )
        self.lanes[lane].send_bytes(msgpack.encode(question))

    def await_taken(self, lane):
        """Wait until a reader has taken the query."""
        until(lambda: not self._theirs[lane].poll(0), "a reader has taken the question")

    def hire(self, lane):
        self.worker.take(StartReader(lane=lane))

    def hear(self, lane):
        assert self.lanes[lane].poll(WAIT_S)
        return outcomes.decode(self.lanes[lane].recv_bytes())

    def rows(self, lane):
        return len(msgpack.decode(self.hear(lane).result, type=SparqlResult).rows)

    def bury_one(self):
        """Wait for the exit of a reader."""
        self.worker.done(wait(list(self.worker.connections), WAIT_S)[0])
        return self.sent.pop()


@pytest.fixture
def process(monkeypatch):
    monkeypatch.setattr(worker, "BACKLOG", 10)
    made = Process(infers=False)
    yield made
    made.worker.end()


@pytest.fixture
def inferring(monkeypatch):
    monkeypatch.setattr(worker, "BACKLOG", 30)
    made = Process(infers=True)
    yield made
    made.worker.end()


def test_a_reader_is_up_to_date_when_it_is_queried(process):
    process.commit()
    process.hire(0)
    for number in range(1, 6):
        process.ask(0, CHAIRS)
        assert process.rows(0) == number
        process.commit()


def test_a_query_waits_for_its_commit(process):
    process.hire(0)
    process.ask(0, CHAIRS, seq=2)
    process.await_taken(0)
    process.commit()
    process.commit()
    assert process.rows(0) == 2


def test_readers_read_inferences_of_later_commits(inferring):
    inferring.hire(0)
    for number in range(1, 4):
        inferring.commit()
        inferring.ask(0, SEATS, inferred=True)
        assert inferring.rows(0) == number


def test_a_reader_that_is_too_old_exits_and_leaves_the_query(process):
    process.hire(0)
    for _ in range(11):
        process.commit()
    assert process.bury_one() == ReaderExited(lane=0, signal=0)
    process.ask(0, CHAIRS)
    process.hire(0)
    assert process.rows(0) == 11


def test_a_reader_that_has_taken_the_query_returns_it(process):
    process.hire(0)
    process.ask(0, SEATS, inferred=True)  # its triples are too old for it
    process.await_taken(0)
    process.worker.take(Load(seq=0, asserted=tuple(home.TBOX), infers=True))
    assert process.hear(0).old
    assert process.bury_one() == ReaderExited(lane=0, signal=0)


def test_lanes_have_different_readers(process):
    process.commit()
    process.hire(0)
    process.hire(1)
    process.ask(1, CHAIRS)
    assert process.rows(1) == 1
    assert not process.lanes[0].poll(0)
