"""Commands that arrive before the coordinator has received the map wait for it instead of failing."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

from semmap.nodes import bus
from semmap.nodes.runtime.futures import SingleThreadFuture, settle
from semmap.schemas import errors


class EarlyCommands:
    """Holds commands for a short time after a start, and as long as a knowledge base runs."""

    def __init__(self, is_there: Callable[[], bool]) -> None:
        """`is_there()` returns whether a knowledge base is running."""
        self._is_there = is_there
        self._waiting: list[tuple[float, Callable[[], Any], Future[Any]]] = []

    def __len__(self) -> int:
        return len(self._waiting)

    def wait(self, execute: Callable[[], Any]) -> Future[Any]:
        """Return the result of `execute()`, which is called when the map is there."""
        future: Future[Any] = SingleThreadFuture()
        self._waiting.append((time.monotonic() + bus.RESTART_S, execute, future))
        return future

    def retry(self, *, has_map: bool) -> None:
        """Execute the waiting commands if the map is there, and reject those that waited too long."""
        waiting, self._waiting = self._waiting, []
        for deadline_s, execute, future in waiting:
            if has_map:
                settle(future, execute)
            elif time.monotonic() < deadline_s or self._is_there():
                self._waiting.append((deadline_s, execute, future))
            else:
                future.set_exception(
                    errors.NoAnswer("no response from the knowledge base; see: semmap status")
                )
