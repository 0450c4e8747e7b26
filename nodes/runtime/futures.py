"""Futures of a node's own thread, and functions to resolve and chain them."""

from __future__ import annotations

import logging
from collections.abc import Callable
from concurrent.futures import Future, InvalidStateError
from typing import Any, TypeVar

log = logging.getLogger(__name__)

T = TypeVar("T")
U = TypeVar("U")


class SingleThreadFuture(Future[T]):
    """A future that one thread both resolves and reads. It has no lock and cannot be waited for.

    A command passes through several futures; with locks this takes four times as long.
    """

    def __init__(self) -> None:
        self._is_done = False
        self._value: T
        self._error: BaseException | None = None
        self._callbacks: list[Callable[[Future[T]], object]] = []

    def done(self) -> bool:
        """Return whether it is resolved."""
        return self._is_done

    def cancelled(self) -> bool:
        """It cannot be cancelled."""
        return False

    def running(self) -> bool:
        """Always False: the start is not recorded."""
        return False

    def cancel(self) -> bool:
        """It cannot be cancelled."""
        return False

    def result(self, timeout: float | None = None) -> T:
        """Return the value. Raises its error, or InvalidStateError if it is not resolved; never waits."""
        self._require_done()
        if self._error is not None:
            raise self._error
        return self._value

    def exception(self, timeout: float | None = None) -> BaseException | None:
        """Return the error, if any. Raises InvalidStateError if it is not resolved; never waits."""
        self._require_done()
        return self._error

    def add_done_callback(self, fn: Callable[[Future[T]], object]) -> None:
        """Call `fn(future)` when it is resolved, or immediately if it is. An exception in `fn` is logged."""
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
            raise InvalidStateError("the future is already resolved")
        self._is_done, self._value, self._error = True, value, error
        callbacks, self._callbacks = self._callbacks, []
        for callback in callbacks:
            self._call(callback)

    def _call(self, callback: Callable[[Future[T]], object]) -> None:
        try:
            callback(self)
        except Exception:
            log.exception("callback of a future failed")

    def _require_done(self) -> None:
        if not self._is_done:
            raise InvalidStateError("the future is not resolved, and its own thread cannot wait for it")


def settle(future: Future[T], execute: Callable[[], T | Future[T]]) -> None:
    """Resolve `future` with the result or error of `execute()`, or of the future that it returns."""
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
    """Return a future of `function(result)`; errors pass through."""
    following: Future[U] = SingleThreadFuture() if isinstance(future, SingleThreadFuture) else Future()

    def on_done(done: Future[T]) -> None:
        try:
            following.set_result(function(done.result()))
        except Exception as error:
            following.set_exception(error)

    future.add_done_callback(on_done)
    return following


def and_then(future: Future[T], function: Callable[[T], U | Future[U]]) -> Future[U]:
    """Return a future of `function(result)`, which may return a future itself; errors pass through.

    Both belong to one thread.
    """
    following: Future[U] = SingleThreadFuture()
    future.add_done_callback(lambda done: settle(following, lambda: function(done.result())))
    return following
