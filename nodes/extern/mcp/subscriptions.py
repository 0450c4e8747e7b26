"""Subscriptions to standing queries. Each query runs once, for any number of subscribers."""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import ExitStack
from typing import Final, NamedTuple

from semmap.nodes.extern.client import Client
from semmap.nodes.extern.mcp import resources
from semmap.schemas import errors

MOST: Final = 20
"""The maximum number of standing queries of one server."""


class _Subscription(NamedTuple):
    subscribers: int
    end: Callable[[], None]


class Subscriptions:
    """The subscriptions of one server. They can be used from any thread."""

    def __init__(self, client: Client, changed: Callable[[str], None]) -> None:
        """Set up; `changed(uri)` is called on a separate thread when the result of a query changes."""
        self._client = client
        self._changed = changed
        self._lock = threading.Lock()
        self._active: dict[str, _Subscription] = {}

    def subscribe(self, uri: str) -> None:
        """Add a subscriber. URIs that are not standing queries never change. Raises SemmapError."""
        if not uri.startswith(resources.WATCH):
            return
        arguments = resources.watch_arguments(uri)
        with self._lock:
            if (known := self._active.get(uri)) is not None:
                self._active[uri] = known._replace(subscribers=known.subscribers + 1)
                return
            if len(self._active) >= MOST:
                raise errors.Refused(f"limit of {MOST} standing queries reached; unsubscribe from one first")
            stack = ExitStack()
            standing = stack.enter_context(self._client.watch(**arguments))
            self._active[uri] = _Subscription(1, stack.close)

        def wait() -> None:
            try:
                for _ in standing.changes():
                    self._changed(uri)
            except errors.SemmapError:
                self._changed(uri)  # the next read returns the error

        threading.Thread(target=wait, name="standing query", daemon=True).start()

    def unsubscribe(self, uri: str) -> None:
        """Remove a subscriber; without subscribers, the query ends."""
        with self._lock:
            known = self._active.get(uri)
            if known is None:
                return
            if known.subscribers > 1:
                self._active[uri] = known._replace(subscribers=known.subscribers - 1)
                return
            del self._active[uri]
        known.end()

    def close(self) -> None:
        """End all queries."""
        with self._lock:
            ending, self._active = list(self._active.values()), {}
        for subscription in ending:
            subscription.end()
