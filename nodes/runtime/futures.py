"""Futures: resolving one, and chaining a function to one."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from typing import TypeVar

T = TypeVar("T")
U = TypeVar("U")


def settle(future: Future[T], execute: Callable[[], T | Future[T]]) -> None:
    """Resolve `future` with what `execute()` returns (or, if that is a future, with its result) or raises."""
    try:
        result = execute()
    except Exception as error:
        future.set_exception(error)
        return
    if isinstance(result, Future):
        result.add_done_callback(lambda done: settle(future, done.result))
    else:
        future.set_result(result)


def then(future: Future[T], function: Callable[[T], U]) -> Future[U]:
    """The future of `function(result)`; errors pass through."""
    following: Future[U] = Future()

    def on_done(done: Future[T]) -> None:
        try:
            following.set_result(function(done.result()))
        except Exception as error:
            following.set_exception(error)

    future.add_done_callback(on_done)
    return following
