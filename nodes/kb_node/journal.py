"""The truth on disk: every commit in an append-only SQLite file, with snapshots to start from.

A commit is durable when `append` returns: WAL with `synchronous=FULL`. Each row carries a digest chained
to the one before it, so that a damaged file is noticed and the damaged commit named.
"""

from __future__ import annotations

import hashlib
import sqlite3
from collections.abc import Iterator
from pathlib import Path

from msgspec import Struct

from schemas import codec, errors
from schemas.commits import Commit
from schemas.entities import Provenance
from schemas.explanations import Term, Triple

FILENAME = "journal.sqlite"
_SCHEMA = """
CREATE TABLE meta (key TEXT PRIMARY KEY, value BLOB NOT NULL) STRICT;
CREATE TABLE commits (
    seq INTEGER PRIMARY KEY, command_id TEXT NOT NULL, body BLOB NOT NULL, digest BLOB NOT NULL
) STRICT;
CREATE UNIQUE INDEX commits_by_command ON commits (command_id);
CREATE TABLE snapshots (seq INTEGER PRIMARY KEY, body BLOB NOT NULL) STRICT;
"""
_FORMAT = 1


class Marks(Struct, frozen=True, array_like=True):
    """The commits that last changed an entity at all, its pose, and its class or size."""

    any: int
    pose: int
    shape: int


class Checkpoint(Struct, frozen=True, kw_only=True):
    """The ABox after commit `seq`: start-up replays only what came later."""

    seq: int
    triples: tuple[Triple, ...] = ()
    marks: dict[Term, Marks] = {}
    commits: dict[int, Provenance] = {}
    """The commits that `marks` name."""


class Journal:
    """An open journal. One process at a time: a second one is refused."""

    def __init__(self, path: Path) -> None:
        """Open the journal at `path`. Raises Refused when another process holds it or it is damaged."""
        self.path = path
        self._db = sqlite3.connect(path, isolation_level=None, timeout=2.0)
        try:
            self._db.execute("PRAGMA locking_mode=EXCLUSIVE")
            self._db.execute("PRAGMA journal_mode=WAL")
            self._db.execute("PRAGMA synchronous=FULL")
            row = self._db.execute("SELECT value FROM meta WHERE key='format'").fetchone()
        except sqlite3.OperationalError as error:
            self._db.close()
            if "locked" in str(error):
                raise errors.Refused(f"another knowledge base is using {path}") from None
            raise errors.Refused(f"{path} cannot be opened: {error}") from None
        except sqlite3.DatabaseError as error:
            self._db.close()
            raise errors.Refused(
                f"{path} is damaged: {error}; start anew with --fresh (it is kept)"
            ) from None
        if row is None or int(row[0]) != _FORMAT:
            raise errors.Refused(f"{path} was written by another version of semmap; start anew with --fresh")
        self._digest = self._last_digest()

    @classmethod
    def create(cls, path: Path, tbox: bytes) -> Journal:
        """A new journal for the given TBox (N-Triples)."""
        db = sqlite3.connect(path)
        with db:
            db.executescript(_SCHEMA)
            db.execute("INSERT INTO meta VALUES ('format', ?)", (str(_FORMAT).encode(),))
            db.execute("INSERT INTO meta VALUES ('tbox', ?)", (tbox,))
        db.close()
        return cls(path)

    def close(self) -> None:
        """Release the file."""
        self._db.close()

    def tbox(self) -> bytes:
        """The TBox (N-Triples) that the commits were checked against."""
        return bytes(self._db.execute("SELECT value FROM meta WHERE key='tbox'").fetchone()[0])

    def append(self, commit: Commit) -> None:
        """Make `commit` durable. Raises Refused, with nothing written, when the disk does not take it."""
        body = codec.encode(commit)
        digest = _chain(self._digest, body)
        try:
            self._db.execute("INSERT INTO commits VALUES (?, ?, ?, ?)", (commit.seq, commit.id, body, digest))
        except sqlite3.Error as error:
            raise errors.Refused(f"the commit could not be written to {self.path}: {error}") from None
        self._digest = digest

    def commits(self, after: int = 0) -> Iterator[Commit]:
        """The commits later than `after`, in order. Raises Refused at the first damaged one."""
        before = self._digest_of(after)
        rows = self._db.execute("SELECT seq, body, digest FROM commits WHERE seq > ? ORDER BY seq", (after,))
        expected = after + 1
        for seq, body, digest in rows:
            if seq != expected or _chain(before, body) != digest:
                raise errors.Refused(
                    f"{self.path}: commit {expected} is damaged; the last good one is {expected - 1}"
                )
            before, expected = digest, seq + 1
            yield codec.decode(body, Commit)

    def commit_of(self, command_id: str) -> Commit | None:
        """The commit that a command made, if it made one."""
        row = self._db.execute("SELECT body FROM commits WHERE command_id = ?", (command_id,)).fetchone()
        return None if row is None else codec.decode(row[0], Commit)

    def checkpoint(self, checkpoint: Checkpoint) -> None:
        """Keep `checkpoint` as the place to start from, instead of older ones but the last."""
        self._db.execute(
            "INSERT OR REPLACE INTO snapshots VALUES (?, ?)", (checkpoint.seq, codec.encode(checkpoint))
        )
        self._db.execute(
            "DELETE FROM snapshots WHERE seq NOT IN (SELECT seq FROM snapshots ORDER BY seq DESC LIMIT 2)"
        )

    def last_checkpoint(self) -> Checkpoint:
        """The newest checkpoint; the empty map before commit 1 when there is none."""
        row = self._db.execute("SELECT body FROM snapshots ORDER BY seq DESC LIMIT 1").fetchone()
        return Checkpoint(seq=0) if row is None else codec.decode(row[0], Checkpoint)

    def _digest_of(self, seq: int) -> bytes:
        row = self._db.execute("SELECT digest FROM commits WHERE seq = ?", (seq,)).fetchone()
        return b"" if row is None else bytes(row[0])

    def _last_digest(self) -> bytes:
        row = self._db.execute("SELECT digest FROM commits ORDER BY seq DESC LIMIT 1").fetchone()
        return b"" if row is None else bytes(row[0])


def _chain(before: bytes, body: bytes) -> bytes:
    return hashlib.blake2b(before + body, digest_size=16).digest()
