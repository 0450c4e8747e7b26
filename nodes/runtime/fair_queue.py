"""A bounded queue of requests, and a thread pool for long ones, both fair between clients.

The clients take turns, so one with a thousand requests does not delay the first request of another.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from typing import Any, Final, Generic, TypeVar

from semmap.schemas import errors

T = TypeVar("T")

EACH: Final = 1000
"""Largest number of items of one client."""
ALL: Final = 4000
"""Largest number of items of all clients."""
ALL_BYTES: Final = 64 << 20
"""Largest total size of the items; a single larger item is accepted if nothing else waits."""
SOONEST_S: Final = 0.1
LATEST_S: Final = 10.0
"""If the queue is full, the suggested pause is the age of the first item, within these limits [s]."""


_Waiting = tuple[T, int, float]
"""An item, its size, and the time since when it waits."""
R = TypeVar("R")
_EACH: Final = 64
_ALL: Final = 256
"""Largest number of waiting work items of one client, and of all."""


class FairQueue(Generic[T]):
    """Each client has a queue, and these take turns. Any thread may use it."""

    def __init__(self, *, each: int = EACH, everyone: int = ALL, size: int = ALL_BYTES) -> None:
        """`size` is in bytes."""
        self._each, self._everyone, self._size = each, everyone, size
        self._urgent: deque[_Waiting[T]] = deque()
        self._by_asker: dict[str, deque[_Waiting[T]]] = {}
        self._next: deque[str] = deque()
        """The clients with waiting items, in the order of their turns."""
        self._count = self._bytes = 0
        self._lock = threading.Lock()

    def __len__(self) -> int:
        """Return the number of items, without urgent ones."""
        return self._count

    @property
    def is_empty(self) -> bool:
        """Whether no item waits, not even an urgent one."""
        return not self._count and not self._urgent

    def put(self, asker: str, item: T, *, size: int = 0, urgent: bool = False) -> float | None:
        """Add `item` of `size` bytes; return None, or the pause [s] before a retry if the queue is full.

        An `urgent` item comes before all others.
        """
        waiting = (item, size, time.monotonic())
        with self._lock:
            if urgent:
                if len(self._urgent) >= self._each:
                    return self._again_s(self._urgent, waiting[2])
                self._urgent.append(waiting)
                return None
            own = self._by_asker.get(asker)
            if own is not None and len(own) >= self._each:
                return self._again_s(own, waiting[2])
            if self._count >= self._everyone or (self._count and self._bytes + size > self._size):
                return self._again_s(self._by_asker[self._next[0]], waiting[2])
            if own is None:
                own = self._by_asker[asker] = deque()
                self._next.append(asker)
            own.append(waiting)
            self._count += 1
            self._bytes += size
        return None

    def take(self, *, urgent_only: bool = False) -> T | None:
        """Return the next item, if there is one."""
        with self._lock:
            if self._urgent:
                return self._urgent.popleft()[0]
            if urgent_only or not self._next:
                return None
            asker = self._next.popleft()
            own = self._by_asker[asker]
            waiting = own.popleft()
            if own:
                self._next.append(asker)
            else:
                del self._by_asker[asker]
            self._count -= 1
            item, size, _ = waiting
            self._bytes -= size
            return item

    @staticmethod
    def _again_s(queue: deque[_Waiting[T]], now_s: float) -> float:
        return min(max(now_s - queue[0][2], SOONEST_S), LATEST_S)


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
