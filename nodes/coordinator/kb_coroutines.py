"""Coroutines of requests to the knowledge base; requests of the same kind are sent together.

A coroutine is a generator that yields a request. The `yield` returns the reply or raises its error, so a
command handler is written as if it ran alone.

Several coroutines in step are again one coroutine. Together they cost the round trips of one, and the
knowledge base syncs its disk once.
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
"""`ask(call)` returns the reply of the knowledge base, or raises a SemmapError."""
AskLater = Callable[[Call], Future[Any]]
"""Like `Ask`, without waiting."""
KbCoroutine = Generator[Call, Any, T]
Answer = Any
"""A message or an exception."""


def ask(call: Call[T]) -> KbCoroutine[T]:
    """Send one request and return its typed reply; use it with `yield from`."""
    answer: T = yield call
    return answer


def run(coroutine: KbCoroutine[T], ask: Ask) -> T:
    """Run a coroutine and return its result. Raises the error that ends it."""
    answer: Answer = None
    while True:
        try:
            call = _resume(coroutine, answer)
        except StopIteration as end:
            result: T = end.value
            return result
        answer = _try(lambda call=call: ask(call))  # type: ignore[misc]


def run_async(coroutine: KbCoroutine[T], ask_later: AskLater) -> Future[T]:
    """Run a coroutine without waiting; it continues on the thread that delivers the replies."""
    future: Future[T] = SingleThreadFuture()
    _continue(coroutine, ask_later, future, None)
    return future


def _continue(coroutine: KbCoroutine[T], ask_later: AskLater, future: Future[T], answer: Answer) -> None:
    """Resume the coroutine with the reply, and send its next request; keep no reference when it ends."""
    try:
        call = _resume(coroutine, answer)
    except StopIteration as end:
        future.set_result(end.value)
    except Exception as error:
        future.set_exception(error)
    else:
        try:
            asked = ask_later(call)
        except Exception as error:  # any error is raised in the coroutine, which ends
            _continue(coroutine, ask_later, future, error)
        else:
            asked.add_done_callback(lambda done: _continue(coroutine, ask_later, future, _try(done.result)))


def run_single(coroutine: KbCoroutine[T]) -> KbCoroutine[list[T | Exception]]:
    """Run one coroutine like `gather`: this is the usual case."""
    try:
        return [(yield from coroutine)]
    except Exception as error:
        return [error]


def gather(coroutines: Sequence[KbCoroutine[T]]) -> KbCoroutine[list[T | Exception]]:
    """Run several coroutines in step and return their results in order.

    The result of a coroutine that raises is its exception; the others continue.
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


def _try(ask: Callable[[], Any]) -> Answer:
    try:
        return ask()
    except Exception as error:
        return error


def _ask_together(calls: Mapping[int, Call]) -> KbCoroutine[dict[int, Answer]]:
    """Send these requests, together where possible, and return the replies in the order of the calls."""
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
    except (errors.BadRequest, errors.Refused):  # one is invalid, or has ended the node: find out which
        return (yield from _each(transactions))
    return {i: _reply_of(outcome) for i, outcome in zip(transactions, outcomes, strict=True)}


def _reply_of(outcome: Outcome) -> Answer:
    return outcome.commit if outcome.error is None else errors.from_message(outcome.error)


_TOGETHER: Mapping[type[Call], Callable[[Mapping[int, Any]], KbCoroutine[dict[int, Answer]]]] = {
    MadeBy: _made_by,
    Transaction: _commits,
}
"""The kinds of calls that can be sent together."""
