"""Commands that come before the coordinator knows the map: they wait for it rather than fail."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

from semmap.nodes import bus
from semmap.nodes.runtime.futures import SingleThreadFuture, settle
from semmap.schemas import errors


class EarlyCommands:
    """They wait for a moment after a start, and as long as there is a knowledge base: it may be at work."""

    def __init__(self, is_there: Callable[[], bool]) -> None:
        """`is_there()` tells whether there is a knowledge base."""
        self._is_there = is_there
        self._waiting: list[tuple[float, Callable[[], Any], Future[Any]]] = []

    def __len__(self) -> int:
        return len(self._waiting)

    def wait(self, execute: Callable[[], Any]) -> Future[Any]:
        """The outcome of `execute()`, which is called when there is a map."""
        future: Future[Any] = SingleThreadFuture()
        self._waiting.append((time.monotonic() + bus.RESTART_S, execute, future))
        return future

    def retry(self, *, has_map: bool) -> None:
        """Execute what waits if there is a map now; refuse what has waited for nobody."""
        waiting, self._waiting = self._waiting, []
        for deadline_s, execute, future in waiting:
            if has_map:
                settle(future, execute)
            elif time.monotonic() < deadline_s or self._is_there():
                self._waiting.append((deadline_s, execute, future))
            else:
                future.set_exception(
                    errors.NoAnswer("the knowledge base is not answering; see: semmap status")
                )
