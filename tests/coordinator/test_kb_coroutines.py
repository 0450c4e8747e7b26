"""Coroutines in step: fewer requests, and each as if it ran alone."""

from __future__ import annotations

import gc
import weakref
from concurrent.futures import Future

import pytest

from semmap.nodes.coordinator.kb_coroutines import gather, run, run_async, run_single
from semmap.schemas import errors
from semmap.schemas.bridge import MadeBy, Outcome, Transactions
from semmap.schemas.commits import Commit, Transaction


def transaction(name):
    return Transaction(id=name, source="operator")


def commit(name):
    return Commit(seq=1, stamp_ns=0, id=name, source="operator")


def change(name):
    """A coroutine like that of a command with an id: query the earlier result, then commit."""
    (made,) = yield MadeBy(ids=(name,))
    made = made or (yield transaction(name))
    return made.id


class KnowledgeBase:
    """A knowledge base that has done `done`, rejects `no`, and does not understand `odd`."""

    def __init__(self):
        self.asked = []

    def __call__(self, message):
        self.asked.append(message)
        if isinstance(message, MadeBy):
            return tuple(commit(id_) if id_ == "done" else None for id_ in message.ids)
        if isinstance(message, Transactions):
            return tuple(map(self.outcome, message.transactions))
        outcome = self.outcome(message)
        if outcome.error is not None:
            raise errors.from_message(outcome.error)
        return outcome.commit

    def outcome(self, transaction):
        if transaction.id == "odd":
            raise errors.BadRequest("odd")
        if transaction.id == "no":
            return Outcome(error=errors.to_message(errors.PreconditionFailed("no")))
        return Outcome(commit=commit(transaction.id))


@pytest.fixture
def ask():
    return KnowledgeBase()


def test_one_coroutine_sends_its_requests_in_order(ask):
    assert run(change("a"), ask) == "a"
    assert ask.asked == [MadeBy(ids=("a",)), transaction("a")]


def test_concurrent_requests_are_sent_together(ask):
    assert run(gather([change("a"), change("b")]), ask) == ["a", "b"]
    assert ask.asked == [
        MadeBy(ids=("a", "b")),
        Transactions(transactions=(transaction("a"), transaction("b"))),
    ]


@pytest.mark.parametrize(
    ("bad", "error"),
    [("no", errors.PreconditionFailed), ("odd", errors.BadRequest)],
)
def test_an_error_ends_its_own_coroutine_only(ask, bad, error):
    first, second, third = run(gather([change("a"), change(bad), change("c")]), ask)
    assert (first, type(second), third) == ("a", error, "c")


def test_a_coroutine_may_continue_after_an_error(ask):
    def stubborn():
        try:
            yield transaction("no")
        except errors.PreconditionFailed:
            return (yield transaction("yes")).id

    assert run(gather([stubborn(), change("a"), stubborn()]), ask) == ["yes", "a", "yes"]


def test_a_finished_coroutine_does_not_delay_the_others(ask):
    assert run(gather([change("a"), change("done"), change("b")]), ask) == ["a", "done", "b"]
    assert ask.asked == [
        MadeBy(ids=("a", "done", "b")),
        Transactions(transactions=(transaction("a"), transaction("b"))),
    ]


def test_without_a_reply_nothing_is_reported_as_done():
    def no_node(message):
        raise errors.NoAnswer(message.VERB)

    with pytest.raises(errors.NoAnswer):
        run(gather([change("a"), change("b")]), no_node)


def test_run_async_continues_when_the_reply_arrives(ask):
    asked = []

    def ask_later(message):
        asked.append((message, Future()))
        return asked[-1][-1]

    future = run_async(gather([change("a"), change("no")]), ask_later)
    while not future.done():
        message, answer = asked[-1]
        try:
            answer.set_result(ask(message))
        except errors.SemmapError as error:
            answer.set_exception(error)
    first, second = future.result()
    assert (first, type(second)) == ("a", errors.PreconditionFailed)


def test_an_exception_in_run_async_is_its_result():
    def broken():
        yield MadeBy(ids=())
        raise ZeroDivisionError

    done: Future = Future()
    done.set_result(())
    assert isinstance(run_async(broken(), lambda *_: done).exception(), ZeroDivisionError)


def test_the_memory_of_a_coroutine_is_freed_at_its_end():
    class File:
        """Large."""

    def talk(file):
        yield transaction("a")
        return "done"

    def ask_later(call):
        answer = Future()
        answer.set_result(None)
        return answer

    file = File()
    seen = weakref.ref(file)
    gc.disable()
    try:
        result = run_async(talk(file), ask_later).result()
        del file
        assert (result, seen()) == ("done", None)
    finally:
        gc.enable()


@pytest.mark.parametrize("name", ["a", "done", "no", "odd"])
def test_run_single_is_like_gather(name):
    seen, expected = KnowledgeBase(), KnowledgeBase()
    (result,), (same,) = run(run_single(change(name)), seen), run(gather([change(name)]), expected)
    assert (type(result), str(result), seen.asked) == (type(same), str(same), expected.asked)


def faulty_ask_later(message):
    """Fail to send."""
    raise MemoryError("no memory to send")


def test_a_request_that_cannot_be_sent_ends_the_coroutine():
    assert isinstance(run_async(change("a"), faulty_ask_later).exception(), MemoryError)


def test_an_invalid_reply_ends_the_coroutine():
    future = Future()
    held = run_async(gather([change("a"), change("b")]), lambda _: future)
    future.set_exception(MemoryError("no memory to read"))
    assert isinstance(held.exception(timeout=0), MemoryError)


def test_an_unexpected_exception_ends_its_own_coroutine_only(ask):
    def broken():
        yield MadeBy(ids=("x",))
        raise MemoryError("no memory")

    unexpected, expected = run(gather([broken(), change("a")]), ask)
    assert isinstance(unexpected, MemoryError)
    assert expected == "a"
