"""The truth on disk: every commit in an append-only SQLite file, with checkpoints to start from.

A commit is durable when `append` returns. Everything in the file has a digest, that of a commit chained to
the one before it, so that damage is noticed and the damaged commit named. What could be made anew from the
commits, the indexes, is compared with them. A journal that was compacted begins with a snapshot.
"""

from __future__ import annotations

import hashlib
import logging
import sqlite3
import threading
from array import array
from bisect import bisect_right
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from itertools import accumulate
from pathlib import Path
from typing import NamedTuple, TypeVar

from msgspec import MsgspecError, Struct, structs

from nodes.kb_node.storage import beginning, checkpoint_encoding, commit_encoding, dense, index_check
from nodes.kb_node.storage.beginning import Beginning
from nodes.kb_node.storage.checkpoint_encoding import Checkpoint as Checkpoint
from nodes.kb_node.storage.sqlite_file import ANEW, JournalFile, mend
from schemas import errors
from schemas.backups import Kind
from schemas.commits import Commit

log = logging.getLogger(__name__)
T = TypeVar("T")

FILENAME = "journal.sqlite"
SCHEMA = """
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
FORMAT = b"4"
COMPACTED = b"5"
"""The format of a journal that begins with a snapshot, which older versions take for a damaged one."""
_PAGE = 256
_STORED: dict[Kind, str] = {
    "tbox": "SELECT seq, '', value, digest FROM tboxes WHERE seq > ? AND seq <= ? ORDER BY seq LIMIT 1",
    "beginning": "SELECT seq, '', head, digest FROM beginning WHERE seq > ? AND seq <= ?",
    "snapshot": "SELECT seq, '', body, digest FROM beginning WHERE seq > ? AND seq <= ?",
    "commit": "SELECT * FROM commits WHERE seq > ? AND seq <= ? ORDER BY seq LIMIT 1",
    "checkpoint": "SELECT seq, '', body, digest FROM checkpoints WHERE seq > ? AND seq <= ?"
    " ORDER BY seq DESC LIMIT 1",
}
_DROPPED = 2000
"""Rows: to delete them takes some tens of milliseconds."""
_DENSE_FROM = 1 << 16
"""Bytes: what is larger takes less time to compress than to write."""


class Damaged(errors.Refused):
    """A commit is not as it was written. `last_good` is the number of the one before."""

    def __init__(self, path: Path, seq: int) -> None:
        super().__init__(f"{path}: commit {seq} is damaged; the last good one is {seq - 1}; {mend(path)}")
        self.last_good = seq - 1


class Row(NamedTuple):
    """A commit as it stands in the file."""

    seq: int
    id: str
    body: bytes
    digest: bytes


class Journal:
    """An open journal. One process at a time: a second one is refused. Any thread may read."""

    def __init__(self, path: Path, *, to_salvage: bool = False) -> None:
        """Open the journal at `path`. Raises InUse, Refused when it is damaged or of another version.

        One `to_salvage` may be damaged where its history begins.
        """
        self.path = path
        self._file = JournalFile(path)
        self._digest: bytes | None = None  # that of the last commit, once it is known
        self._stamps = array("q")
        self._reading_stamps = threading.Lock()
        try:
            self.beginning = self._read_beginning(to_salvage=to_salvage)
        except errors.Refused:
            self._file.close()
            raise

    def _read_beginning(self, *, to_salvage: bool) -> Beginning:
        with self._file.reading() as db:
            found = beginning.read(db)
            if found is None and to_salvage:
                (first,) = db.execute("SELECT min(seq) FROM commits").fetchone()
                found = Beginning(seq=(first or 1) - 1)
        if found is None:
            raise self._damaged("where its history begins is damaged")
        self.beginning = found
        if not to_salvage:
            self.require_format()
        return found

    def require_format(self) -> None:
        """Raises Refused unless it is of this version."""
        with self._file.reading() as db:
            form = db.execute("SELECT value FROM meta WHERE key='format'").fetchone()
        if form is None or form[0] not in (FORMAT, COMPACTED):
            raise errors.Refused(f"{self.path} was written by another version of semmap; {ANEW}")
        if (form[0] == COMPACTED) != (self.beginning.seq > 0):
            raise self._damaged("where its history begins is damaged")

    def drop_compacted(self) -> None:
        """Delete what the snapshot has taken the place of, bit by bit, so that commits can come between.

        What an end in the middle leaves is not looked at any more, and deleted by the next call. Raises
        NotWritten.
        """
        until = self.beginning.seq
        while self._dropped(
            "DELETE FROM commits WHERE seq <= ? AND seq < (SELECT min(seq) FROM commits) + ?"
        ):
            pass
        name: str | None = ""
        while name is not None:
            with self._file.writing("the deletion of compacted commits") as db:
                query = "SELECT name FROM touches WHERE name > ? ORDER BY name LIMIT 1 OFFSET ?"
                upto = (db.execute(query, (name, _DROPPED)).fetchone() or (None,))[0]
                within = (
                    "name > ? AND (? IS NULL OR name <= ?)"
                    if name
                    else "name >= ? AND (? IS NULL OR name <= ?)"
                )
                db.execute(f"DELETE FROM touches WHERE seq <= ? AND {within}", (until, name, upto, upto))
                name = upto
        self._file.shrink()

    def _dropped(self, statement: str) -> int:
        with self._file.writing("the deletion of compacted commits") as db:
            return db.execute(statement, (self.beginning.seq, _DROPPED)).rowcount

    @property
    def has_dregs(self) -> bool:
        """Is something still there that was compacted?"""
        with self._file.reading() as db:
            (first,) = db.execute("SELECT min(seq) FROM commits").fetchone()
        return first is not None and first < self.first

    def begin_with(self, first: Beginning, snapshot: Checkpoint) -> None:
        """Let the history begin after a commit, with the map as it was then; what came before goes.

        Of `first`, the digest of the snapshot is added. Raises NotWritten.
        """
        body = checkpoint_encoding.encode(snapshot)
        first = structs.replace(first, body_digest=beginning.digest(body), entities=len(snapshot.entities))
        with self._file.writing(f"the snapshot after commit {first.seq}") as db:
            beginning.write(db, first, body)
            db.execute("INSERT OR REPLACE INTO meta VALUES ('format', ?)", (COMPACTED,))
            db.execute("DELETE FROM checkpoints WHERE seq < ?", (first.seq,))
            holding = "(SELECT max(seq) FROM tboxes WHERE seq <= ?)"
            db.execute(f"DELETE FROM tboxes WHERE seq < {holding}", (first.seq,))
            index_check.write(db, first.seq, max(self.last, first.seq))
            with self._reading_stamps:
                self.beginning, self._stamps = first, array("q")

    @classmethod
    def create(cls, path: Path, tbox: bytes) -> Journal:
        """A new journal for the given TBox (N-Triples). Raises Refused when the disk does not take it."""
        try:
            db = sqlite3.connect(path)
            try:
                db.executescript(SCHEMA)
                with db:
                    db.execute("INSERT INTO meta VALUES ('format', ?)", (FORMAT,))
                    db.execute("INSERT INTO tboxes VALUES (0, ?, ?)", (tbox, chained(b"", tbox)))
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
        return row[0] or self.beginning.seq

    @property
    def size_bytes(self) -> int:
        """What it takes on disk."""
        return sum(path.stat().st_size for path in self.path.parent.glob(f"{self.path.name}*"))

    @property
    def first(self) -> int:
        """The number of the first commit that is kept."""
        return self.beginning.seq + 1

    def origin(self) -> tuple[str, int]:
        """The map's identity, and when it was begun [ns since 1970]; nothing before the first commit.

        The identity is the digest of the very first commit, which a map that is begun anew does not share.
        """
        if self.beginning.seq:
            return self.beginning.map_id, self.beginning.begun_ns
        return (self.digest(1).hex(), self.stamp_of(1)) if self.last else ("", 0)

    def tbox(self, seq: int) -> bytes:
        """The TBox (N-Triples) that holds after commit `seq`. Raises Refused when it is damaged."""
        query = "SELECT value, digest FROM tboxes WHERE seq <= ? ORDER BY seq DESC LIMIT 1"
        with self._file.reading() as db:
            row = db.execute(query, (seq,)).fetchone()
        if row is None or not _is_sound(b"", *row):
            raise self._damaged("the TBox in it is damaged")
        return bytes(row[0])

    def _damaged(self, what: str) -> errors.Refused:
        return errors.Refused(f"{self.path}: {what}; {mend(self.path)}")

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
        if self._digest is None:
            self._digest = self.digest(self.last)
        commit = structs.replace(commit, digest=self._digest.hex())
        whole = None if begun is None else begun.finish(commit)
        with self._file.writing(f"commit {commit.seq}") as db:
            touches = [(name, commit.seq) for name in commit.names]
            if len(touches) == 1:
                db.execute(_TOUCH, touches[0])
            else:
                db.executemany(_TOUCH, touches)
            body = dense.encode(commit, dense_from=_DENSE_FROM) if whole is None else whole.result()
            digest = chained(self._digest, body)
            db.execute("INSERT INTO commits VALUES (?, ?, ?, ?)", (commit.seq, commit.id, body, digest))
            if tbox is not None:
                row = (commit.seq, tbox, chained(b"", tbox))
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

    def commits(self, after: int | None = None) -> Iterator[Commit]:
        """The commits later than `after`, in order. Raises Damaged at the first damaged one."""
        return (_signed(row.body, row.digest) for row in self.rows(after))

    def outlines(self, kind: type[T]) -> Iterator[T]:
        """All commits in order, of each what `kind` has fields for. Raises Damaged at the first damaged."""
        return (dense.decode(row.body, kind) for row in self.rows())

    def verify(self, progress: Callable[[], None] = lambda: None) -> None:
        """Read everything that counts. Raises Damaged at the first damaged commit, Refused for the rest."""
        since, expected = self._indexed_until(), index_check.Expected()
        for row in self.rows():
            if row.seq > since:
                commit = _signed(row.body, row.digest)
                if commit.seq != row.seq:
                    raise Damaged(self.path, row.seq)
                expected.take(commit)
            progress()
        with self._file.reading() as db:
            rows = db.execute("SELECT seq FROM tboxes").fetchall()
            if not index_check.is_well_formed(db):
                raise self._damaged("its structure is damaged")
            if not expected.is_said(db, since):
                raise self._damaged("an index in it is damaged")
            if self.beginning.seq and beginning.body_of(db, self.beginning) is None:
                raise self._damaged("the snapshot that its history begins with is damaged")
        for (seq,) in rows:
            self.tbox(seq)

    def _indexed_until(self) -> int:
        """The commit up to which the indexes are as they were recorded. Raises Refused if they are not."""
        with self._file.reading() as db:
            try:
                record = index_check.read(db)
            except (MsgspecError, TypeError):
                raise self._damaged("the record of its indexes is damaged") from None
            if record is None or record.seq < self.beginning.seq:
                return self.beginning.seq
            if not index_check.is_as_recorded(db, self.beginning.seq, record):
                raise self._damaged("an index in it is damaged")
            return record.seq

    def commit(self, seq: int) -> Commit:
        """The commit with that number, which must be there. Raises Damaged."""
        for row in self.rows(seq - 1, size=1):
            return _signed(row.body, row.digest)
        raise Damaged(self.path, seq)

    def commit_of(self, command_id: str) -> Commit | None:
        """The commit that a command made, if it made one."""
        with self._file.reading() as db:
            row = db.execute("SELECT seq FROM commits WHERE command_id = ?", (command_id,)).fetchone()
        return None if row is None or row[0] < self.first else self.commit(row[0])

    def touching(self, name: str, after: int = 0, until: int | None = None) -> list[int]:
        """The numbers of the commits that touched an entity, in order."""
        query = "SELECT seq FROM touches WHERE name = ? AND seq > ? AND seq <= ? ORDER BY seq"
        with self._file.reading() as db:
            after = max(after, self.beginning.seq)
            rows = db.execute(query, (name, after, self.last if until is None else until))
            return [seq for (seq,) in rows]

    def digest(self, seq: int) -> bytes:
        """That of all commits up to one; empty before the first."""
        if seq == (begins := self.beginning).seq:
            return begins.chain
        with self._file.reading() as db:
            row = db.execute("SELECT digest FROM commits WHERE seq = ?", (seq,)).fetchone()
        return b"" if row is None else bytes(row[0])

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
            return [seq for seq, body in db.execute(query, (after,)) if dense.decode(body, _Undoing).undoes]

    def last_touches(self, until: int) -> list[tuple[str, int]]:
        """Each entity's name with the last commit up to `until` that touched it."""
        query = "SELECT name, max(seq) FROM touches WHERE seq > ? AND seq <= ? GROUP BY name"
        with self._file.reading() as db:
            return db.execute(query, (self.beginning.seq, until)).fetchall()

    def seq_at(self, stamp_ns: int) -> int:
        """The last commit that is stamped up to a time; one less than the first that is known before that.

        Where the clock was set back meanwhile a time comes twice, and the second counts. The last commit of
        the snapshot that the history begins with is known by its stamp, too.
        """
        with self._reading_stamps:
            stamps = self._stamps_so_far()
            known = array("q", [self.beginning.stamp_ns]) + stamps if self.beginning.seq else stamps
            earliest_since = list(accumulate(reversed(known), min))[::-1]
        return self.last - len(known) + bisect_right(earliest_since, stamp_ns)

    def stamped(self, first_ns: int, last_ns: int) -> list[int]:
        """The commits that are stamped within these times, both included, in order."""
        with self._reading_stamps:
            stamps = enumerate(self._stamps_so_far(), start=self.first)
            return [seq for seq, stamp_ns in stamps if first_ns <= stamp_ns <= last_ns]

    def latest_stamp(self) -> int:
        """The latest time that any commit is stamped with [ns since 1970]."""
        with self._reading_stamps:
            return max(self._stamps_so_far(), default=self.beginning.stamp_ns)

    def _stamps_so_far(self) -> array[int]:
        """Those of all commits: read once, as far as they are not known yet."""
        stamps = self._stamps
        while rows := self._page(self.beginning.seq + len(stamps), _PAGE):
            stamps.extend(dense.decode(row.body, _Stamp).stamp_ns for row in rows)
        return stamps

    def stamp_of(self, seq: int) -> int:
        """When a commit was made [ns since 1970]."""
        with self._file.reading() as db:
            row = db.execute("SELECT body FROM commits WHERE seq = ?", (seq,)).fetchone()
        if row is None:
            raise Damaged(self.path, seq)
        stamp: _Stamp = dense.decode(row[0], _Stamp)
        return stamp.stamp_ns

    def checkpoint(self, checkpoint: Checkpoint, progress: Callable[[], None] = lambda: None) -> None:
        """Keep `checkpoint` as the place to start from, and of the older ones the last.

        Raises Refused, with nothing changed, when the disk does not take it.
        """
        body = checkpoint_encoding.encode(checkpoint, progress)
        row = (checkpoint.seq, body, chained(b"", body))
        with self._file.writing(f"the checkpoint after commit {checkpoint.seq}") as db:
            db.execute("INSERT OR REPLACE INTO checkpoints VALUES (?, ?, ?)", row)
            db.execute(
                "DELETE FROM checkpoints"
                " WHERE seq NOT IN (SELECT seq FROM checkpoints ORDER BY seq DESC LIMIT 2)"
            )
            index_check.write(db, self.beginning.seq, checkpoint.seq)

    def last_checkpoint(self, progress: Callable[[], None] = lambda: None) -> Checkpoint:
        """The newest sound checkpoint; without any, the empty map before commit 1."""
        return self.sound_checkpoint(progress) or self.snapshot(progress)

    def sound_checkpoint(self, progress: Callable[[], None] = lambda: None) -> Checkpoint | None:
        """The newest sound checkpoint, if there is one."""
        with self._file.reading() as db:
            for seq, body, digest in db.execute("SELECT * FROM checkpoints ORDER BY seq DESC"):
                if _is_sound(b"", body, digest):
                    found = checkpoint_encoding.decode(body, progress)
                    if found.seq == seq >= self.beginning.seq:
                        return found
                log.warning("%s: the checkpoint after commit %d is damaged and not used", self.path, seq)
        return None

    def snapshot(self, progress: Callable[[], None] = lambda: None) -> Checkpoint:
        """What the history begins with: the empty map, unless it was compacted."""
        if not self.beginning.seq:
            return Checkpoint(seq=0)
        with self._file.reading() as db:
            body = beginning.body_of(db, self.beginning)
        if body is None:
            raise self._damaged("the snapshot that its history begins with is damaged")
        return checkpoint_encoding.decode(body, progress)

    def rows(self, after: int | None = None, size: int = _PAGE) -> Iterator[Row]:
        """The commits later than `after` as they stand in the file. Raises Damaged at the first damaged."""
        seq = self.beginning.seq if after is None else after
        before = self.digest(seq)
        while rows := self._page(seq, size):
            for row in rows:
                seq += 1
                if row.seq != seq or not _is_sound(before, row.body, row.digest):
                    raise Damaged(self.path, seq)
                before = row.digest
                yield row

    def stored(self, kind: Kind, *, after: int, until: int) -> Iterator[Row]:
        """What a backup has of one kind, with numbers later than `after` and up to `until`, in order."""
        after = max(after, self.beginning.seq) if kind == "commit" else after
        while True:
            with self._file.reading() as db:
                if kind in ("beginning", "snapshot") and not beginning.is_there(db):
                    return
                found = db.execute(_STORED[kind], (after, until)).fetchone()
            if found is None:
                return
            row = Row._make(found)
            yield row._replace(digest=beginning.digest(row.body)) if kind == "snapshot" else row
            after = row.seq

    def row(self, seq: int) -> Row | None:
        """A commit as it stands in the file, sound or not; None where it cannot be read."""
        query = "SELECT seq, command_id, body, digest FROM commits WHERE seq = ?"
        try:
            with self._file.reading() as db:
                found = db.execute(query, (seq,)).fetchone()
        except errors.Refused:
            return None
        is_one = found is not None and isinstance(found[2], bytes) and isinstance(found[3], bytes)
        return Row._make(found) if is_one else None

    def likely_last(self) -> int:
        """The number of the last commit that anything in the file tells of, damaged or not."""
        found = [self.beginning.seq]
        for table in ("commits", "touches", "checkpoints", "tboxes"):
            with suppress(errors.Refused), self._file.reading() as db:
                (seq,) = db.execute(f"SELECT max(seq) FROM {table}").fetchone()
                found.append(seq if isinstance(seq, int) else 0)
        while self.row(max(found) + 1) is not None:
            found.append(max(found) + 1)
        return max(found)

    def _page(self, after: int, size: int) -> list[Row]:
        """The next rows; where they cannot be read together, one at a time, so that the bad one is known."""
        query = "SELECT seq, command_id, body, digest FROM commits WHERE seq > ? ORDER BY seq LIMIT ?"
        try:
            with self._file.reading() as db:
                return list(map(Row._make, db.execute(query, (after, size))))
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
    commit: Commit = dense.decode(body, Commit)
    return structs.replace(commit, digest=digest.hex())


def _is_sound(before: bytes, body: object, digest: object) -> bool:
    """Is it what was written? Of a damaged page SQLite may read anything, numbers and NULL too."""
    return isinstance(body, bytes) and chained(before, body) == digest


def chained(before: bytes, body: bytes) -> bytes:
    """The digest of a commit that comes after those with the digest `before`."""
    digest = hashlib.blake2b(before, digest_size=16)
    digest.update(body)
    return digest.digest()
