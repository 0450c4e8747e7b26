"""The heartbeat: a node publishes its state once a second."""

from __future__ import annotations

import logging
import os
import socket
import time
from collections.abc import Callable
from typing import Literal

from semmap.nodes import bus
from semmap.nodes.runtime.notify import notify
from semmap.schemas import codec, keys
from semmap.schemas.health import Health

log = logging.getLogger(__name__)

_PERIOD_S = 1.0
_ERROR_SHOWN_S = 3600.0
_MAX_DROPPED = 5


class Heartbeat:
    """Publishes heartbeats on the thread that owns the node's state: if that hangs, the heartbeat stops."""

    def __init__(self, name: str, session: bus.Session) -> None:
        self.due_s = 0.0
        """Time of the next heartbeat, by the monotonic clock."""
        self._name = name
        self._host = socket.gethostname()
        self._session = session
        self._started_ns = time.time_ns()
        self._state: Literal["starting", "ready"] = "starting"
        self._detail: Callable[[], str] = str
        self._head: Callable[[], tuple[int | None, str]] = lambda: (None, "")
        self._shapes_ns = 0
        self._last_error = ""
        self._notes: tuple[str, ...] = ()
        self._error_shown_until_s = 0.0
        self._ignored = 0
        self._dropped: dict[str, None] = {}
        self._health = bus.publisher(session, keys.HEALTH, keys.health_key(name))

    def beat(self) -> None:
        """Send the heartbeat if it is due."""
        now_s = time.monotonic()
        if now_s < self.due_s:
            return
        self.due_s = now_s + _PERIOD_S
        commit, digest = self._head()
        health = Health(
            node=self._name,
            host=self._host,
            pid=os.getpid(),
            started_ns=self._started_ns,
            stamp_ns=time.time_ns(),
            state=self._state,
            detail=self._detail(),
            last_error=self._last_error if now_s < self._error_shown_until_s else "",
            notes=(*self._notes, *self._dropped),
            commit=commit,
            digest=digest,
            shapes_ns=self._shapes_ns,
            ignored=self._ignored,
        )
        notify(health)
        self._health.put(codec.encode(health))

    def ready(self, detail: str) -> None:
        """Mark the node as ready: publish a heartbeat immediately, and declare the liveliness token."""
        if self._state != "ready":
            self._state = "ready"
            self._token = bus.declare_presence(self._session, self._name)
            log.info("ready: %s", detail)
            self.due_s = 0.0
        self.describe(detail)
        self.beat()

    def describe(self, detail: str | Callable[[], str]) -> None:
        """Set the detail of the next heartbeats; a function is called for each heartbeat."""
        self._detail = detail if callable(detail) else lambda: detail

    def head(self, head: Callable[[], tuple[int, str]]) -> None:
        """Add the number and digest of the last commit to the heartbeats."""
        self._head = head

    def note_shapes(self) -> None:
        """Note that relations have changed without a commit, and send the next heartbeat soon."""
        self._shapes_ns, self.due_s = time.time_ns(), 0.0

    def ignore(self) -> None:
        """Count a malformed publication. Any thread may call this: a lost count does no harm."""
        self._ignored += 1

    def drop(self, text: str) -> None:
        """Count an invalid message, and add `text` to the notes, once, and for a limited number of texts."""
        self._ignored += 1
        if text not in self._dropped and len(self._dropped) < _MAX_DROPPED:
            log.warning("%s", text)
            self._dropped[text], self.due_s = None, 0.0

    def note(self, notes: tuple[str, ...]) -> None:
        """Set the notes of the node, from now on."""
        self._notes, self.due_s = notes, 0.0

    def report(self, text: str) -> None:
        """Log an error, and show it in the heartbeats with the time of day for an hour."""
        log.error("%s", text)
        self._last_error, self.due_s = f"{time.strftime('%H:%M:%S')} {text}", 0.0
        self._error_shown_until_s = time.monotonic() + _ERROR_SHOWN_S
