"""Reports to a subscriber that the knowledge base went down or came back, and with which map."""

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


class _FirstCommit(NamedTuple):
    """The first commit of a map, which identifies the map."""

    stamp_ns: int
    reason: str


@contextmanager
def report_availability(client: Client, tell: Callable[[str], None]) -> Iterator[None]:
    """Call `tell(text)`, on another thread, whenever the knowledge base goes down or comes back."""
    changes: queue.SimpleQueue[bool | None] = queue.SimpleQueue()
    subscriber = bus.follow_presence(client.session, "kb_node", changes.put)
    thread = threading.Thread(target=_report_changes, args=(client, changes, tell), daemon=True)
    thread.start()
    try:
        yield
    finally:
        subscriber.undeclare()
        changes.put(None)
        thread.join(timeout=bus.PATIENCE_S)


def _report_changes(
    client: Client, changes: queue.SimpleQueue[bool | None], tell: Callable[[str], None]
) -> None:
    before: _FirstCommit | None = None
    while (is_up := changes.get()) is not None:
        if not is_up:
            tell(WENT_DOWN)
            continue
        try:
            now = _first_commit(client)
            if before is not None:
                tell(CAME_BACK if now == before else _other_map_text(client, now))
            before = now
        except errors.SemmapError:  # it went down again, or this client lacks the permission
            continue


def _first_commit(client: Client) -> _FirstCommit:
    (first,) = client.history(until=1, limit=1)
    return _FirstCommit(first.stamp_ns, first.reason)


def _other_map_text(client: Client, beginning: _FirstCommit) -> str:
    status = client.status()
    counts = f"{wording.entities(status.entities)}, commit {status.commit}"
    return f"the endpoint now serves another map ({beginning.reason}; {counts}); further output is about it"
