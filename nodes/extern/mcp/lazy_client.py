"""The client of a server that may start before the system: it is connected when it is first needed."""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import AbstractContextManager, ExitStack

from semmap.nodes.extern.client import Client


class LazyClient:
    """A client that is connected by the first call that finds the system. It can be used from any thread."""

    def __init__(self, connect: Callable[[], AbstractContextManager[Client]]) -> None:
        self._connect = connect
        self._stack = ExitStack()
        self._lock = threading.Lock()
        self._client: Client | None = None

    def __call__(self) -> Client:
        """Return the client. Raises NoAnswer while the system is not running."""
        with self._lock:
            if self._client is None:
                self._client = self._stack.enter_context(self._connect())
            return self._client

    @property
    def connected(self) -> Client | None:
        """The client, or None before it is connected."""
        return self._client

    def close(self) -> None:
        """Disconnect."""
        self._stack.close()
