"""What a reader does with a query, without a process of its own."""

from __future__ import annotations

import signal

import pytest

from semmap.nodes.kb_node.sparql import readers
from semmap.nodes.kb_node.sparql.protocol import QueryRequest, outcomes
from semmap.nodes.kb_node.sparql.triples.dataset import Dataset, Delta
from semmap.schemas import errors
from tests.kb_node.home import turtle


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (signal.SIGALRM, "cancelled after 2.5 s, its time limit; narrow it"),
        (signal.SIGABRT, "needs more than 1024 MB of memory; narrow it"),
        (signal.SIGKILL, "its process was killed; repeat it"),
        (signal.SIGSEGV, "it ended its process (signal 11); simplify it"),
    ],
)
def test_the_signal_that_ended_a_reader_is_explained(number, text):
    error = readers.error_for_signal(number, 2.5)
    assert isinstance(error, errors.Refused)
    assert text in error.text


def question(query="ASK { ?s ?p ?o }", **fields):
    return QueryRequest(
        **{"number": 4, "seq": 7, "query": query, "inferred": False, "limit": 10, "timeout_s": 60.0, **fields}
    )


class Log:
    """Later commits, each of which is read once."""

    def __init__(self, *deltas):
        self.deltas = list(deltas)

    def read_new(self):
        while self.deltas:
            yield self.deltas.pop(0)


@pytest.fixture
def dataset():
    return Dataset(7, turtle(":a a dm:Chair . :b a dm:Chair ."))


@pytest.mark.parametrize(
    ("fields", "infers", "is_ready"),
    [
        ({}, False, True),
        ({"seq": 6}, False, True),
        ({"seq": 8}, False, False),
        ({"demand": 1}, False, False),
        ({"inferred": True}, False, False),
        ({"inferred": True}, True, True),
    ],
)
def test_a_query_waits_for_its_commit_measurements_and_inferences(dataset, fields, infers, is_ready):
    assert readers._is_ready(question(**fields), dataset, Log(), infers) == is_ready


def test_only_the_commits_that_a_query_needs_are_read(dataset):
    log = Log(Delta(seq=8), Delta(seq=9, demand=2), Delta(seq=10))
    assert readers._is_ready(question(seq=8), dataset, log, infers=False)
    assert [delta.seq for delta in log.deltas] == [9, 10]
    assert readers._is_ready(question(demand=2), dataset, log, infers=False)
    assert (dataset.seq, dataset.demand) == (9, 2)


def test_a_store_is_not_used_before_it_is_consistent(dataset):
    dataset.settled = 9
    assert not readers._is_ready(question(seq=7), dataset, Log(Delta(seq=8)), infers=False)
    assert readers._is_ready(question(seq=7), dataset, Log(Delta(seq=9)), infers=False)


def outcome(dataset, query, **fields):
    return outcomes.decode(readers._answer(question(query, **fields), dataset))


def test_an_outcome_has_the_number_of_its_query_and_a_result_or_an_error(dataset):
    found = outcome(dataset, "SELECT ?x { ?x a dm:Chair }")
    assert (found.number, found.error, found.old) == (4, None, False)
    rejected = outcome(dataset, "SELECT ?x { ?x a dm:Chair }", limit=1)
    assert "more than 1 rows" in rejected.error.text or "more than 1" in rejected.error.text
    assert "read-only" in outcome(dataset, "DELETE WHERE { ?s ?p ?o }").error.text


def test_an_unexpected_error_is_reported(dataset, monkeypatch):
    def fail(*_, **__):
        raise ZeroDivisionError("by zero")

    monkeypatch.setattr(readers, "evaluate", fail)
    assert "SPARQL failed: ZeroDivisionError: by zero" in outcome(dataset, "ASK {}").error.text


def test_an_answer_that_is_too_long_is_an_error(dataset, monkeypatch):
    size = len(readers._answer(question("SELECT ?x { ?x a dm:Chair }"), dataset))
    for most, is_whole in ((size, True), (size - 1, False)):
        monkeypatch.setattr(readers, "ANSWER_BYTES", most)
        assert (outcome(dataset, "SELECT ?x { ?x a dm:Chair }").error is None) == is_whole


def test_the_time_limit_ends_with_the_answer(dataset):
    readers._answer(question(timeout_s=60.0), dataset)
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)
