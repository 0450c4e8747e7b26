"""The journal's SQLite file: transactions that are durable at their end, for one process at a time."""

from __future__ import annotations

import os
import shlex
import sqlite3
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

from semmap.nodes.kb_node.storage.journal import write_ahead
from semmap.schemas import errors

_PAGE_BYTES: Final = 4096
_LOG_BYTES: Final = 1025 * _PAGE_BYTES
"""SQLite begins its write-ahead log anew after 1000 pages, and what the last commit wrote."""
NEW_MAP_HINT = "start a new map with --fresh (this one is kept)"


class InUse(errors.Refused):
    """Another process has the journal open."""


class NotWritten(errors.Refused):
    """The disk did not take it; nothing was written."""


class JournalFile:
    """An open file. Any thread has its connection while it is `reading` or `writing`, one at a time."""

    def __init__(self, path: Path) -> None:
        """Open the file at `path`: WAL with `synchronous=FULL`. Raises InUse, Refused when it is damaged."""
        if write_ahead.has_damaged_copy(path):
            raise _log_damage_error(path)
        log = write_ahead.inspect_log(path)
        try:
            try:
                self._open(path)
            except InUse:
                raise
            except errors.Refused:
                if log is None or log.has_valid_header:
                    raise
                log.save_copy()
                raise _log_damage_error(path) from None
            if log is not None and log.has_lost_commits(self._count_valid_frames()):
                log.save_copy()
                self._db.close()
                raise _log_damage_error(path)
        finally:
            if log is not None:
                log.file.close()

    def _count_valid_frames(self) -> int:
        """How many frames of the log SQLite has found to be sound."""
        with self.reading() as db:
            _, frames, _ = db.execute("PRAGMA wal_checkpoint(PASSIVE)").fetchone()
        return int(frames)

    def _open(self, path: Path) -> None:
        self.path = path
        self._lock = threading.RLock()
        try:
            self._db = sqlite3.connect(path, isolation_level=None, timeout=2.0, check_same_thread=False)
        except sqlite3.DatabaseError as error:
            raise _to_refused(path, error) from None
        try:
            with self.reading() as db:
                db.execute("PRAGMA locking_mode=EXCLUSIVE")
                db.execute("PRAGMA journal_mode=WAL")
                db.execute("PRAGMA synchronous=FULL")
                db.execute("SELECT 1 FROM sqlite_master").fetchone()  # now the log is read
                db.execute("BEGIN IMMEDIATE")  # so that the log is there
                db.execute("ROLLBACK")
            _preallocate(path.with_name(f"{path.name}-wal"))
        except errors.Refused:
            self._db.close()
            raise

    def close(self) -> None:
        """Release it."""
        with self._lock:
            self._db.close()

    @contextmanager
    def reading(self) -> Iterator[sqlite3.Connection]:
        """The connection, to read. Raises InUse, Refused when the file is damaged."""
        try:
            with self._lock:
                yield self._db
        except sqlite3.ProgrammingError:
            raise
        except UnicodeDecodeError:  # of a text that is not one any more
            raise _to_refused(self.path, sqlite3.DatabaseError("a text is not UTF-8")) from None
        except sqlite3.DatabaseError as error:
            raise _to_refused(self.path, error) from None

    @contextmanager
    def writing(self, what: str) -> Iterator[sqlite3.Connection]:
        """The connection in a transaction: all of it or nothing, and durable at its end.

        Within another it is a part of that. Raises NotWritten when the disk does not take `what`.
        """
        db = self._db
        try:
            with self._lock:
                if db.in_transaction:
                    yield db
                    return
                db.execute("BEGIN IMMEDIATE")
                try:
                    yield db
                    db.execute("COMMIT")
                finally:
                    if db.in_transaction:
                        db.execute("ROLLBACK")
        except sqlite3.Error as error:
            raise NotWritten(f"{what} could not be written to {self.path}: {error}") from None

    def shrink(self) -> None:
        """Give the room of what was deleted back to the disk. Raises NotWritten; then it is used again."""
        try:
            with self._lock:
                self._db.execute("VACUUM")
                self._db.execute("PRAGMA wal_checkpoint(TRUNCATE)")
        except sqlite3.Error as error:
            raise NotWritten(f"{self.path} could not be made smaller: {error}") from None


def _preallocate(log: Path) -> None:
    """Let the write-ahead log be as long from the beginning as it will be once it is written anew.

    A commit that makes the file longer waits for the file system's own journal, too: on a busy disk three
    times as long. SQLite reads no further than the last frame that it wrote. Where there is no room, the log
    grows as it is written.
    """
    with suppress(OSError), log.open("r+b", buffering=0) as file:
        page = bytes(_PAGE_BYTES)  # at once it would be cached in large pieces, each written back as a whole
        for _ in range(file.seek(0, os.SEEK_END), _LOG_BYTES, _PAGE_BYTES):
            file.write(page)
        os.fsync(file.fileno())


def _log_damage_error(path: Path) -> errors.Refused:
    return errors.Refused(f"{path}: the log with its last commits is damaged; {repair_hint(path)}")


def _to_refused(path: Path, error: sqlite3.DatabaseError) -> errors.Refused:
    if not isinstance(error, sqlite3.OperationalError):
        return errors.Refused(f"{path} is damaged: {error}; {repair_hint(path)}")
    if "locked" in str(error):
        stop = f"semmap down --data {path.parent}"
        return InUse(f"another knowledge base is using {path}; stop it with: {stop}")
    return errors.Refused(f"{path} cannot be read: {error}; {NEW_MAP_HINT}")


def repair_hint(path: Path) -> str:
    """How one goes on after damage."""
    repair = f"semmap repair --data {shlex.quote(str(path.parent))}"
    return f"continue with what is good: {repair} (the damaged file is kept)"
