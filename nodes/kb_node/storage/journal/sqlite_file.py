"""The SQLite file of a journal: durable transactions, for one process at a time."""

from __future__ import annotations

import errno
import os
import shlex
import sqlite3
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

from semmap.nodes.kb_node.storage.journal import write_ahead
from semmap.nodes.kb_node.storage.journal.acknowledged import Acknowledged
from semmap.schemas import errors

_PAGE_BYTES: Final = 4096
_LOG_BYTES: Final = 1025 * _PAGE_BYTES
"""SQLite restarts its write-ahead log after 1000 pages and what the last commit wrote."""
_ROOM_BYTES: Final = 64 * _PAGE_BYTES
_NO_ROOM: Final = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
NEW_MAP_HINT = "start a new map with --fresh (this one is kept)"


class InUse(errors.Refused):
    """Another process has the journal open."""


class NotWritten(errors.Refused):
    """The disk rejected a write, and nothing was written."""


class DiskFull(errors.Refused):
    """The file cannot be opened before there is free space on its disk. It is undamaged."""


class JournalFile:
    """An open file. Any thread may use its connection while `reading` or `writing`, one at a time."""

    def __init__(self, path: Path, *, last_commit: str = "SELECT 0") -> None:
        """Open the file at `path` in WAL mode with `synchronous=FULL`; `last_commit` is a query for it.

        Raises InUse, DiskFull, Refused if it is damaged.
        """
        if write_ahead.has_damaged_copy(path):
            raise _log_damage_error(path)
        log = write_ahead.inspect_log(path)
        try:
            try:
                self._open(path)
            except (InUse, DiskFull):
                raise
            except errors.Refused:
                if log is None or log.has_valid_header:
                    raise
                log.save_copy()
                raise _log_damage_error(path) from None
            if log is not None and log.has_lost_commits(self._count_valid_frames(), self._read(last_commit)):
                log.save_copy()
                self._db.close()
                raise _log_damage_error(path)
            self.acknowledged = Acknowledged(path)
        finally:
            if log is not None:
                log.file.close()

    def _count_valid_frames(self) -> int:
        """Return the number of log frames that SQLite accepted."""
        return self._read("PRAGMA wal_checkpoint(PASSIVE)", column=1)

    def _read(self, query: str, column: int = 0) -> int:
        """Return a number from the result of a query, 0 for NULL; close the file if it is damaged."""
        try:
            with self.reading() as db:
                return int(db.execute(query).fetchone()[column] or 0)
        except errors.Refused:
            self._db.close()
            raise

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
                db.execute("SELECT 1 FROM sqlite_master").fetchone()  # this reads the log
                db.execute("BEGIN IMMEDIATE")  # this creates the log
                db.execute("ROLLBACK")
            _preallocate(path.with_name(f"{path.name}-wal"))
        except errors.Refused:
            self._db.close()
            raise

    def close(self) -> None:
        """Close the file."""
        with self._lock:
            self._db.close()
            self.acknowledged.close()

    @contextmanager
    def reading(self) -> Iterator[sqlite3.Connection]:
        """Provide the connection for reading. Raises InUse, Refused if the file is damaged."""
        try:
            with self._lock:
                yield self._db
        except sqlite3.ProgrammingError:
            raise
        except UnicodeDecodeError:  # a damaged text
            raise _to_refused(self.path, sqlite3.DatabaseError("a text is not UTF-8")) from None
        except sqlite3.DatabaseError as error:
            raise _to_refused(self.path, error) from None

    @contextmanager
    def writing(self, what: str) -> Iterator[sqlite3.Connection]:
        """Provide the connection in a durable transaction, which is applied as a whole or not at all.

        Nested calls join the outer transaction. Raises NotWritten if the disk rejects `what`.
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
            is_full = getattr(error, "sqlite_errorcode", None) == sqlite3.SQLITE_FULL
            hint = "; free some space, then repeat it" if is_full else ""
            raise NotWritten(f"{what} could not be written to {self.path}: {error}{hint}") from None

    def shrink(self) -> None:
        """Return free space to the disk. Raises NotWritten, and then SQLite reuses the space itself."""
        try:
            with self._lock:
                self._db.execute("VACUUM")
                self._db.execute("PRAGMA wal_checkpoint(TRUNCATE)")
        except sqlite3.Error as error:
            raise NotWritten(f"{self.path} could not be made smaller: {error}") from None


def _preallocate(log: Path) -> None:
    """Extend the write-ahead log to the length at which SQLite restarts it.

    A commit that extends the file also waits for the journal of the file system, which takes three times as
    long on a busy disk. SQLite does not read beyond the last frame that it wrote. Without enough space the
    log grows as it is written.
    """
    with suppress(OSError), log.open("r+b", buffering=0) as file:
        page = bytes(
            _PAGE_BYTES
        )  # one large write would be cached in large pieces, each written back as a whole
        for _ in range(file.seek(0, os.SEEK_END), _LOG_BYTES, _PAGE_BYTES):
            file.write(page)
        os.fsync(file.fileno())


def _log_damage_error(path: Path) -> errors.Refused:
    return errors.Refused(
        f"{path}: the write-ahead log with the last commits is damaged; {repair_hint(path)}"
    )


def _to_refused(path: Path, error: sqlite3.DatabaseError) -> errors.Refused:
    if not isinstance(error, sqlite3.OperationalError):
        return errors.Refused(f"{path} is damaged: {error}; {repair_hint(path)}")
    if "locked" in str(error):
        stop = f"semmap down --data {path.parent}"
        return InUse(f"another knowledge base is using {path}; stop it with: {stop}")
    if not has_room(path.parent):
        return DiskFull(f"{path} cannot be opened: disk full; free some space, then start again")
    return errors.Refused(f"{path} cannot be read: {error}; {NEW_MAP_HINT}")


def has_room(folder: Path) -> bool:
    """Return whether there is room for a small file in a folder, by the disk, quotas and limits."""
    try:
        with tempfile.TemporaryFile(dir=folder) as file:
            os.posix_fallocate(file.fileno(), 0, _ROOM_BYTES)
    except OSError as error:
        return error.errno not in _NO_ROOM
    return True


def repair_hint(path: Path) -> str:
    """Return the next step after damage."""
    repair = f"semmap repair --data {shlex.quote(str(path.parent))}"
    return f"recover the intact commits: {repair} (the damaged file is kept)"
