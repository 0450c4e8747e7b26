"""The truth on disk: every commit in an append-only SQLite file, with checkpoints to start from.

A commit is durable when `append` returns. Everything in the file has a digest, that of a commit chained to
the one before it, so that damage is noticed and the damaged commit named.
"""

from __future__ import annotations

import hashlib
import logging
import sqlite3
import threading
from array import array
from bisect import bisect_right
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import accumulate
from pathlib import Path
from typing import TypeVar

from msgspec import Struct, structs

from nodes.kb_node.storage import checkpoint_encoding, commit_encoding
from nodes.kb_node.storage.checkpoint_encoding import Checkpoint as Checkpoint
from nodes.kb_node.storage.sqlite_file import ANEW, JournalFile, mend
from schemas import codec, errors
from schemas.commits import Commit

log = logging.getLogger(__name__)
T = TypeVar("T")

FILENAME = "journal.sqlite"
_SCHEMA = """
CREATE TABLE meta (key TEXT PRIMARY KEY, value BLOB NOT NULL) STRICT;
CREATE TABLE tboxes (seq INTEGER PRIMARY KEY, value BLOB NOT NULL, digest BLOB NOT NULL) STRICT;
CREATE TABLE commits (
    seq INTEGER PRIMARY KEY, command_id TEXT NOT NULL, body BLOB NOT NULL, digest BLOB NOT NULL
) STRICT;
CREATE UNIQUE INDEX commits_by_command ON commits (command_id);
CREATE TABLE touches (name TEXT, seq INTEGER, PRIMARY KEY (name, seq)) STRICT, WITHOUT ROWID;
CREATE TABLE checkpoints (seq INTEGER PRIMARY KEY, body BLOB NOT NULL, digest BLOB NOT NULL) STRICT;
"""
_TOUCH = "INSERT INTO touches VALUES (?, ?)"
_FORMAT = b"4"
_PAGE = 256
_DENSE_FROM = 1 << 16
"""Bytes: what is larger takes less time to compress than to write."""


class Damaged(errors.Refused):
    """A commit is not as it was written. `last_good` is the number of the one before."""

    def __init__(self, path: Path, seq: int) -> None:
        super().__init__(f"{path}: commit {seq} is damaged; the last good one is {seq - 1}; {mend(path)}")
        self.last_good = seq - 1


class Journal:
    """An open journal. One process at a time: a second one is refused. Any thread may read."""

    def __init__(self, path: Path) -> None:
        """Open the journal at `path`. Raises InUse, Refused when it is damaged or of another version."""
        self.path = path
        self._file = JournalFile(path)
        self._digest: bytes | None = None  # that of the last commit, once it is known
        self._stamps = array("q")
        self._reading_stamps = threading.Lock()
        try:
            with self._file.reading() as db:
                form = db.execute("SELECT value FROM meta WHERE key='format'").fetchone()
            if form != (_FORMAT,):
                raise errors.Refused(f"{path} was written by another version of semmap; {ANEW}")
        except errors.Refused:
            self._file.close()
            raise

    @classmethod
    def create(cls, path: Path, tbox: bytes) -> Journal:
        """A new journal for the given TBox (N-Triples). Raises Refused when the disk does not take it."""
        try:
            db = sqlite3.connect(path)
            try:
                db.executescript(_SCHEMA)
                with db:
                    db.execute("INSERT INTO meta VALUES ('format', ?)", (_FORMAT,))
                    db.execute("INSERT INTO tboxes VALUES (0, ?, ?)", (tbox, _chain(b"", tbox)))
            finally:
                db.close()
        except sqlite3.Error as error:
            raise errors.Refused(f"cannot create a journal at {path}: {error}") from None
        return cls(path)

    def close(self) -> None:
        """Release the file."""
        self._file.close()

    @property
    def last(self) -> int:
        """The number of the last commit; 0 before the first."""
        with self._file.reading() as db:
            row: tuple[int | None] = db.execute("SELECT max(seq) FROM commits").fetchone()
        return row[0] or 0

    def tbox(self, seq: int) -> bytes:
        """The TBox (N-Triples) that holds after commit `seq`. Raises Refused when it is damaged."""
        query = "SELECT value, digest FROM tboxes WHERE seq <= ? ORDER BY seq DESC LIMIT 1"
        with self._file.reading() as db:
            row = db.execute(query, (seq,)).fetchone()
        if row is None or not _is_sound(b"", *row):
            raise errors.Refused(f"{self.path}: the TBox in it is damaged; {mend(self.path)}")
        return bytes(row[0])

    def tbox_changes(self, after: int) -> list[int]:
        """The numbers of the commits later than `after` that replaced the TBox, newest first."""
        with self._file.reading() as db:
            rows = db.execute("SELECT seq FROM tboxes WHERE seq > ? ORDER BY seq DESC", (after,))
            return [seq for (seq,) in rows]

    def append(
        self, commit: Commit, tbox: bytes | None = None, *, begun: commit_encoding.EarlyBody | None = None
    ) -> bytes:
        """Make `commit` durable, with the TBox (N-Triples) that holds from now on if it is another.

        `begun` is its body, if that was begun before. Returns the digest of all commits with this one.

        Raises NotWritten when the disk does not take it.
        """
        if commit.digest:  # one from another journal, where it was chained to what was before it there
            commit = structs.replace(commit, digest="")
        if self._digest is None:
            with self._file.reading() as db:
                self._digest = _digest_of(db, self.last)
        whole = None if begun is None else begun.finish(commit)
        with self._file.writing(f"commit {commit.seq}") as db:
            touches = [(name, commit.seq) for name in commit.names]
            if len(touches) == 1:
                db.execute(_TOUCH, touches[0])
            else:
                db.executemany(_TOUCH, touches)
            body = codec.encode(commit, dense_from=_DENSE_FROM) if whole is None else whole.result()
            digest = _chain(self._digest, body)
            db.execute("INSERT INTO commits VALUES (?, ?, ?, ?)", (commit.seq, commit.id, body, digest))
            if tbox is not None:
                row = (commit.seq, tbox, _chain(b"", tbox))
                db.execute("INSERT INTO tboxes VALUES (?, ?, ?)", row)
        self._digest = digest
        return digest

    @contextmanager
    def together(self) -> Iterator[None]:
        """What is appended within becomes durable at its end, with one wait for the disk.

        Raises NotWritten, with none of it written, when the disk does not take it.
        """
        digest = self._digest
        try:
            with self._file.writing("several commits"):
                yield
        except BaseException:
            self._digest = digest
            raise

    def commits(self, after: int = 0) -> Iterator[Commit]:
        """The commits later than `after`, in order. Raises Damaged at the first damaged one."""
        return (_signed(body, digest) for body, digest in self._bodies(after))

    def outlines(self, kind: type[T]) -> Iterator[T]:
        """All commits in order, of each what `kind` has fields for. Raises Damaged at the first damaged."""
        return (codec.decode(body, kind) for body, _ in self._bodies(0))

    def verify(self, progress: Callable[[], None] = lambda: None) -> None:
        """Read every commit and TBox. Raises Damaged at the first damaged commit, Refused for a TBox."""
        for _ in self._bodies(0):
            progress()
        with self._file.reading() as db:
            rows = db.execute("SELECT seq FROM tboxes").fetchall()
        for (seq,) in rows:
            self.tbox(seq)

    def is_whole(self) -> bool:
        """Can SQLite read all of the file, and do its indexes fit its tables?"""
        try:
            with self._file.reading() as db:
                found: list[tuple[str]] = db.execute("PRAGMA integrity_check(1)").fetchall()
        except errors.Refused:
            return False
        return found == [("ok",)]

    def commit(self, seq: int) -> Commit:
        """The commit with that number, which must be there. Raises Damaged."""
        for body, digest in self._bodies(seq - 1, size=1):
            return _signed(body, digest)
        raise Damaged(self.path, seq)

    def commit_of(self, command_id: str) -> Commit | None:
        """The commit that a command made, if it made one."""
        with self._file.reading() as db:
            row = db.execute("SELECT seq FROM commits WHERE command_id = ?", (command_id,)).fetchone()
        return None if row is None else self.commit(row[0])

    def touching(self, name: str, after: int = 0, until: int | None = None) -> list[int]:
        """The numbers of the commits that touched an entity, in order."""
        query = "SELECT seq FROM touches WHERE name = ? AND seq > ? AND seq <= ? ORDER BY seq"
        with self._file.reading() as db:
            rows = db.execute(query, (name, after, self.last if until is None else until))
            return [seq for (seq,) in rows]

    def digest(self, seq: int) -> bytes:
        """That of all commits up to one; empty before the first."""
        with self._file.reading() as db:
            return _digest_of(db, seq)

    def extent(self, after: int) -> tuple[int, int]:
        """How many commits are later than `after`, and their size [bytes]."""
        query = "SELECT count(*), coalesce(sum(length(body)), 0) FROM commits WHERE seq > ?"
        with self._file.reading() as db:
            count, size = db.execute(query, (after,)).fetchone()
        return count, size

    def undoing(self, after: int) -> list[int]:
        """The numbers of the commits later than `after` that took others back, newest first; reads all."""
        query = "SELECT seq, body FROM commits WHERE seq > ? ORDER BY seq DESC"
        with self._file.reading() as db:
            return [seq for seq, body in db.execute(query, (after,)) if codec.decode(body, _Undoing).undoes]

    def last_touches(self, until: int) -> list[tuple[str, int]]:
        """Each entity's name with the last commit up to `until` that touched it."""
        query = "SELECT name, max(seq) FROM touches WHERE seq <= ? GROUP BY name"
        with self._file.reading() as db:
            return db.execute(query, (until,)).fetchall()

    def seq_at(self, stamp_ns: int) -> int:
        """The last commit that is stamped up to a time; 0 before the first.

        Where the clock was set back meanwhile a time comes twice, and the second counts.
        """
        with self._reading_stamps:
            stamps = self._stamps_so_far()
            earliest_since = list(accumulate(reversed(stamps), min))[::-1]
        return bisect_right(earliest_since, stamp_ns)

    def _stamps_so_far(self) -> array[int]:
        """Those of all commits: read once, as far as they are not known yet."""
        stamps = self._stamps
        while rows := self._page(len(stamps), _PAGE):
            stamps.extend(codec.decode(body, _Stamp).stamp_ns for _, body, _ in rows)
        return stamps

    def stamp_of(self, seq: int) -> int:
        """When a commit was made [ns since 1970]."""
        with self._file.reading() as db:
            row = db.execute("SELECT body FROM commits WHERE seq = ?", (seq,)).fetchone()
        if row is None:
            raise Damaged(self.path, seq)
        return codec.decode(row[0], _Stamp).stamp_ns

    def checkpoint(self, checkpoint: Checkpoint, progress: Callable[[], None] = lambda: None) -> None:
        """Keep `checkpoint` as the place to start from, and of the older ones the last.

        Raises Refused, with nothing changed, when the disk does not take it.
        """
        body = checkpoint_encoding.encode(checkpoint, progress)
        row = (checkpoint.seq, body, _chain(b"", body))
        with self._file.writing(f"the checkpoint after commit {checkpoint.seq}") as db:
            db.execute("INSERT OR REPLACE INTO checkpoints VALUES (?, ?, ?)", row)
            db.execute(
                "DELETE FROM checkpoints"
                " WHERE seq NOT IN (SELECT seq FROM checkpoints ORDER BY seq DESC LIMIT 2)"
            )

    def last_checkpoint(self, progress: Callable[[], None] = lambda: None) -> Checkpoint:
        """The newest sound checkpoint; without any, the empty map before commit 1."""
        with self._file.reading() as db:
            for seq, body, digest in db.execute("SELECT * FROM checkpoints ORDER BY seq DESC"):
                if _is_sound(b"", body, digest):
                    return checkpoint_encoding.decode(body, progress)
                log.warning("%s: the checkpoint after commit %d is damaged and not used", self.path, seq)
        return Checkpoint(seq=0)

    def _bodies(self, after: int, size: int = _PAGE) -> Iterator[tuple[bytes, bytes]]:
        """The sound bodies and their digests."""
        with self._file.reading() as db:
            before = _digest_of(db, after)
        seq = after
        while rows := self._page(seq, size):
            for number, body, digest in rows:
                seq += 1
                if number != seq or not _is_sound(before, body, digest):
                    raise Damaged(self.path, seq)
                before = digest
                yield body, digest

    def _page(self, after: int, size: int) -> list[tuple[int, bytes, bytes]]:
        """The next rows; where they cannot be read together, one at a time, so that the bad one is known."""
        query = "SELECT seq, body, digest FROM commits WHERE seq > ? ORDER BY seq LIMIT ?"
        try:
            with self._file.reading() as db:
                return db.execute(query, (after, size)).fetchall()
        except errors.Refused:
            if size == 1:
                raise Damaged(self.path, after + 1) from None
            return self._page(after, 1)


class _Stamp(Struct):
    """The part of a commit that tells when it was made."""

    stamp_ns: int


class _Undoing(Struct):
    """The part of a commit that tells what it took back."""

    undoes: tuple[int, ...] = ()


def _signed(body: bytes, digest: bytes) -> Commit:
    commit: Commit = codec.decode(body, Commit)
    return structs.replace(commit, digest=digest.hex())


def _is_sound(before: bytes, body: object, digest: object) -> bool:
    """Is it what was written? Of a damaged page SQLite may read anything, numbers and NULL too."""
    return isinstance(body, bytes) and _chain(before, body) == digest


def _chain(before: bytes, body: bytes) -> bytes:
    digest = hashlib.blake2b(before, digest_size=16)
    digest.update(body)
    return digest.digest()


def _digest_of(db: sqlite3.Connection, seq: int) -> bytes:
    """That of a commit; empty before the first."""
    row = db.execute("SELECT digest FROM commits WHERE seq = ?", (seq,)).fetchone()
    return b"" if row is None else bytes(row[0])
