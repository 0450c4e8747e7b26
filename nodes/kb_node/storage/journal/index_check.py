"""Verification of the indexes of a journal, because a damaged index would hide intact commits.

The command ids, the touched names and the list of TBoxes are compared with the commits that a start replays
anyway. Up to the last checkpoint they are verified by a digest that was recorded with it.
"""

from __future__ import annotations

import hashlib
import sqlite3
from typing import Final

from msgspec import Struct, msgpack

from semmap.schemas import codec
from semmap.schemas.commits import Commit

_RECORD: Final = "index"
"""The key in the table `meta`."""
_INDEXES: Final = (
    "SELECT command_id AS key, seq FROM commits WHERE seq > ? AND seq <= ? ORDER BY command_id",
    "SELECT name AS key, seq FROM touches WHERE seq > ? AND seq <= ? ORDER BY name, seq",
    "SELECT '' AS key, seq FROM tboxes WHERE seq > ? AND seq <= ? ORDER BY seq",
)


class Record(Struct, frozen=True):
    """The digest of the indexes up to a commit."""

    seq: int
    digest: bytes


class Expected:
    """The index entries that the added commits should have."""

    def __init__(self) -> None:
        self._entries: tuple[set[tuple[str, int]], ...] = (set(), set(), set())

    def add(self, commit: Commit) -> None:
        """Add the entries of a commit."""
        ids, names, tboxes = self._entries
        ids.add((commit.id, commit.seq))
        names.update((name, commit.seq) for name in commit.names)
        if commit.tbox:
            tboxes.add(("", commit.seq))

    def matches(self, db: sqlite3.Connection, after: int) -> bool:
        """Return whether the indexes have exactly these entries for the commits after `after`."""
        return all(
            set(db.execute(query, (after, 1 << 62))) == entries
            for query, entries in zip(_INDEXES, self._entries, strict=True)
        )


def write(db: sqlite3.Connection, after: int, seq: int) -> None:
    """Record the digest of the indexes from `after` to `seq`, within the transaction of the caller."""
    value = msgpack.encode(Record(seq, _digest(db, after, seq)))
    db.execute("INSERT OR REPLACE INTO meta VALUES (?, ?)", (_RECORD, value))


def read(db: sqlite3.Connection) -> Record | None:
    """Return the last record, or None. Raises MsgspecError or TypeError if it is damaged."""
    row = db.execute("SELECT value FROM meta WHERE key = ?", (_RECORD,)).fetchone()
    return None if row is None else msgpack.decode(row[0], type=codec.prepared(Record))


def is_as_recorded(db: sqlite3.Connection, after: int, record: Record) -> bool:
    """Return whether the indexes still have the recorded digest."""
    return _digest(db, after, record.seq) == record.digest


def is_well_formed(db: sqlite3.Connection) -> bool:
    """Return whether SQLite can read the whole file, and its own indexes match the tables."""
    found: list[tuple[str]] = db.execute("PRAGMA integrity_check(1)").fetchall()
    return found == [("ok",)]


def _digest(db: sqlite3.Connection, after: int, until: int) -> bytes:
    digest = hashlib.blake2b(digest_size=16)
    for query in _INDEXES:
        joined = f"SELECT count(*), CAST(group_concat(key || ' ' || seq) AS BLOB) FROM ({query})"
        count, content = db.execute(joined, (after, until)).fetchone()
        digest.update(b"%d " % count)
        digest.update(content or b"")
    return digest.digest()
