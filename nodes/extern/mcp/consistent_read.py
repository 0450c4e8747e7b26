"""Reads that determine the commit of their result, for replies that do not include it."""

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
    """Return the result of `read()`, and the first and the last commit that it may refer to.

    `known()` is the newest commit of the coordinator, and `newest()` that of the knowledge base, which is
    never behind it. If `newest()` after the read is not greater than `known()` before, nothing changed in
    between, and the result refers to that commit. Otherwise the read is repeated a few times.
    """
    for _ in range(_TRIES):
        before = known()
        found = read()
        after = newest()
        if after <= before:
            break
    return found, min(before, after), after


def known(client: Client) -> int:
    """Return the newest commit of the coordinator. Raises NoAnswer."""
    return client.status().commit


def newest(client: Client) -> int:
    """Return the newest commit of the knowledge base. Raises NoAnswer."""
    page: Snapshot = bus.ask(
        client.session, keys.BRIDGE, SnapshotQuery.VERB, SnapshotQuery(limit=1), Snapshot
    )
    return page.seq
