"""Talks held in step: fewer questions, and each as if it were alone."""

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
    """A talk as of a command with an id: was it done before? If not, the commit."""
    (made,) = yield MadeBy(ids=(name,))
    made = made or (yield transaction(name))
    return made.id


class KnowledgeBase:
    """Has done `done` before, refuses to commit `no`, and does not understand `odd`."""

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


def test_one_talk_asks_as_it_is_written(ask):
    assert run(change("a"), ask) == "a"
    assert ask.asked == [MadeBy(ids=("a",)), transaction("a")]


def test_what_is_asked_at_the_same_time_goes_together(ask):
    assert run(gather([change("a"), change("b")]), ask) == ["a", "b"]
    assert ask.asked == [
        MadeBy(ids=("a", "b")),
        Transactions(transactions=(transaction("a"), transaction("b"))),
    ]


@pytest.mark.parametrize(
    ("bad", "error"),
    [("no", errors.PreconditionFailed), ("odd", errors.BadRequest)],
)
def test_an_error_ends_its_own_talk_only(ask, bad, error):
    first, second, third = run(gather([change("a"), change(bad), change("c")]), ask)
    assert (first, type(second), third) == ("a", error, "c")


def test_a_talk_may_go_on_after_an_error(ask):
    def stubborn():
        try:
            yield transaction("no")
        except errors.PreconditionFailed:
            return (yield transaction("yes")).id

    assert run(gather([stubborn(), change("a"), stubborn()]), ask) == ["yes", "a", "yes"]


def test_who_was_answered_before_does_not_hold_up_the_others(ask):
    assert run(gather([change("a"), change("done"), change("b")]), ask) == ["a", "done", "b"]
    assert ask.asked == [
        MadeBy(ids=("a", "done", "b")),
        Transactions(transactions=(transaction("a"), transaction("b"))),
    ]


def test_without_an_answer_nothing_is_said_to_be_done():
    def nobody(message):
        raise errors.NoAnswer(message.VERB)

    with pytest.raises(errors.NoAnswer):
        run(gather([change("a"), change("b")]), nobody)


def test_a_talk_held_later_goes_on_when_the_answer_comes(ask):
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


def test_a_fault_in_a_talk_that_is_held_later_is_its_result():
    def broken():
        yield MadeBy(ids=())
        raise ZeroDivisionError

    done: Future = Future()
    done.set_result(())
    assert isinstance(run_async(broken(), lambda *_: done).exception(), ZeroDivisionError)


def test_what_a_dialogue_is_about_goes_when_it_ends():
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
def test_one_talk_alone_is_as_in_step_with_none(name):
    seen, expected = KnowledgeBase(), KnowledgeBase()
    (result,), (same,) = run(run_single(change(name)), seen), run(gather([change(name)]), expected)
    assert (type(result), str(result), seen.asked) == (type(same), str(same), expected.asked)


def faulty_ask_later(message):
    """Cannot even send."""
    raise MemoryError("no memory to send")


def test_what_cannot_be_asked_ends_the_talk_with_the_reason():
    assert isinstance(run_async(change("a"), faulty_ask_later).exception(), MemoryError)


def test_an_answer_that_cannot_be_read_ends_the_talk_with_the_reason():
    future = Future()
    held = run_async(gather([change("a"), change("b")]), lambda _: future)
    future.set_exception(MemoryError("no memory to read"))
    assert isinstance(held.exception(timeout=0), MemoryError)


def test_an_unexpected_exception_in_one_talk_leaves_the_others_alone(ask):
    def broken():
        yield MadeBy(ids=("x",))
        raise MemoryError("no memory")

    unexpected, expected = run(gather([broken(), change("a")]), ask)
    assert isinstance(unexpected, MemoryError)
    assert expected == "a"
