"""Heartbeats."""

from __future__ import annotations

from typing import Literal

from msgspec import Struct

WORKING = ("loading ", "undoing ", "removing ")
"""With one of these words the knowledge base's detail begins while a large change takes long."""


class Health(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Sent once a second by the thread that owns a node's state, so a hung node falls silent."""

    node: str
    host: str = ""
    """The name of the machine that it runs on."""
    pid: int
    started_ns: int
    stamp_ns: int
    state: Literal["starting", "ready"]
    detail: str = ""
    last_error: str = ""
    commit: int | None = None
    """Of the knowledge base: the number of the last commit, so that a follower notices what it has missed."""
    digest: str = ""
    """That of the last commit, so that a follower notices one that was never made."""
    ignored: int = 0
    """Publications that were no messages, since its start."""
    notes: tuple[str, ...] = ()
    """What whoever runs the system should know once, and `status` goes on to show."""
