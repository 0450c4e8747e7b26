"""The journal: every commit in an append-only SQLite file, with checkpoints for a fast start.

A commit is durable when `append` returns. Everything in the file has a digest, and those of commits form a
chain, so that damage is detected and attributed to a commit. The indexes, which could be rebuilt, are
compared with the commits. A compacted journal starts with a snapshot.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Collection, Iterator
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
from semmap.schemas.entities import Probability, Provenance, Source

T = TypeVar("T")

_TOUCH = "INSERT INTO touches VALUES (?, ?)"
_COMPRESSED_FROM = 1 << 16
"""Larger bodies [bytes] take less time to compress than to write."""


class Journal:
    """An open journal. Only one process may open it, and any of its threads may read."""

    def __init__(self, path: Path, *, to_salvage: bool = False) -> None:
        """Open the journal at `path`. Raises InUse, Refused if it is damaged or of another version.

        With `to_salvage`, the start of its history may be damaged.
        """
        self.path = path
        self.file = JournalFile(path, last_commit="SELECT max(seq) FROM commits")
        """For the other modules of `storage/`."""
        self._digest: bytes | None = None  # that of the last commit, once known
        self._is_in_batch = False
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
            raise self.damage_error("the start of its history is damaged")
        self.beginning = found
        if not to_salvage:
            self.require_format()
        return found

    def require_format(self) -> None:
        """Raise Refused unless it has the format of this version."""
        with self.file.reading() as db:
            form = db.execute("SELECT value FROM meta WHERE key='format'").fetchone()
        if form is None or form[0] not in (FORMAT, COMPACTED):
            raise errors.Refused(f"{self.path} was written by another version of semmap; {NEW_MAP_HINT}")
        if (form[0] == COMPACTED) != (self.beginning.seq > 0):
            raise self.damage_error("the start of its history is damaged")

    def start_from(self, first: Beginning, snapshot: Checkpoint) -> None:
        """Start the history after a commit, with the map at that commit, and drop what came before.

        The digest of the snapshot is added to `first`. Raises NotWritten.
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
        """Create a journal for a TBox (N-Triples). Raises Refused if the disk rejects it."""
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
        """Close the file."""
        self.file.close()

    @property
    def last(self) -> int:
        """Return the number of the last commit, 0 before the first."""
        with self.file.reading() as db:
            row: tuple[int | None] = db.execute("SELECT max(seq) FROM commits").fetchone()
        return row[0] or self.beginning.seq

    @property
    def size_bytes(self) -> int:
        """Return the size on disk."""
        return sum(path.stat().st_size for path in self.path.parent.glob(f"{self.path.name}*"))

    @property
    def first(self) -> int:
        """Return the number of the first stored commit."""
        return self.beginning.seq + 1

    def origin(self) -> tuple[str, int]:
        """Return the map's identity and creation time [ns since 1970], or ("", 0) before the first commit.

        The identity is the digest of the very first commit, which differs after the map is created again.
        """
        if self.beginning.seq:
            return self.beginning.map_id, self.beginning.begun_ns
        return (self.digest(1).hex(), self.stamps.of(1)) if self.last else ("", 0)

    def tbox(self, seq: int) -> bytes:
        """Return the TBox (N-Triples) after commit `seq`. Raises Refused if it is damaged."""
        query = "SELECT value, digest FROM tboxes WHERE seq <= ? ORDER BY seq DESC LIMIT 1"
        with self.file.reading() as db:
            row = db.execute(query, (seq,)).fetchone()
        if row is None or not is_intact(b"", *row):
            raise self.damage_error("its TBox is damaged")
        return bytes(row[0])

    def damage_error(self, what: str) -> errors.Refused:
        """Return the error for damage, with the next step."""
        return errors.Refused(f"{self.path}: {what}; {repair_hint(self.path)}")

    def tbox_changes(self, after: int) -> list[int]:
        """Return the commits after `after` that replaced the TBox, newest first."""
        with self.file.reading() as db:
            found = db.execute("SELECT seq FROM tboxes WHERE seq > ? ORDER BY seq DESC", (after,))
            return [seq for (seq,) in found]

    def append(
        self, commit: Commit, tbox: bytes | None = None, *, begun: commit_encoding.EarlyBody | None = None
    ) -> bytes:
        """Make `commit` durable, with a new TBox (N-Triples) if it is replaced.

        `begun` is its body, if encoding has begun. Returns the digest of all commits up to this one. Raises
        NotWritten if the disk rejects it.
        """
        if self._digest is None:
            last = self.last
            self._digest = self.digest(last)
            self.file.acknowledged.note(last)  # a kill may interrupt this commit already
        commit = structs.replace(commit, digest=self._digest.hex())
        whole = None if begun is None else begun.finish(commit)
        with self.file.writing(f"commit {commit.seq}") as db:
            touches = [(name, commit.seq) for name in commit.names]
            if len(touches) == 1:
                db.execute(_TOUCH, touches[0])
            else:
                db.executemany(_TOUCH, touches)
            body = (
                body_encoding.encode(commit, compressed_from=_COMPRESSED_FROM)
                if whole is None
                else whole.result()
            )
            digest = chain_digest(self._digest, body)
            db.execute("INSERT INTO commits VALUES (?, ?, ?, ?)", (commit.seq, commit.id, body, digest))
            if tbox is not None:
                row = (commit.seq, tbox, chain_digest(b"", tbox))
                db.execute("INSERT INTO tboxes VALUES (?, ?, ?)", row)
        self._digest = digest
        if not self._is_in_batch:
            self.file.acknowledged.note(commit.seq)
        return digest

    @contextmanager
    def batch(self) -> Iterator[None]:
        """Make all commits appended in this context durable at its end, with one wait for the disk.

        Raises NotWritten, with none of them written, if the disk rejects them.
        """
        digest = self._digest
        self._is_in_batch = True
        try:
            with self.file.writing("several commits"):
                yield
        except BaseException:
            self._digest = digest
            raise
        finally:
            self._is_in_batch = False
        self.file.acknowledged.note(self.last)

    def commits(self, after: int | None = None) -> Iterator[Commit]:
        """Return the commits after `after`, in order. Raises Damaged at the first damaged one."""
        return (decode_row(row) for row in self.rows(after))

    def decode_partially(self, kind: type[T]) -> Iterator[T]:
        """Return the fields of `kind` of all commits, in order. Raises Damaged at the first damaged one."""
        return (body_encoding.decode(row.body, kind) for row in self.rows())

    def find_contained(self, patterns: Collection[bytes], until: int) -> Iterator[tuple[int, set[bytes]]]:
        """Yield the commits up to `until` that contain some of the patterns, with these, newest first.

        The patterns are parts of the MessagePack of a commit, which is searched without decoding it.
        """
        for seq, body in rows.read_newest_first(self.file, until=until):
            if found := body_encoding.find_contained(body, patterns):
                yield seq, found

    def commit(self, seq: int) -> Commit:
        """Return an existing commit. Raises Damaged."""
        for row in self.rows(seq - 1, size=1):
            return decode_row(row)
        raise Damaged(self.path, seq)

    def commit_provenance(self, seq: int) -> Provenance:
        """Return the provenance of an existing commit, without decoding its triples. Raises Damaged."""
        for row in self.rows(seq - 1, size=1):
            found: _Attribution = body_encoding.decode(row.body, _Attribution)
            return Provenance(commit=seq, **structs.asdict(found))
        raise Damaged(self.path, seq)

    def commit_of(self, command_id: str) -> Commit | None:
        """Return the commit of a command, or None."""
        with self.file.reading() as db:
            row = db.execute("SELECT seq FROM commits WHERE command_id = ?", (command_id,)).fetchone()
        return None if row is None or row[0] < self.first else self.commit(row[0])

    def touching(self, name: str, after: int = 0, until: int | None = None) -> list[int]:
        """Return the numbers of the commits that touched an entity, in order."""
        query = "SELECT seq FROM touches WHERE name = ? AND seq > ? AND seq <= ? ORDER BY seq"
        with self.file.reading() as db:
            after = max(after, self.beginning.seq)
            found = db.execute(query, (name, after, self.last if until is None else until))
            return [seq for (seq,) in found]

    def digest(self, seq: int) -> bytes:
        """Return the digest of all commits up to one, empty before the first."""
        if seq == (begins := self.beginning).seq:
            return begins.chain
        with self.file.reading() as db:
            row = db.execute("SELECT digest FROM commits WHERE seq = ?", (seq,)).fetchone()
        return b"" if row is None else bytes(row[0])

    def size_after(self, after: int) -> tuple[int, int]:
        """Return the number of commits after `after`, and their size [bytes]."""
        query = "SELECT count(*), coalesce(sum(length(body)), 0) FROM commits WHERE seq > ?"
        with self.file.reading() as db:
            count, size = db.execute(query, (after,)).fetchone()
        return count, size

    def list_undo_commits(self, after: int) -> list[int]:
        """Return the commits after `after` that undid others, newest first. Reads all of them."""
        query = "SELECT seq, body FROM commits WHERE seq > ? ORDER BY seq DESC"
        with self.file.reading() as db:
            return [
                seq
                for seq, body in db.execute(query, (after,))
                if body_encoding.decode(body, _Undoing).undoes
            ]

    def last_touches(self, until: int) -> list[tuple[str, int]]:
        """Return each entity name with the last commit up to `until` that touched it."""
        query = "SELECT name, max(seq) FROM touches WHERE seq > ? AND seq <= ? GROUP BY name"
        with self.file.reading() as db:
            return db.execute(query, (self.beginning.seq, until)).fetchall()

    def checkpoint(self, checkpoint: Checkpoint, progress: Callable[[], None] = lambda: None) -> None:
        """Store `checkpoint` to start from, and keep the last older one.

        Raises Refused, with nothing changed, if the disk rejects it.
        """
        checkpoints.save(self.file, checkpoint, begins=self.beginning.seq, progress=progress)

    def last_checkpoint(self, progress: Callable[[], None] = lambda: None) -> Checkpoint:
        """Return the newest intact checkpoint, or the snapshot at the start of the history."""
        return self.newest_checkpoint(progress) or self.snapshot(progress)

    def newest_checkpoint(self, progress: Callable[[], None] = lambda: None) -> Checkpoint | None:
        """Return the newest intact checkpoint, or None."""
        return checkpoints.load_newest(self.file, begins=self.beginning.seq, progress=progress)

    def snapshot(self, progress: Callable[[], None] = lambda: None) -> Checkpoint:
        """Return the start of the history: the empty map, unless it was compacted."""
        if not self.beginning.seq:
            return Checkpoint(seq=0)
        with self.file.reading() as db:
            body = beginning.body_of(db, self.beginning)
        if body is None:
            raise self.damage_error("the snapshot at the start of its history is damaged")
        return checkpoint_encoding.decode(body, progress)

    def rows(self, after: int | None = None, size: int = rows.PAGE) -> Iterator[Row]:
        """Yield the stored commits after `after`. Raises Damaged at the first damaged one."""
        seq = self.beginning.seq if after is None else after
        return rows.read_intact_rows(self.file, after=seq, before=self.digest(seq), size=size)


class _Attribution(Struct):
    """The part of a commit with its author."""

    stamp_ns: int
    source: Source
    agent: str = ""
    reason: str = ""
    confidence: Probability | None = None


class _Undoing(Struct):
    """The part of a commit with the commits that it undid."""

    undoes: tuple[int, ...] = ()


def decode_row(row: Row) -> Commit:
    """Return the commit of a row, with the digest from the journal."""
    commit: Commit = body_encoding.decode(row.body, Commit)
    return structs.replace(commit, digest=row.digest.hex())
