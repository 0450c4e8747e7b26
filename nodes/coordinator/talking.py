"""Talks with the knowledge base, several at once and in step: what is asked at the same time goes together.

A talk is a generator: it yields a question, and gets the answer or has the error raised at its `yield`. So a
command is written as if it were alone, and many of them cost the round trips, and the knowledge base the
waits for its disk, of one.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping, Sequence
from typing import Any, NamedTuple, TypeVar

from schemas import errors
from schemas.bridge import Outcome, StarQuery, Transactions
from schemas.commits import Star

T = TypeVar("T")


class Question(NamedTuple):
    """What is asked at `semmap/bridge/<verb>`."""

    verb: str
    message: Any


Ask = Callable[[str, Any], Any]
"""`ask(verb, message)` gives the answer, or raises a SemmapError."""
Talk = Generator[Question, Any, T]
Answer = Any
"""A message or a SemmapError."""


def hold(talk: Talk[T], ask: Ask) -> T:
    """The result of one talk. Raises the error that ends it."""
    (result,) = hold_all([talk], ask)
    if isinstance(result, errors.SemmapError):
        raise result
    return result


def hold_all(talks: Sequence[Talk[T]], ask: Ask) -> list[T | errors.SemmapError]:
    """The results of several talks, in their order; that of one that ends with an error is the error."""
    results: dict[int, T | errors.SemmapError] = {}
    answers: dict[int, Answer] = dict.fromkeys(range(len(talks)))
    while answers:
        questions: dict[int, Question] = {}
        for i, answer in answers.items():
            try:
                is_error = isinstance(answer, errors.SemmapError)
                questions[i] = talks[i].throw(answer) if is_error else talks[i].send(answer)
            except StopIteration as end:
                results[i] = end.value
            except errors.SemmapError as error:
                results[i] = error
        answers = _ask_together(questions, ask)
    return [results[i] for i in range(len(talks))]


def _ask_together(questions: Mapping[int, Question], ask: Ask) -> dict[int, Answer]:
    """The answers, in the order of the questions."""
    by_verb: dict[str, dict[int, Any]] = {}
    for i, (verb, message) in questions.items():
        by_verb.setdefault(verb, {})[i] = message
    answers: dict[int, Answer] = {}
    for verb, messages in by_verb.items():
        together = _TOGETHER.get(verb) if len(messages) > 1 else None
        answers.update(together(messages, ask) if together else _each(verb, messages, ask))
    return {i: answers[i] for i in questions}


def _each(verb: str, messages: Mapping[int, Any], ask: Ask) -> dict[int, Answer]:
    answers: dict[int, Answer] = {}
    for i, message in messages.items():
        try:
            answers[i] = ask(verb, message)
        except errors.SemmapError as error:
            answers[i] = error
    return answers


def _stars(messages: Mapping[int, StarQuery], ask: Ask) -> dict[int, Answer]:
    names = tuple(dict.fromkeys(name for query in messages.values() for name in query.names))
    try:
        if any(query.together and len(query.names) > 1 for query in messages.values()):
            return _each("star", messages, ask)
        found: tuple[Star, ...] = ask("star", StarQuery(names=names, together=False))
    except errors.Refused:  # one of them
        return _each("star", messages, ask)
    stars = {star.name: star for star in found}
    return {i: tuple(stars[name] for name in query.names) for i, query in messages.items()}


def _commits(messages: Mapping[int, Any], ask: Ask) -> dict[int, Answer]:
    try:
        outcomes: tuple[Outcome, ...] = ask("commits", Transactions(transactions=tuple(messages.values())))
    except errors.BadRequest:  # one of them
        return _each("commit", messages, ask)
    return {i: _answer(outcome) for i, outcome in zip(messages, outcomes, strict=True)}


def _answer(outcome: Outcome) -> Answer:
    return outcome.commit if outcome.error is None else errors.from_message(outcome.error)


_TOGETHER: Mapping[str, Callable[[Mapping[int, Any], Ask], dict[int, Answer]]] = {
    "star": _stars,
    "commit": _commits,
}
"""The questions that can be asked together."""
