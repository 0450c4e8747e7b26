"""The start of the history in a journal: its first commit or, after compaction, a snapshot."""

from __future__ import annotations

import hashlib
import sqlite3
from typing import Final

from msgspec import MsgspecError, Struct, msgpack

from semmap.schemas import codec

TABLE: Final = """CREATE TABLE beginning (
    seq INTEGER PRIMARY KEY, head BLOB NOT NULL, body BLOB NOT NULL, digest BLOB NOT NULL
) STRICT"""
"""A table with one row, which journals without compaction lack."""


class Beginning(Struct, frozen=True, kw_only=True):
    """The last commit that is part of the snapshot, on which the first stored commit is based."""

    seq: int = 0
    """0 without compaction."""
    stamp_ns: int = 0
    chain: bytes = b""
    """The digest of all commits up to this one."""
    map_id: str = ""
    """The identity of the map: the digest of the very first commit, in hexadecimal."""
    begun_ns: int = 0
    """The time of the very first commit."""
    entities: int = 0
    body_digest: bytes = b""
    """The digest of the snapshot, which has the encoding of a checkpoint."""


def write(db: sqlite3.Connection, beginning: Beginning, body: bytes) -> None:
    """Store the start of the history, within the transaction of the caller."""
    if not exists(db):
        db.execute(TABLE)
    head = msgpack.encode(beginning)
    db.execute("DELETE FROM beginning")
    db.execute("INSERT INTO beginning VALUES (?, ?, ?, ?)", (beginning.seq, head, body, digest(head)))


def exists(db: sqlite3.Connection) -> bool:
    """Return whether the journal was compacted."""
    return db.execute("SELECT 1 FROM sqlite_master WHERE name = 'beginning'").fetchone() is not None


def read(db: sqlite3.Connection) -> Beginning | None:
    """Return the stored start, one with `seq` 0 without compaction, or None if it is damaged."""
    if not exists(db):
        return Beginning()
    row = db.execute("SELECT seq, head, digest FROM beginning").fetchone()
    try:
        if row is None or digest(row[1]) != row[2]:
            return None
        found = msgpack.decode(row[1], type=codec.prepared(Beginning))
    except (MsgspecError, TypeError):
        return None
    return found if found.seq == row[0] else None


def body_of(db: sqlite3.Connection, beginning: Beginning) -> bytes | None:
    """Return the snapshot, or None if it is damaged."""
    row = db.execute("SELECT body FROM beginning").fetchone()
    sound = row is not None and isinstance(row[0], bytes) and digest(row[0]) == beginning.body_digest
    return row[0] if sound else None


def digest(content: bytes) -> bytes:
    """Return the digest of a head or snapshot."""
    return hashlib.blake2b(content, digest_size=16).digest()
