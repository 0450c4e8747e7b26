"""Futures: those of a node's own thread, resolving one, and chaining a function to one."""

from __future__ import annotations

import logging
from collections.abc import Callable
from concurrent.futures import Future, InvalidStateError
from typing import Any, TypeVar

log = logging.getLogger(__name__)

T = TypeVar("T")
U = TypeVar("U")


class SingleThreadFuture(Future[T]):
    """A future that one thread both resolves and reads: it has no lock, and nobody can wait for it.

    A command passes through several; one with a lock takes four times as long.
    """

    def __init__(self) -> None:
        self._is_done = False
        self._value: T
        self._error: BaseException | None = None
        self._callbacks: list[Callable[[Future[T]], object]] = []

    def done(self) -> bool:
        """Is it resolved?"""
        return self._is_done

    def cancelled(self) -> bool:
        """It cannot be cancelled."""
        return False

    def running(self) -> bool:
        """Nobody says when it is begun."""
        return False

    def cancel(self) -> bool:
        """It cannot be cancelled."""
        return False

    def result(self, timeout: float | None = None) -> T:
        """The value. Raises the error it was resolved with; InvalidStateError before that: no waiting."""
        self._require_done()
        if self._error is not None:
            raise self._error
        return self._value

    def exception(self, timeout: float | None = None) -> BaseException | None:
        """The error, if it was resolved with one. Raises InvalidStateError before that: no waiting."""
        self._require_done()
        return self._error

    def add_done_callback(self, fn: Callable[[Future[T]], object]) -> None:
        """Call `fn(future)` when it is resolved, at once if it is. What `fn` raises is logged."""
        if self._is_done:
            self._call(fn)
        else:
            self._callbacks.append(fn)

    def set_result(self, result: T) -> None:
        """Resolve it. Raises InvalidStateError the second time."""
        self._resolve(result, None)

    def set_exception(self, exception: BaseException | None) -> None:
        """Resolve it with an error. Raises InvalidStateError the second time."""
        self._resolve(None, exception)

    def _resolve(self, value: Any, error: BaseException | None) -> None:
        if self._is_done:
            raise InvalidStateError("it is resolved already")
        self._is_done, self._value, self._error = True, value, error
        callbacks, self._callbacks = self._callbacks, []
        for callback in callbacks:
            self._call(callback)

    def _call(self, callback: Callable[[Future[T]], object]) -> None:
        try:
            callback(self)
        except Exception:
            log.exception("what was to follow a future failed")

    def _require_done(self) -> None:
        if not self._is_done:
            raise InvalidStateError("it is not resolved yet, and its own thread cannot wait for that")


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
    following: Future[U] = SingleThreadFuture() if isinstance(future, SingleThreadFuture) else Future()

    def on_done(done: Future[T]) -> None:
        try:
            following.set_result(function(done.result()))
        except Exception as error:
            following.set_exception(error)

    future.add_done_callback(on_done)
    return following


def and_then(future: Future[T], function: Callable[[T], U | Future[U]]) -> Future[U]:
    """The future of `function(result)`, which may be a future itself; errors pass through.

    Both belong to one thread.
    """
    following: Future[U] = SingleThreadFuture()
    future.add_done_callback(lambda done: settle(following, lambda: function(done.result())))
    return following
