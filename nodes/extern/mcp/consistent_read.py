"""Which commit an answer is true of: replies do not say, so the map is watched while it is asked."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, TypeVar

from semmap.nodes import bus
from semmap.nodes.extern.client import Client
from semmap.schemas import keys
from semmap.schemas.bridge import SnapshotQuery
from semmap.schemas.commits import Snapshot

R = TypeVar("R")

_TRIES: Final = 5


def read_at_one_commit(
    known: Callable[[], int], newest: Callable[[], int], read: Callable[[], R]
) -> tuple[R, int, int]:
    """What `read()` gave, and the first and the last commit that it may be true of.

    `known()` is the newest commit that the coordinator knows, `newest()` that of the knowledge base, which is
    ahead of it if anything. So where the second, asked afterwards, is no more than the first, asked before,
    nothing changed in between, and all that was asked is true of that one commit. If not, it is read again, a
    few times.
    """
    for _ in range(_TRIES):
        before = known()
        found = read()
        after = newest()
        if after <= before:
            break
    return found, min(before, after), after


def known(client: Client) -> int:
    """The newest commit that the coordinator knows of. Raises NoAnswer."""
    return client.status().commit


def newest(client: Client) -> int:
    """The newest commit of the knowledge base. Raises NoAnswer."""
    page: Snapshot = bus.ask(
        client.session, keys.BRIDGE, SnapshotQuery.VERB, SnapshotQuery(limit=1), Snapshot
    )
    return page.seq
