"""A copy of a journal, made without opening it, because a knowledge base may be using the original.

A running knowledge base holds SQLite's lock. But its file changes in one way only: pages move into it from
the write-ahead log. The log keeps them until it restarts, and then it has another header. Therefore the
file and then the log, copied while the header of the log stays the same, are a consistent journal.
"""

from __future__ import annotations

import shutil
import time
from contextlib import closing
from pathlib import Path
from typing import Final

from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.schemas import errors

_LOG: Final = "-wal"
_HEAD_BYTES: Final = 32
_TRIES: Final = 20
_AGAIN_S: Final = 0.05


def copy(data: Path, to: Path) -> None:
    """Copy the journal of the data folder `data` to the file `to`, and verify that it opens.

    Raises BadFile if there is none or it cannot be read, Refused if it is damaged. The error names the
    original.
    """
    path = data / FILENAME
    if not path.is_file():
        raise errors.BadFile(f"there is no map in {data}")
    for tried in range(_TRIES):
        try:
            if _try_copy(path, to):
                Journal(to).close()
                return
        except OSError as error:
            raise errors.BadFile(f"the journal of {data} cannot be copied: {error.strerror}") from None
        except errors.Refused as error:
            if tried > 1:  # not just a transaction in progress
                raise name_original(error, to, path) from None
        time.sleep(_AGAIN_S)
    raise errors.Refused(f"{path} changed during every attempt to copy it; try again, or replay a backup")


def name_original(error: errors.Refused, copy: Path, path: Path) -> errors.Refused:
    """Return an error about the copy as an error about the original file."""
    return errors.Refused(
        error.text.replace(str(copy), str(path)).replace(f"--data {copy.parent}", f"--data {path.parent}")
    )


def _try_copy(path: Path, to: Path) -> bool:
    """Copy file and log, and return False if the log restarted meanwhile."""
    log, log_copy = (file.with_name(f"{file.name}{_LOG}") for file in (path, to))
    for old in to.parent.glob(f"{to.name}*"):
        old.unlink()
    before = _head(log)
    shutil.copyfile(path, to)
    if before is not None:
        shutil.copyfile(log, log_copy)
    return before == _head(log)


def _head(log: Path) -> bytes | None:
    """Return the header of the log, which changes when it restarts, or None without a log."""
    try:
        with log.open("rb") as file:
            return file.read(_HEAD_BYTES)
    except FileNotFoundError:
        return None


def truncate(path: Path, until: int) -> None:
    """Let the copied journal at `path` end with commit `until`. Raises Refused."""
    with closing(Journal(path)) as journal, journal.file.writing("a shorter journal") as db:
        for table in ("commits", "touches", "tboxes", "checkpoints"):
            db.execute(f"DELETE FROM {table} WHERE seq > ?", (until,))
        db.execute("DELETE FROM meta WHERE key = 'index'")  # it refers to deleted commits
