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


class Heartbeat:
    """Beats for the thread that owns the node's state, and on it: when that hangs, it falls silent."""

    def __init__(self, name: str, session: bus.Session) -> None:
        self.due_s = 0.0
        """When it beats next, by the monotonic clock."""
        self._name = name
        self._host = socket.gethostname()
        self._session = session
        self._started_ns = time.time_ns()
        self._state: Literal["starting", "ready"] = "starting"
        self._detail: Callable[[], str] = str
        self._head: Callable[[], tuple[int | None, str]] = lambda: (None, "")
        self._last_error = ""
        self._notes: tuple[str, ...] = ()
        self._error_shown_until_s = 0.0
        self._ignored = 0
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
            notes=self._notes,
            commit=commit,
            digest=digest,
            ignored=self._ignored,
        )
        notify(health)
        self._health.put(codec.encode(health))

    def ready(self, detail: str) -> None:
        """Say so, at once, and let the liveliness token appear."""
        if self._state != "ready":
            self._state = "ready"
            self._token = bus.declare_presence(self._session, self._name)
            log.info("ready: %s", detail)
            self.due_s = 0.0
        self.describe(detail)
        self.beat()

    def describe(self, detail: str | Callable[[], str]) -> None:
        """Say this of the node's state, from the next beat on; a function is asked at each beat."""
        self._detail = detail if callable(detail) else lambda: detail

    def head(self, head: Callable[[], tuple[int, str]]) -> None:
        """Tell the number and the digest of the last commit with each beat, from the next one on."""
        self._head = head

    def ignore(self) -> None:
        """Count a publication that is no message. Any thread may do so: a count that is lost is no harm."""
        self._ignored += 1

    def note(self, notes: tuple[str, ...]) -> None:
        """Say this of what the node works with, from now on."""
        self._notes, self.due_s = notes, 0.0

    def report(self, text: str) -> None:
        """Log an error, and say it with the time of the day, from now on and for an hour."""
        log.error("%s", text)
        self._last_error, self.due_s = f"{time.strftime('%H:%M:%S')} {text}", 0.0
        self._error_shown_until_s = time.monotonic() + _ERROR_SHOWN_S
