"""Where a journal's history begins: with its first commit or, once it was compacted, with a snapshot."""

from __future__ import annotations

import hashlib
import sqlite3
from typing import Final

from msgspec import MsgspecError, Struct, msgpack

from semmap.schemas import codec

TABLE: Final = """CREATE TABLE beginning (
    seq INTEGER PRIMARY KEY, head BLOB NOT NULL, body BLOB NOT NULL, digest BLOB NOT NULL
) STRICT"""
"""One row; journals that were never compacted lack the table."""


class Beginning(Struct, frozen=True, kw_only=True):
    """The last commit that is part of the snapshot: what the first commit that is kept builds upon."""

    seq: int = 0
    """0 where nothing was compacted."""
    stamp_ns: int = 0
    chain: bytes = b""
    """The digest of all commits up to this one."""
    map_id: str = ""
    """Of the map: the digest of the very first commit, in hexadecimal."""
    begun_ns: int = 0
    """When the very first commit was made."""
    entities: int = 0
    body_digest: bytes = b""
    """Of the snapshot, which is a checkpoint in its encoding."""


def write(db: sqlite3.Connection, beginning: Beginning, body: bytes) -> None:
    """Let the history begin there; within a transaction of the caller's."""
    if not exists(db):
        db.execute(TABLE)
    head = msgpack.encode(beginning)
    db.execute("DELETE FROM beginning")
    db.execute("INSERT INTO beginning VALUES (?, ?, ?, ?)", (beginning.seq, head, body, digest(head)))


def exists(db: sqlite3.Connection) -> bool:
    """Was the journal compacted?"""
    return db.execute("SELECT 1 FROM sqlite_master WHERE name = 'beginning'").fetchone() is not None


def read(db: sqlite3.Connection) -> Beginning | None:
    """What was written; one at 0 where nothing was, None where it is damaged."""
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
    """The snapshot; None where it is damaged."""
    row = db.execute("SELECT body FROM beginning").fetchone()
    sound = row is not None and isinstance(row[0], bytes) and digest(row[0]) == beginning.body_digest
    return row[0] if sound else None


def digest(content: bytes) -> bytes:
    """Of a head or a snapshot."""
    return hashlib.blake2b(content, digest_size=16).digest()
