"""Availability: tells a watcher that the system went down, that it is back, and with which map."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import NamedTuple

from semmap.nodes import bus
from semmap.nodes.extern.client import Client
from semmap.schemas import errors, wording

WENT_DOWN = "the knowledge base is down; waiting for it to come back"
CAME_BACK = "the knowledge base is back, with the same map"


class _Beginning(NamedTuple):
    """What a map began with: no two maps have the same."""

    stamp_ns: int
    reason: str


@contextmanager
def told(client: Client, tell: Callable[[str], None]) -> Iterator[None]:
    """Meanwhile `tell(sentence)` is called, on another thread, when the system goes down or comes back."""
    changes: queue.SimpleQueue[bool | None] = queue.SimpleQueue()
    subscriber = bus.follow_presence(client.session, "kb_node", changes.put)
    thread = threading.Thread(target=_tell_of, args=(client, changes, tell), daemon=True)
    thread.start()
    try:
        yield
    finally:
        subscriber.undeclare()
        changes.put(None)
        thread.join(timeout=bus.PATIENCE_S)


def _tell_of(client: Client, changes: queue.SimpleQueue[bool | None], tell: Callable[[str], None]) -> None:
    before: _Beginning | None = None
    while (there := changes.get()) is not None:
        if not there:
            tell(WENT_DOWN)
            continue
        try:
            now = _beginning(client)
            if before is not None:
                tell(CAME_BACK if now == before else _another(client, now))
            before = now
        except errors.SemmapError:  # it has gone again, or this client may not ask it
            continue


def _beginning(client: Client) -> _Beginning:
    (first,) = client.history(until=1, limit=1)
    return _Beginning(first.stamp_ns, first.reason)


def _another(client: Client, beginning: _Beginning) -> str:
    status = client.status()
    counts = f"{wording.entities(status.entities)}, commit {status.commit}"
    return (
        f"this endpoint now serves another map ({beginning.reason}; {counts}); what follows is about that map"
    )
