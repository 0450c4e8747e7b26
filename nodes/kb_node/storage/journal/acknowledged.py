"""The number of the last acknowledged commit, in a small file beside the journal.

It is written through shared memory, without a wait for the disk, so it outlives the process but not a power
failure. It shows whether a transaction that SQLite did not finish was acknowledged.
"""

from __future__ import annotations

import mmap
import os
import struct
from pathlib import Path
from typing import Final

_NUMBER: Final = struct.Struct("<q")
_SUFFIX: Final = "-acknowledged"


class Acknowledged:
    """The file of an open journal, from its first commit until it is closed.

    A number from a process that was killed stays until the next one, as long as the log has the transaction
    that was interrupted. Without room for the file, nothing is kept.
    """

    def __init__(self, path: Path) -> None:
        """Prepare the file of the journal at `path`."""
        self._path = _file_of(path)
        self._memory: mmap.mmap | None = None
        self._is_open = False

    def note(self, seq: int) -> None:
        """Note that the commits up to `seq` are acknowledged from now on."""
        if not self._is_open:
            self._is_open = True
            self._memory = _map_file(self._path)
        if self._memory is not None:
            _NUMBER.pack_into(self._memory, 0, seq)

    def close(self) -> None:
        """Delete the file: a journal that was closed has nothing unfinished."""
        if self._memory is not None:
            self._memory.close()
            self._memory = None
        self._path.unlink(missing_ok=True)


def _map_file(path: Path) -> mmap.mmap | None:
    """Return the file as memory, or None, without a file, if there is no room."""
    try:
        path.touch()
        with path.open("r+b") as file:
            # A write to memory without a block on the disk would end the process.
            os.posix_fallocate(file.fileno(), 0, _NUMBER.size)
            return mmap.mmap(file.fileno(), _NUMBER.size)
    except OSError:
        path.unlink(missing_ok=True)
        return None


def read_acknowledged(path: Path) -> int | None:
    """Return the last acknowledged commit of the journal at `path`, or None if that is not known."""
    try:
        return int(_NUMBER.unpack(_file_of(path).read_bytes())[0])
    except (OSError, struct.error):
        return None


def _file_of(path: Path) -> Path:
    return path.with_name(f"{path.name}{_SUFFIX}")
