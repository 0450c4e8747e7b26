"""Talks with the knowledge base, several at once and in step: what is asked at the same time goes together.

A talk is a generator: it yields a question, and gets the answer or has the error raised at its `yield`. So a
command is written as if it were alone; several of them in step are again one coroutine, and cost the round trips,
and the knowledge base the waits for its disk, of one.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping, Sequence
from concurrent.futures import Future
from typing import Any, TypeVar

from semmap.nodes.runtime.futures import SingleThreadFuture
from semmap.schemas import errors
from semmap.schemas.bridge import MadeBy, Outcome, Transactions
from semmap.schemas.calls import Call
from semmap.schemas.commits import Transaction

T = TypeVar("T")


Ask = Callable[[Call], Any]
"""`ask(call)` gives the answer of the knowledge base, or raises a SemmapError."""
AskLater = Callable[[Call], Future[Any]]
"""The same, without waiting."""
KbCoroutine = Generator[Call, Any, T]
Answer = Any
"""A message or an exception."""


def ask(call: Call[T]) -> KbCoroutine[T]:
    """The answer to one call, with its type: `answer = yield from` this."""
    answer: T = yield call
    return answer


def run(coroutine: KbCoroutine[T], ask: Ask) -> T:
    """The result of a coroutine. Raises the error that ends it."""
    answer: Answer = None
    while True:
        try:
            call = _resume(coroutine, answer)
        except StopIteration as end:
            result: T = end.value
            return result
        answer = _answer_of(lambda call=call: ask(call))  # type: ignore[misc]


def run_async(coroutine: KbCoroutine[T], ask_later: AskLater) -> Future[T]:
    """The result of a talk that goes on whenever an answer comes, on the thread that brings it."""
    future: Future[T] = SingleThreadFuture()
    _continue(coroutine, ask_later, future, None)
    return future


def _continue(coroutine: KbCoroutine[T], ask_later: AskLater, future: Future[T], answer: Answer) -> None:
    """Give it the answer, and ask what it asks next. Nothing of it is kept when it ends."""
    try:
        call = _resume(coroutine, answer)
    except StopIteration as end:
        future.set_result(end.value)
    except Exception as error:
        future.set_exception(error)
    else:
        try:
            asked = ask_later(call)
        except Exception as error:  # whatever it is, the talk is told of it, and ends
            _continue(coroutine, ask_later, future, error)
        else:
            asked.add_done_callback(
                lambda done: _continue(coroutine, ask_later, future, _answer_of(done.result))
            )


def run_single(coroutine: KbCoroutine[T]) -> KbCoroutine[list[T | Exception]]:
    """`gather` for one coroutine: as most changes come."""
    try:
        return [(yield from coroutine)]
    except Exception as error:
        return [error]


def gather(coroutines: Sequence[KbCoroutine[T]]) -> KbCoroutine[list[T | Exception]]:
    """Several coroutines as one, with their results in their order.

    A talk that ends with an exception, expected or not, gives that; the others go on.
    """
    results: dict[int, T | Exception] = {}
    answers: dict[int, Answer] = dict.fromkeys(range(len(coroutines)))
    while answers:
        calls: dict[int, Call] = {}
        for i, answer in answers.items():
            try:
                calls[i] = _resume(coroutines[i], answer)
            except StopIteration as end:
                results[i] = end.value
            except Exception as error:
                results[i] = error
        answers = yield from _ask_together(calls)
    return [results[i] for i in range(len(coroutines))]


def _resume(coroutine: KbCoroutine[T], answer: Answer) -> Call:
    return coroutine.throw(answer) if isinstance(answer, Exception) else coroutine.send(answer)


def _answer_of(ask: Callable[[], Any]) -> Answer:
    try:
        return ask()
    except Exception as error:
        return error


def _ask_together(calls: Mapping[int, Call]) -> KbCoroutine[dict[int, Answer]]:
    """The answers, in the order of the calls."""
    by_kind: dict[type[Call], dict[int, Any]] = {}
    for i, call in calls.items():
        by_kind.setdefault(type(call), {})[i] = call
    answers: dict[int, Answer] = {}
    for kind, alike in by_kind.items():
        together = _TOGETHER.get(kind, _each) if len(alike) > 1 else _each
        answers.update((yield from together(alike)))
    return {i: answers[i] for i in calls}


def _each(calls: Mapping[int, Call]) -> KbCoroutine[dict[int, Answer]]:
    answers: dict[int, Answer] = {}
    for i, call in calls.items():
        try:
            answers[i] = yield call
        except Exception as error:
            answers[i] = error
    return answers


def _made_by(queries: Mapping[int, MadeBy]) -> KbCoroutine[dict[int, Answer]]:
    ids = tuple(dict.fromkeys(id_ for query in queries.values() for id_ in query.ids))
    commits = yield from ask(MadeBy(ids=ids))
    made = dict(zip(ids, commits, strict=True))
    return {i: tuple(made[id_] for id_ in query.ids) for i, query in queries.items()}


def _commits(transactions: Mapping[int, Transaction]) -> KbCoroutine[dict[int, Answer]]:
    try:
        outcomes = yield from ask(Transactions(transactions=tuple(transactions.values())))
    except errors.BadRequest:  # one of them
        return (yield from _each(transactions))
    return {i: _said(outcome) for i, outcome in zip(transactions, outcomes, strict=True)}


def _said(outcome: Outcome) -> Answer:
    return outcome.commit if outcome.error is None else errors.from_message(outcome.error)


_TOGETHER: Mapping[type[Call], Callable[[Mapping[int, Any]], KbCoroutine[dict[int, Answer]]]] = {
    MadeBy: _made_by,
    Transaction: _commits,
}
"""The calls that can be asked together."""
