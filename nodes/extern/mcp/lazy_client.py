"""The client of a server that may start before the system: it is connected when it is first needed."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable
from contextlib import AbstractContextManager, ExitStack
from typing import Final

from semmap.nodes.extern.client import Client
from semmap.schemas import errors

_SHARED_S: Final = 1.0
"""How long a failed attempt is that of all calls [s]."""


class LazyClient:
    """A client that is connected by the first call that finds the system. It can be used from any thread."""

    def __init__(
        self,
        connect: Callable[[], AbstractContextManager[Client]],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._connect = connect
        self._clock = clock
        self._stack = ExitStack()
        self._lock = threading.Lock()
        self._client: Client | None = None
        self._failure = ""
        self._retry_s = -math.inf
        self._is_closed = False

    def __call__(self) -> Client:
        """Return the client. Raises NoAnswer while the system is not running, and after `close`.

        Calls that have waited for the same attempt to connect fail together: an attempt can take seconds.
        """
        with self._lock:
            if self._is_closed:
                raise errors.NoAnswer("the server has ended")
            if self._client is not None:
                return self._client
            if self._clock() < self._retry_s:
                raise errors.NoAnswer(self._failure)
            try:
                self._client = self._stack.enter_context(self._connect())
            except errors.NoAnswer as error:
                self._failure, self._retry_s = error.text, self._clock() + _SHARED_S
                raise
            return self._client

    @property
    def connected(self) -> Client | None:
        """The client, or None before it is connected."""
        return self._client

    def close(self) -> None:
        """Disconnect, and do not connect again."""
        self._is_closed = True  # for the calls that wait for the lock
        with self._lock:
            self._stack.close()
