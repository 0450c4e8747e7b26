"""The node's ends of the lanes; the test acts as the readers and the process that forks them."""

import signal

import pytest
from msgspec import Raw, msgpack

from semmap.nodes.kb_node.sparql import lanes
from semmap.nodes.kb_node.sparql.lanes import LANES, LONG_RUNNING, Lanes
from semmap.nodes.kb_node.sparql.protocol import (
    QueryOutcome,
    ReaderExited,
    StartReader,
    StopReader,
    questions,
)
from semmap.schemas import errors
from semmap.schemas.commands import Sparql
from semmap.schemas.sparql import SparqlResult
from tests.conftest import until

WAIT_S = 30.0


class Readers:
    """The messages to the process, and the readers' ends."""

    def __init__(self):
        self.sent = []
        self.lanes = Lanes(self._send)

    def _send(self, message, connection):
        if connection is None:
            self.sent.append(message)
        else:
            connection.send_bytes(msgpack.encode(message))

    def ask(self, query):
        return self.lanes.ask(Sparql(query=query, timeout=1.5), 7)

    def asked(self):
        """Return the lanes in which a query waits for a reader."""
        return [number for number, lane in enumerate(self.lanes.remote_ends) if lane.poll(0)]

    def take(self, lane):
        assert self.lanes.remote_ends[lane].poll(WAIT_S)
        return questions.decode(self.lanes.remote_ends[lane].recv_bytes())

    def answer(self, lane, question, **outcome):
        result = Raw(msgpack.encode(SparqlResult(kind="ask", seq=7, verdict=True)))
        message = QueryOutcome(number=question.number, **({"result": result} | outcome))
        self.lanes.remote_ends[lane].send_bytes(msgpack.encode(message))


@pytest.fixture
def readers():
    made = Readers()
    yield made
    for connection in made.lanes.remote_ends:
        connection.close()


def test_each_query_has_a_lane_and_lanes_with_readers_come_first(readers):
    first = readers.ask("a")
    second = readers.ask("b")
    assert readers.sent == [StartReader(lane=0), StartReader(lane=1)]
    readers.answer(1, readers.take(1))
    assert second.result(WAIT_S).verdict
    third = readers.ask("c")
    assert readers.take(1).query == "c"
    assert readers.sent == [StartReader(lane=0), StartReader(lane=1)]
    assert not first.done()
    assert not third.done()


def test_a_query_without_a_lane_waits(readers):
    futures = [readers.ask(str(number)) for number in range(LANES + 1)]
    taken = [readers.take(lane) for lane in range(LANES)]
    assert not readers.lanes.remote_ends[2].poll(0)
    readers.answer(2, taken[2])
    assert futures[2].result(WAIT_S).verdict
    assert readers.take(2).query == str(LANES)


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (signal.SIGALRM, "cancelled after 1.5 s"),
        (signal.SIGKILL, "was killed; repeat it"),
        (signal.SIGSEGV, "it ended its process .signal 11.; simplify it"),
    ],
)
def test_a_query_that_ends_its_reader_fails(readers, number, text):
    future = readers.ask("endless")
    late = readers.take(0)
    readers.lanes.on_reader_exit(ReaderExited(lane=0, signal=number))
    with pytest.raises(errors.Refused, match=text):
        future.result(WAIT_S)
    following = readers.ask("next")
    assert readers.sent == [StartReader(lane=0), StartReader(lane=0)]
    readers.answer(0, late)  # no client waits for it
    readers.answer(0, readers.take(0))
    assert following.result(WAIT_S).verdict


def test_the_query_of_a_reader_that_exits_goes_to_the_next_one(readers):
    future = readers.ask("unread")
    readers.lanes.on_reader_exit(ReaderExited(lane=0, signal=0))
    assert readers.sent == [StartReader(lane=0), StartReader(lane=0)]
    given_back = readers.take(0)
    readers.answer(0, given_back, old=True)
    readers.lanes.on_reader_exit(ReaderExited(lane=0, signal=0))
    again = readers.take(0)
    assert again == given_back
    readers.answer(0, again)
    assert future.result(WAIT_S).verdict


def test_a_long_query_is_sent_by_another_thread_in_one_piece(readers):
    future = readers.ask("x" * 100_000)
    readers.answer(0, readers.take(0))
    assert future.result(WAIT_S).verdict


def test_closing_fails_all_queries(readers):
    futures = [readers.ask("x") for _ in range(LANES + 2)]
    readers.lanes.close(errors.Refused("over"))
    for future in futures:
        with pytest.raises(errors.Refused, match="over"):
            future.result(WAIT_S)


def begun(readers, count, name="long"):
    """Start so many queries, each with a lane."""
    futures = [readers.ask(f"{name} {number}") for number in range(count)]
    return futures, [readers.take(lane) for lane in range(count)]


def test_a_long_running_query_is_preempted_and_started_again_if_others_wait(readers, monkeypatch):
    monkeypatch.setattr(lanes, "LONG_S", 0.05)
    futures, taken = begun(readers, LANES)
    quick = readers.ask("quick")
    until(lambda: StopReader(lane=LONG_RUNNING) in readers.sent, "one is set aside")
    readers.lanes.on_reader_exit(ReaderExited(lane=LONG_RUNNING, signal=0))
    assert readers.sent[-1] == StartReader(lane=LONG_RUNNING)
    question = readers.take(LONG_RUNNING)
    assert question.query == "quick"
    readers.answer(LONG_RUNNING, question)
    assert quick.result(WAIT_S).verdict
    assert readers.asked() == []  # enough other queries are long-running
    readers.answer(0, taken[0])
    for lane in range(LONG_RUNNING + 1, LANES):
        readers.answer(lane, taken[lane])
    (again,) = until(readers.asked, "it is started again")
    question = readers.take(again)
    assert question == taken[LONG_RUNNING]
    readers.answer(again, question)
    assert futures[LONG_RUNNING].result(WAIT_S).verdict


def test_no_query_is_preempted_if_none_waits(readers, monkeypatch):
    monkeypatch.setattr(lanes, "LONG_S", 0.0)
    begun(readers, LANES)
    readers.lanes._preempt()
    assert all(isinstance(sent, StartReader) for sent in readers.sent)
    assert readers.lanes._timer is None


def test_clients_take_turns(readers):
    _, taken = begun(readers, LANES)
    for number in range(5):
        readers.lanes.ask(Sparql(query=f"a{number}"), 7, asker="a")
    readers.lanes.ask(Sparql(query="b0"), 7, asker="b")
    order = []
    for _ in range(6):
        readers.answer(0, taken[0])
        taken[0] = readers.take(0)
        order.append(taken[0].query)
    assert order == ["a0", "b0", "a1", "a2", "a3", "a4"]


def test_too_many_queries_are_rejected(readers):
    begun(readers, LANES)
    for _ in range(64):
        readers.ask("x")
    with pytest.raises(errors.Busy, match="64 SPARQL queries are waiting"):
        readers.ask("x")
