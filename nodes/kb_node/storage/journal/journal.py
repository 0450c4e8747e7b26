"""The truth on disk: every commit in an append-only SQLite file, with checkpoints to start from.

A commit is durable when `append` returns. Everything in the file has a digest, that of a commit chained to
the one before it, so that damage is noticed and the damaged commit named. What could be made anew from the
commits, the indexes, is compared with them. A journal that was compacted begins with a snapshot.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

from msgspec import Struct, structs

from semmap.nodes.kb_node.storage.encoding import body_encoding, checkpoint_encoding, commit_encoding
from semmap.nodes.kb_node.storage.encoding.checkpoint_encoding import Checkpoint
from semmap.nodes.kb_node.storage.journal import beginning, checkpoints, index_check, rows
from semmap.nodes.kb_node.storage.journal.beginning import Beginning
from semmap.nodes.kb_node.storage.journal.digests import chain_digest, is_intact
from semmap.nodes.kb_node.storage.journal.layout import COMPACTED, FORMAT, SCHEMA
from semmap.nodes.kb_node.storage.journal.rows import Damaged, Row
from semmap.nodes.kb_node.storage.journal.sqlite_file import NEW_MAP_HINT, JournalFile, repair_hint
from semmap.nodes.kb_node.storage.journal.stamps import Stamps
from semmap.schemas import errors
from semmap.schemas.commits import Commit

T = TypeVar("T")

_TOUCH = "INSERT INTO touches VALUES (?, ?)"
_DENSE_FROM = 1 << 16
"""Bytes: what is larger takes less time to compress than to write."""


class Journal:
    """An open journal. One process at a time: a second one is refused. Any thread may read."""

    def __init__(self, path: Path, *, to_salvage: bool = False) -> None:
        """Open the journal at `path`. Raises InUse, Refused when it is damaged or of another version.

        One `to_salvage` may be damaged where its history begins.
        """
        self.path = path
        self.file = JournalFile(path)
        """For the other modules of `storage/`."""
        self._digest: bytes | None = None  # that of the last commit, once it is known
        try:
            self.beginning = self._read_beginning(to_salvage=to_salvage)
        except errors.Refused:
            self.file.close()
            raise
        self.stamps = Stamps(self.file, self.beginning)

    def _read_beginning(self, *, to_salvage: bool) -> Beginning:
        with self.file.reading() as db:
            found = beginning.read(db)
            if found is None and to_salvage:
                (first,) = db.execute("SELECT min(seq) FROM commits").fetchone()
                found = Beginning(seq=(first or 1) - 1)
        if found is None:
            raise self.damage_error("where its history begins is damaged")
        self.beginning = found
        if not to_salvage:
            self.require_format()
        return found

    def require_format(self) -> None:
        """Raises Refused unless it is of this version."""
        with self.file.reading() as db:
            form = db.execute("SELECT value FROM meta WHERE key='format'").fetchone()
        if form is None or form[0] not in (FORMAT, COMPACTED):
            raise errors.Refused(f"{self.path} was written by another version of semmap; {NEW_MAP_HINT}")
        if (form[0] == COMPACTED) != (self.beginning.seq > 0):
            raise self.damage_error("where its history begins is damaged")

    def start_from(self, first: Beginning, snapshot: Checkpoint) -> None:
        """Let the history begin after a commit, with the map as it was then; what came before goes.

        Of `first`, the digest of the snapshot is added. Raises NotWritten.
        """
        body = checkpoint_encoding.encode(snapshot)
        first = structs.replace(first, body_digest=beginning.digest(body), entities=len(snapshot.entities))
        with self.file.writing(f"the snapshot after commit {first.seq}") as db:
            beginning.write(db, first, body)
            db.execute("INSERT OR REPLACE INTO meta VALUES ('format', ?)", (COMPACTED,))
            db.execute("DELETE FROM checkpoints WHERE seq < ?", (first.seq,))
            holding = "(SELECT max(seq) FROM tboxes WHERE seq <= ?)"
            db.execute(f"DELETE FROM tboxes WHERE seq < {holding}", (first.seq,))
            index_check.write(db, first.seq, max(self.last, first.seq))
        self.beginning = first
        self.stamps.reset(first)

    @classmethod
    def create(cls, path: Path, tbox: bytes) -> Journal:
        """A new journal for the given TBox (N-Triples). Raises Refused when the disk does not take it."""
        try:
            db = sqlite3.connect(path)
            try:
                db.executescript(SCHEMA)
                with db:
                    db.execute("INSERT INTO meta VALUES ('format', ?)", (FORMAT,))
                    db.execute("INSERT INTO tboxes VALUES (0, ?, ?)", (tbox, chain_digest(b"", tbox)))
            finally:
                db.close()
        except sqlite3.Error as error:
            raise errors.Refused(f"cannot create a journal at {path}: {error}") from None
        return cls(path)

    def close(self) -> None:
        """Release the file."""
        self.file.close()

    @property
    def last(self) -> int:
        """The number of the last commit; 0 before the first."""
        with self.file.reading() as db:
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
        return (self.digest(1).hex(), self.stamps.of(1)) if self.last else ("", 0)

    def tbox(self, seq: int) -> bytes:
        """The TBox (N-Triples) that holds after commit `seq`. Raises Refused when it is damaged."""
        query = "SELECT value, digest FROM tboxes WHERE seq <= ? ORDER BY seq DESC LIMIT 1"
        with self.file.reading() as db:
            row = db.execute(query, (seq,)).fetchone()
        if row is None or not is_intact(b"", *row):
            raise self.damage_error("the TBox in it is damaged")
        return bytes(row[0])

    def damage_error(self, what: str) -> errors.Refused:
        """The refusal that says so, and how one goes on."""
        return errors.Refused(f"{self.path}: {what}; {repair_hint(self.path)}")

    def tbox_changes(self, after: int) -> list[int]:
        """The numbers of the commits later than `after` that replaced the TBox, newest first."""
        with self.file.reading() as db:
            found = db.execute("SELECT seq FROM tboxes WHERE seq > ? ORDER BY seq DESC", (after,))
            return [seq for (seq,) in found]

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
        with self.file.writing(f"commit {commit.seq}") as db:
            touches = [(name, commit.seq) for name in commit.names]
            if len(touches) == 1:
                db.execute(_TOUCH, touches[0])
            else:
                db.executemany(_TOUCH, touches)
            body = body_encoding.encode(commit, dense_from=_DENSE_FROM) if whole is None else whole.result()
            digest = chain_digest(self._digest, body)
            db.execute("INSERT INTO commits VALUES (?, ?, ?, ?)", (commit.seq, commit.id, body, digest))
            if tbox is not None:
                row = (commit.seq, tbox, chain_digest(b"", tbox))
                db.execute("INSERT INTO tboxes VALUES (?, ?, ?)", row)
        self._digest = digest
        return digest

    @contextmanager
    def batch(self) -> Iterator[None]:
        """What is appended within becomes durable at its end, with one wait for the disk.

        Raises NotWritten, with none of it written, when the disk does not take it.
        """
        digest = self._digest
        try:
            with self.file.writing("several commits"):
                yield
        except BaseException:
            self._digest = digest
            raise

    def commits(self, after: int | None = None) -> Iterator[Commit]:
        """The commits later than `after`, in order. Raises Damaged at the first damaged one."""
        return (decode_row(row) for row in self.rows(after))

    def decode_partially(self, kind: type[T]) -> Iterator[T]:
        """All commits in order, of each what `kind` has fields for. Raises Damaged at the first damaged."""
        return (body_encoding.decode(row.body, kind) for row in self.rows())

    def commit(self, seq: int) -> Commit:
        """The commit with that number, which must be there. Raises Damaged."""
        for row in self.rows(seq - 1, size=1):
            return decode_row(row)
        raise Damaged(self.path, seq)

    def commit_of(self, command_id: str) -> Commit | None:
        """The commit that a command made, if it made one."""
        with self.file.reading() as db:
            row = db.execute("SELECT seq FROM commits WHERE command_id = ?", (command_id,)).fetchone()
        return None if row is None or row[0] < self.first else self.commit(row[0])

    def touching(self, name: str, after: int = 0, until: int | None = None) -> list[int]:
        """The numbers of the commits that touched an entity, in order."""
        query = "SELECT seq FROM touches WHERE name = ? AND seq > ? AND seq <= ? ORDER BY seq"
        with self.file.reading() as db:
            after = max(after, self.beginning.seq)
            found = db.execute(query, (name, after, self.last if until is None else until))
            return [seq for (seq,) in found]

    def digest(self, seq: int) -> bytes:
        """That of all commits up to one; empty before the first."""
        if seq == (begins := self.beginning).seq:
            return begins.chain
        with self.file.reading() as db:
            row = db.execute("SELECT digest FROM commits WHERE seq = ?", (seq,)).fetchone()
        return b"" if row is None else bytes(row[0])

    def size_after(self, after: int) -> tuple[int, int]:
        """How many commits are later than `after`, and their size [bytes]."""
        query = "SELECT count(*), coalesce(sum(length(body)), 0) FROM commits WHERE seq > ?"
        with self.file.reading() as db:
            count, size = db.execute(query, (after,)).fetchone()
        return count, size

    def list_undo_commits(self, after: int) -> list[int]:
        """The numbers of the commits later than `after` that took others back, newest first; reads all."""
        query = "SELECT seq, body FROM commits WHERE seq > ? ORDER BY seq DESC"
        with self.file.reading() as db:
            return [
                seq
                for seq, body in db.execute(query, (after,))
                if body_encoding.decode(body, _Undoing).undoes
            ]

    def last_touches(self, until: int) -> list[tuple[str, int]]:
        """Each entity's name with the last commit up to `until` that touched it."""
        query = "SELECT name, max(seq) FROM touches WHERE seq > ? AND seq <= ? GROUP BY name"
        with self.file.reading() as db:
            return db.execute(query, (self.beginning.seq, until)).fetchall()

    def checkpoint(self, checkpoint: Checkpoint, progress: Callable[[], None] = lambda: None) -> None:
        """Keep `checkpoint` as the place to start from, and of the older ones the last.

        Raises Refused, with nothing changed, when the disk does not take it.
        """
        checkpoints.save(self.file, checkpoint, begins=self.beginning.seq, progress=progress)

    def last_checkpoint(self, progress: Callable[[], None] = lambda: None) -> Checkpoint:
        """The newest sound checkpoint; without any, the empty map before commit 1."""
        return self.newest_checkpoint(progress) or self.snapshot(progress)

    def newest_checkpoint(self, progress: Callable[[], None] = lambda: None) -> Checkpoint | None:
        """The newest sound checkpoint, if there is one."""
        return checkpoints.load_newest(self.file, begins=self.beginning.seq, progress=progress)

    def snapshot(self, progress: Callable[[], None] = lambda: None) -> Checkpoint:
        """What the history begins with: the empty map, unless it was compacted."""
        if not self.beginning.seq:
            return Checkpoint(seq=0)
        with self.file.reading() as db:
            body = beginning.body_of(db, self.beginning)
        if body is None:
            raise self.damage_error("the snapshot that its history begins with is damaged")
        return checkpoint_encoding.decode(body, progress)

    def rows(self, after: int | None = None, size: int = rows.PAGE) -> Iterator[Row]:
        """The commits later than `after` as they stand in the file. Raises Damaged at the first damaged."""
        seq = self.beginning.seq if after is None else after
        return rows.read_intact_rows(self.file, after=seq, before=self.digest(seq), size=size)


class _Undoing(Struct):
    """The part of a commit that tells what it took back."""

    undoes: tuple[int, ...] = ()


def decode_row(row: Row) -> Commit:
    """The commit, with the digest that the journal gave it."""
    commit: Commit = body_encoding.decode(row.body, Commit)
    return structs.replace(commit, digest=row.digest.hex())
