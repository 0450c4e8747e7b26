"""Whether what commits are found by is as the commits say: damage there would hide what is sound.

The ids of commands, the names of entities that were touched, and the list of TBoxes are compared with those
commits that a start replays anyway, and up to the last checkpoint by a digest that was recorded with it.
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
    """What the indexes said of the commits up to one."""

    seq: int
    digest: bytes


class Expected:
    """What the indexes should say of the commits that are taken in."""

    def __init__(self) -> None:
        self._said: tuple[set[tuple[str, int]], ...] = (set(), set(), set())

    def add(self, commit: Commit) -> None:
        """Take in a commit."""
        ids, names, tboxes = self._said
        ids.add((commit.id, commit.seq))
        names.update((name, commit.seq) for name in commit.names)
        if commit.tbox:
            tboxes.add(("", commit.seq))

    def matches(self, db: sqlite3.Connection, after: int) -> bool:
        """Do the indexes say this, and nothing else, of the commits later than `after`?"""
        return all(
            set(db.execute(query, (after, 1 << 62))) == said
            for query, said in zip(_INDEXES, self._said, strict=True)
        )


def write(db: sqlite3.Connection, after: int, seq: int) -> None:
    """Record what the indexes say of the commits from `after` to `seq`; within the caller's transaction."""
    value = msgpack.encode(Record(seq, _digest(db, after, seq)))
    db.execute("INSERT OR REPLACE INTO meta VALUES (?, ?)", (_RECORD, value))


def read(db: sqlite3.Connection) -> Record | None:
    """What was recorded last; None where nothing was. Raises MsgspecError or TypeError if it is damaged."""
    row = db.execute("SELECT value FROM meta WHERE key = ?", (_RECORD,)).fetchone()
    return None if row is None else msgpack.decode(row[0], type=codec.prepared(Record))


def is_as_recorded(db: sqlite3.Connection, after: int, record: Record) -> bool:
    """Do the indexes still say so?"""
    return _digest(db, after, record.seq) == record.digest


def is_well_formed(db: sqlite3.Connection) -> bool:
    """Can SQLite read all of the file, and do its own indexes fit its tables?"""
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
