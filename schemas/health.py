"""Heartbeats."""

from __future__ import annotations

from typing import Literal

from msgspec import Struct

WORKING = ("loading ", "undoing ", "removing ")
"""The beginnings of the knowledge base's `detail` during a large change."""


class Health(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A heartbeat, sent once a second by the thread that owns a node's state, so a hung node sends none."""

    node: str
    host: str = ""
    """The name of its machine."""
    pid: int
    started_ns: int
    stamp_ns: int
    state: Literal["starting", "ready"]
    detail: str = ""
    last_error: str = ""
    commit: int | None = None
    """For the knowledge base: the number of the last commit, by which subscribers detect missed commits."""
    digest: str = ""
    """The digest of the last commit, by which subscribers detect forged commits."""
    shapes_ns: int = 0
    """For the knowledge base: the time at which relations last changed without a commit, by new shapes."""
    ignored: int = 0
    """The number of invalid messages since its start."""
    notes: tuple[str, ...] = ()
    """Notes for the operator, which are printed once and shown by `status`."""
