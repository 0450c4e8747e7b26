"""Subscriptions questions that somebody follows: each is asked of the system once, however many follow it."""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import ExitStack
from typing import Final, NamedTuple

from semmap.nodes.extern.client import Client
from semmap.nodes.extern.mcp import resources
from semmap.schemas import errors

MOST: Final = 20
"""Subscriptions questions of one server."""


class _Followed(NamedTuple):
    by: int
    end: Callable[[], None]


class Subscriptions:
    """Those of one server. For any thread."""

    def __init__(self, client: Client, changed: Callable[[str], None]) -> None:
        """`changed(uri)` is called on a thread of its own when the answer of a question is another one."""
        self._client = client
        self._changed = changed
        self._lock = threading.Lock()
        self._followed: dict[str, _Followed] = {}

    def subscribe(self, uri: str) -> None:
        """One more follows it. What is no standing question never changes. Raises SemmapError."""
        if not uri.startswith(resources.WATCH):
            return
        asked = resources.asked(uri)
        with self._lock:
            if (known := self._followed.get(uri)) is not None:
                self._followed[uri] = known._replace(by=known.by + 1)
                return
            if len(self._followed) >= MOST:
                raise errors.Refused(f"{MOST} standing questions are followed already; end one first")
            stack = ExitStack()
            standing = stack.enter_context(self._client.watch(**asked))
            self._followed[uri] = _Followed(1, stack.close)

        def wait() -> None:
            try:
                for _ in standing.changes():
                    self._changed(uri)
            except errors.SemmapError:
                self._changed(uri)  # who reads it again is told what is wrong

        threading.Thread(target=wait, name="standing question", daemon=True).start()

    def unsubscribe(self, uri: str) -> None:
        """One follows it no more; the last one ends it."""
        with self._lock:
            known = self._followed.get(uri)
            if known is None:
                return
            if known.by > 1:
                self._followed[uri] = known._replace(by=known.by - 1)
                return
            del self._followed[uri]
        known.end()

    def close(self) -> None:
        """End all."""
        with self._lock:
            ending, self._followed = list(self._followed.values()), {}
        for followed in ending:
            followed.end()
