"""Orders of users that wait until the scene has placed their body as the map says."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from typing import TypeVar

from semmap.nodes.runtime.futures import SingleThreadFuture, settle

T = TypeVar("T")


class WaitingOrders:
    """Holds back orders for a body until an earlier commit has been carried out in the scene.

    Otherwise the order would be lost, because that commit places the body, or moves its joints, afterwards.
    """

    def __init__(self, must_wait: Callable[[str], bool]) -> None:
        """`must_wait(name)` returns whether a body has still to be placed."""
        self._must_wait = must_wait
        self._waiting: list[tuple[str, Callable[[], None]]] = []

    def run(self, name: str, execute: Callable[[], Future[T]]) -> Future[T]:
        """Return the result of `execute()`, which is called once the body `name` is placed."""
        if not self._must_wait(name):
            return execute()
        future: Future[T] = SingleThreadFuture()
        self._waiting.append((name, lambda: settle(future, execute)))
        return future

    def release(self) -> None:
        """Execute the orders whose bodies have been placed. Orders for one body keep their sequence."""
        waiting, self._waiting = self._waiting, []
        for name, execute in waiting:
            if self._must_wait(name):
                self._waiting.append((name, execute))
            else:
                execute()
