"""Talks with the knowledge base, several at once and in step: what is asked at the same time goes together.

A talk is a generator: it yields a question, and gets the answer or has the error raised at its `yield`. So a
command is written as if it were alone; several of them in step are again one talk, and cost the round trips,
and the knowledge base the waits for its disk, of one.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping, Sequence
from concurrent.futures import Future
from typing import Any, NamedTuple, TypeVar

from schemas import errors
from schemas.bridge import MadeBy, Outcome, Transactions
from schemas.commits import Effects

T = TypeVar("T")


class Question(NamedTuple):
    """What is asked at `semmap/bridge/<verb>`."""

    verb: str
    message: Any


Ask = Callable[[str, Any], Any]
"""`ask(verb, message)` gives the answer, or raises a SemmapError."""
AskLater = Callable[[str, Any], Future[Any]]
"""The same, without waiting."""
Talk = Generator[Question, Any, T]
Answer = Any
"""A message or a SemmapError."""


def hold(talk: Talk[T], ask: Ask) -> T:
    """The result of a talk. Raises the error that ends it."""
    answer: Answer = None
    while True:
        try:
            question = _go_on(talk, answer)
        except StopIteration as end:
            result: T = end.value
            return result
        answer = _answer_of(lambda question=question: ask(*question))  # type: ignore[misc]


def hold_later(talk: Talk[T], ask_later: AskLater) -> Future[T]:
    """The result of a talk that goes on whenever an answer comes, on the thread that brings it."""
    future: Future[T] = Future()

    def go_on(answer: Answer) -> None:
        try:
            question = _go_on(talk, answer)
        except StopIteration as end:
            future.set_result(end.value)
        except Exception as error:
            future.set_exception(error)
        else:
            ask_later(*question).add_done_callback(lambda done: go_on(_answer_of(done.result)))

    go_on(None)
    return future


def in_step(talks: Sequence[Talk[T]]) -> Talk[list[T | errors.SemmapError]]:
    """Several talks as one, with their results in their order; a talk that ends with an error gives that."""
    results: dict[int, T | errors.SemmapError] = {}
    answers: dict[int, Answer] = dict.fromkeys(range(len(talks)))
    while answers:
        questions: dict[int, Question] = {}
        for i, answer in answers.items():
            try:
                questions[i] = _go_on(talks[i], answer)
            except StopIteration as end:
                results[i] = end.value
            except errors.SemmapError as error:
                results[i] = error
        answers = yield from _ask_together(questions)
    return [results[i] for i in range(len(talks))]


def _go_on(talk: Talk[T], answer: Answer) -> Question:
    return talk.throw(answer) if isinstance(answer, errors.SemmapError) else talk.send(answer)


def _answer_of(ask: Callable[[], Any]) -> Answer:
    try:
        return ask()
    except errors.SemmapError as error:
        return error


def _ask_together(questions: Mapping[int, Question]) -> Talk[dict[int, Answer]]:
    """The answers, in the order of the questions."""
    by_verb: dict[str, dict[int, Any]] = {}
    for i, (verb, message) in questions.items():
        by_verb.setdefault(verb, {})[i] = message
    answers: dict[int, Answer] = {}
    for verb, messages in by_verb.items():
        together = _TOGETHER.get(verb) if len(messages) > 1 else None
        answers.update((yield from (together(messages) if together else _each(verb, messages))))
    return {i: answers[i] for i in questions}


def _each(verb: str, messages: Mapping[int, Any]) -> Talk[dict[int, Answer]]:
    answers: dict[int, Answer] = {}
    for i, message in messages.items():
        try:
            answers[i] = yield Question(verb, message)
        except errors.SemmapError as error:
            answers[i] = error
    return answers


def _made_by(messages: Mapping[int, MadeBy]) -> Talk[dict[int, Answer]]:
    ids = tuple(dict.fromkeys(id_ for query in messages.values() for id_ in query.ids))
    commits: tuple[Effects | None, ...] = yield Question("made-by", MadeBy(ids=ids))
    made = dict(zip(ids, commits, strict=True))
    return {i: tuple(made[id_] for id_ in query.ids) for i, query in messages.items()}


def _commits(messages: Mapping[int, Any]) -> Talk[dict[int, Answer]]:
    several = Transactions(transactions=tuple(messages.values()))
    try:
        outcomes: tuple[Outcome, ...] = yield Question("commits", several)
    except errors.BadRequest:  # one of them
        return (yield from _each("commit", messages))
    return {i: _said(outcome) for i, outcome in zip(messages, outcomes, strict=True)}


def _said(outcome: Outcome) -> Answer:
    return outcome.commit if outcome.error is None else errors.from_message(outcome.error)


_TOGETHER: Mapping[str, Callable[[Mapping[int, Any]], Talk[dict[int, Answer]]]] = {
    "made-by": _made_by,
    "commit": _commits,
}
"""The questions that can be asked together."""
