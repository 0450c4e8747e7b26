"""A small thread pool for long work of a node, shared fairly between clients."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from typing import Any, Final, TypeVar

from semmap.nodes.runtime.fair_queue import FairQueue
from semmap.schemas import errors

R = TypeVar("R")

_EACH: Final = 64
_ALL: Final = 256
"""Largest number of waiting work items of one client, and of all."""


class FairPool:
    """Like a ThreadPoolExecutor. `submit` is called by one thread."""

    def __init__(self, workers: int, asker: Callable[[], str] = str) -> None:
        """`asker()` returns the client of the submitted work."""
        self._asker = asker
        self._queue: FairQueue[tuple[Future[Any], Callable[[], Any]]] = FairQueue(each=_EACH, everyone=_ALL)
        self._pool = ThreadPoolExecutor(workers, thread_name_prefix="beside")

    def submit(self, function: Callable[..., R], *arguments: Any) -> Future[R]:
        """Schedule `function(*arguments)` and return its future result. Raises Busy if too much waits."""
        future: Future[R] = Future()
        again_s = self._queue.put(self._asker(), (future, partial(function, *arguments)))
        if again_s is not None:
            raise errors.Busy(
                f"{len(self._queue)} long requests are waiting; try again in {again_s:.1f} s",
                again_s=again_s,
            )
        self._pool.submit(self._work)
        return future

    def close(self) -> None:
        """Begin no more work."""
        self._pool.shutdown(wait=False, cancel_futures=True)

    def _work(self) -> None:
        if (taken := self._queue.take()) is None:
            return
        future, work = taken
        if not future.set_running_or_notify_cancel():
            return
        try:
            result = work()
        except BaseException as error:
            future.set_exception(error)
        else:
            future.set_result(result)
