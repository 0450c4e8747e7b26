"""A copy of a journal, taken without opening it: a knowledge base may be at work on the original.

That one holds SQLite's lock for as long as it runs. But its file changes in one way only: pages move into it
from the write-ahead log, which keeps them until it is begun anew, and then it has another head. So the file,
then the log, copied while the log's head stays the same, are the journal as it was at some moment between.
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
    """Copy the journal of the data folder `data`, which stays as it is, to the file `to`, and look at it.

    Raises BadFile when there is none or it cannot be read, Refused when it is damaged: the copy then tells of
    the original.
    """
    path = data / FILENAME
    if not path.is_file():
        raise errors.BadFile(f"there is no map in {data}")
    for tried in range(_TRIES):
        try:
            if _copied(path, to):
                Journal(to).close()
                return
        except OSError as error:
            raise errors.BadFile(f"the journal of {data} cannot be copied: {error.strerror}") from None
        except errors.Refused as error:
            if tried > 1:  # not a transaction that was being written just then
                raise name_original(error, to, path) from None
        time.sleep(_AGAIN_S)
    raise errors.Refused(f"{path} is being written to all the time; try again, or replay a backup of it")


def name_original(error: errors.Refused, copy: Path, path: Path) -> errors.Refused:
    """What is said of a copy, as said of the file that it is of."""
    return errors.Refused(
        error.text.replace(str(copy), str(path)).replace(f"--data {copy.parent}", f"--data {path.parent}")
    )


def _copied(path: Path, to: Path) -> bool:
    """Copy file and log; False if the log was begun anew meanwhile."""
    log, log_copy = (file.with_name(f"{file.name}{_LOG}") for file in (path, to))
    for old in to.parent.glob(f"{to.name}*"):
        old.unlink()
    before = _head(log)
    shutil.copyfile(path, to)
    if before is not None:
        shutil.copyfile(log, log_copy)
    return before == _head(log)


def _head(log: Path) -> bytes | None:
    """How the log begins: another one begins otherwise. None where there is none."""
    try:
        with log.open("rb") as file:
            return file.read(_HEAD_BYTES)
    except FileNotFoundError:
        return None


def truncate(path: Path, until: int) -> None:
    """Let the journal at `path`, a copy, end with commit `until`. Raises Refused."""
    with closing(Journal(path)) as journal, journal.file.writing("a shorter journal") as db:
        for table in ("commits", "touches", "tboxes", "checkpoints"):
            db.execute(f"DELETE FROM {table} WHERE seq > ?", (until,))
        db.execute("DELETE FROM meta WHERE key = 'index'")  # what it records is of commits that are gone
