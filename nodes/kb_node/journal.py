"""The truth on disk: every commit in an append-only SQLite file, with checkpoints to start from.

A commit is durable when `append` returns: WAL with `synchronous=FULL`. Everything in the file has a digest,
that of a commit chained to the one before it, so that damage is noticed and the damaged commit named.
"""

from __future__ import annotations

import hashlib
import logging
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from msgspec import Struct

from schemas import codec, errors
from schemas.commits import Commit
from schemas.entities import Provenance
from schemas.explanations import Term, Triple

log = logging.getLogger(__name__)

FILENAME = "journal.sqlite"
_SCHEMA = """
CREATE TABLE meta (key TEXT PRIMARY KEY, value BLOB NOT NULL, digest BLOB NOT NULL) STRICT;
CREATE TABLE commits (
    seq INTEGER PRIMARY KEY, command_id TEXT NOT NULL, body BLOB NOT NULL, digest BLOB NOT NULL
) STRICT;
CREATE UNIQUE INDEX commits_by_command ON commits (command_id);
CREATE TABLE checkpoints (seq INTEGER PRIMARY KEY, body BLOB NOT NULL, digest BLOB NOT NULL) STRICT;
"""
_FORMAT = b"2"
_ANEW = "start anew with --fresh (it is kept)"


class InUse(errors.Refused):
    """Another process has the journal open."""


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
    """Entity to its marks."""
    commits: dict[int, Provenance] = {}
    """The commits that `marks` name."""


class Journal:
    """An open journal. One process at a time: a second one is refused."""

    def __init__(self, path: Path) -> None:
        """Open the journal at `path`. Raises InUse, Refused when it is damaged or of another version."""
        self.path = path
        with self._reading():
            self._db = sqlite3.connect(path, isolation_level=None, timeout=2.0)
        try:
            with self._reading():
                self._db.execute("PRAGMA locking_mode=EXCLUSIVE")
                self._db.execute("PRAGMA journal_mode=WAL")
                self._db.execute("PRAGMA synchronous=FULL")
                form = self._row("SELECT value FROM meta WHERE key='format'")
                self._digest = self._digest_of(None)
            if form != (_FORMAT,):
                raise errors.Refused(f"{path} was written by another version of semmap; {_ANEW}")
        except errors.Refused:
            self._db.close()
            raise

    @classmethod
    def create(cls, path: Path, tbox: bytes) -> Journal:
        """A new journal for the given TBox (N-Triples). Raises Refused when the disk does not take it."""
        try:
            db = sqlite3.connect(path)
            try:
                db.executescript(_SCHEMA)
                with db:
                    rows = [("format", _FORMAT, _chain(b"", _FORMAT)), ("tbox", tbox, _chain(b"", tbox))]
                    db.executemany("INSERT INTO meta VALUES (?, ?, ?)", rows)
            finally:
                db.close()
        except sqlite3.Error as error:
            raise errors.Refused(f"no journal can be made at {path}: {error}") from None
        return cls(path)

    def close(self) -> None:
        """Release the file."""
        self._db.close()

    def tbox(self) -> bytes:
        """The TBox (N-Triples) that the commits were checked against. Raises Refused when it is damaged."""
        with self._reading():
            row = self._row("SELECT value, digest FROM meta WHERE key='tbox'")
        if row is None or _chain(b"", row[0]) != row[1]:
            raise errors.Refused(f"{self.path}: the TBox in it is damaged; {_ANEW}")
        return bytes(row[0])

    def append(self, commit: Commit) -> None:
        """Make `commit` durable. Raises Refused, with nothing written, when the disk does not take it."""
        body = codec.encode(commit)
        digest = _chain(self._digest, body)
        with self._writing(f"commit {commit.seq}"):
            self._db.execute("INSERT INTO commits VALUES (?, ?, ?, ?)", (commit.seq, commit.id, body, digest))
        self._digest = digest

    @contextmanager
    def together(self) -> Iterator[None]:
        """What is appended within becomes durable at its end, with one wait for the disk.

        Raises Refused, with none of it written, when the disk does not take it.
        """
        digest = self._digest
        with self._writing("several commits"):
            self._db.execute("BEGIN")
        try:
            yield
            with self._writing("several commits"):
                self._db.execute("COMMIT")
        except BaseException:
            self._digest = digest
            if self._db.in_transaction:
                self._db.execute("ROLLBACK")
            raise

    def commits(self, after: int = 0) -> Iterator[Commit]:
        """The commits later than `after`, in order. Raises Refused at the first damaged one."""
        with self._reading():
            before = self._digest_of(after)
            rows = self._db.execute(
                "SELECT seq, body, digest FROM commits WHERE seq > ? ORDER BY seq", (after,)
            )
            for expected, (seq, body, digest) in enumerate(rows, start=after + 1):
                if seq != expected or _chain(before, body) != digest:
                    raise errors.Refused(
                        f"{self.path}: commit {expected} is damaged; the last good one is {expected - 1}"
                    )
                before = digest
                yield codec.decode(body, Commit)

    def commit_of(self, command_id: str) -> Commit | None:
        """The commit that a command made, if it made one."""
        with self._reading():
            row = self._row("SELECT seq FROM commits WHERE command_id = ?", (command_id,))
            return None if row is None else next(self.commits(after=row[0] - 1))

    def checkpoint(self, checkpoint: Checkpoint) -> None:
        """Keep `checkpoint` as the place to start from, and of the older ones the last.

        Raises Refused, with nothing changed, when the disk does not take it.
        """
        body = codec.encode(checkpoint)
        row = (checkpoint.seq, body, _chain(b"", body))
        with self._writing(f"the checkpoint after commit {checkpoint.seq}"):
            self._db.execute("INSERT OR REPLACE INTO checkpoints VALUES (?, ?, ?)", row)
            self._db.execute(
                "DELETE FROM checkpoints"
                " WHERE seq NOT IN (SELECT seq FROM checkpoints ORDER BY seq DESC LIMIT 2)"
            )

    def last_checkpoint(self) -> Checkpoint:
        """The newest sound checkpoint; without any, the empty map before commit 1."""
        with self._reading():
            for seq, body, digest in self._db.execute("SELECT * FROM checkpoints ORDER BY seq DESC"):
                if _chain(b"", body) == digest:
                    return codec.decode(body, Checkpoint)
                log.warning("%s: the checkpoint after commit %d is damaged and not used", self.path, seq)
        return Checkpoint(seq=0)

    def _row(self, query: str, values: tuple[Any, ...] = ()) -> tuple[Any, ...] | None:
        row: tuple[Any, ...] | None = self._db.execute(query, values).fetchone()
        return row

    def _digest_of(self, seq: int | None) -> bytes:
        """That of commit `seq`, or of the last one; empty before the first."""
        which = "ORDER BY seq DESC LIMIT 1" if seq is None else "WHERE seq = ?"
        row = self._row(f"SELECT digest FROM commits {which}", () if seq is None else (seq,))
        return b"" if row is None else bytes(row[0])

    @contextmanager
    def _reading(self) -> Iterator[None]:
        try:
            yield
        except sqlite3.OperationalError as error:
            if "locked" in str(error):
                raise InUse(f"another knowledge base is using {self.path}") from None
            raise errors.Refused(f"{self.path} cannot be read: {error}") from None
        except sqlite3.ProgrammingError:
            raise
        except sqlite3.DatabaseError as error:
            raise errors.Refused(f"{self.path} is damaged: {error}; {_ANEW}") from None

    @contextmanager
    def _writing(self, what: str) -> Iterator[None]:
        try:
            yield
        except sqlite3.Error as error:
            raise errors.Refused(f"{what} could not be written to {self.path}: {error}") from None


def _chain(before: bytes, body: bytes) -> bytes:
    return hashlib.blake2b(before + body, digest_size=16).digest()
