"""Detection of damage in the write-ahead log of SQLite, which holds the last commits until a checkpoint.

SQLite treats a damaged log like one that ends there, as after a power failure, and does not report the lost
commits. Therefore the log is inspected before SQLite opens it, and compared with what SQLite found. A
damaged log is kept as a copy. To recover its commits, its checksums are computed again, and the commits are
verified by their digests.
"""

from __future__ import annotations

import shutil
import struct
import sys
import time
from array import array
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO, Final, NamedTuple

from semmap.nodes.kb_node.storage.journal.acknowledged import read_acknowledged

_HEADER: Final = struct.Struct(">IIII8sII")
"""Magic number, version, page size, sequence number, salts, checksum."""
_FRAME: Final = struct.Struct(">II8sII")
"""Page, pages of the file (if a transaction ends with this frame), salts, checksum."""
_LITTLE_ENDIAN: Final = 0x377F0682
_VERSION: Final = 3007000
_SUFFIX: Final = "-wal"
_DAMAGED_SUFFIX: Final = "-wal.damaged"


class Log(NamedTuple):
    """A log on disk. The file stays readable until it is closed, even if it is renamed or deleted."""

    path: Path
    file: BinaryIO
    ends: tuple[int, ...]
    """The numbers of the frames that end transactions, from 1."""
    is_before_boot: bool
    """Whether it was written before the last boot, and a power failure may have interrupted it."""
    acknowledged: int | None = None
    """The last commit that was acknowledged, if that is known."""

    @property
    def has_valid_header(self) -> bool:
        """Return whether the header is as SQLite wrote it."""
        self.file.seek(0)
        return _is_sound(self.file.read(_HEADER.size))

    def has_lost_commits(self, recovered: int, last: int) -> bool:
        """Return whether there are finished transactions after the `recovered` frames and commit `last`.

        SQLite writes the head of a frame before its page. An interruption between the two leaves a last
        transaction that looks finished. It is not lost if it was certainly not acknowledged.
        """
        behind = [end for end in self.ends if end > recovered]
        is_unacknowledged = self.acknowledged is not None and self.acknowledged <= last
        return len(behind) > (1 if self.is_before_boot or is_unacknowledged else 0)

    def save_copy(self) -> None:
        """Save a copy for the repair."""
        self.file.seek(0)
        with self.path.with_name(f"{self.path.name}{_DAMAGED_SUFFIX}").open("wb") as copy:
            shutil.copyfileobj(self.file, copy)


def inspect_log(path: Path) -> Log | None:
    """Return the log of the database at `path`, or None if it is missing or empty."""
    log = path.with_name(f"{path.name}{_SUFFIX}")
    if not log.exists() or log.stat().st_size <= _HEADER.size:
        return None
    file = log.open("rb")
    ends = tuple(number for number, pages in _frames(file) if pages)
    booted_s = time.time() - time.clock_gettime(time.CLOCK_BOOTTIME)
    return Log(path, file, ends, log.stat().st_mtime < booted_s, read_acknowledged(path))


def has_damaged_copy(path: Path) -> bool:
    """Return whether there is a copy of a damaged log that was not recovered yet."""
    return path.with_name(f"{path.name}{_DAMAGED_SUFFIX}").exists()


def recover(path: Path) -> None:
    """Write a log with valid checksums from the copy of the damaged one, including damaged pages.

    A damaged first page is left out, because SQLite could not open the file with it. The previous version
    of that page is used instead.
    """
    damaged = path.with_name(f"{path.name}{_DAMAGED_SUFFIX}")
    content = memoryview(damaged.read_bytes())
    with damaged.open("rb") as file:
        salts, size = _salts(file), _page_size(file)
    order = "little"
    recovered = bytearray(_HEADER.pack(_LITTLE_ENDIAN, _VERSION, size, 0, salts, 0, 0))
    sums = _checksum(memoryview(recovered)[:24], (0, 0), order)
    recovered[24:32] = struct.pack(">II", *sums)
    written: tuple[int, int] | None = None
    theirs = sys.byteorder  # for a damaged header: that of this machine, as SQLite writes it
    if _is_sound(bytes(content[: _HEADER.size])):
        written = _HEADER.unpack_from(content)[-2:]
        theirs = "little" if _HEADER.unpack_from(content)[0] == _LITTLE_ENDIAN else "big"
    for start in range(_HEADER.size, len(content) - size - _FRAME.size + 1, _FRAME.size + size):
        number, pages, own, *stored_sums = _FRAME.unpack_from(content, start)
        if not _is_near(own, salts):
            break
        head, page = content[start : start + 8], content[start + _FRAME.size : start + _FRAME.size + size]
        is_sound = written is None or _checksum(page, _checksum(head, written, theirs), theirs) == (
            *stored_sums,
        )
        written = stored_sums[0], stored_sums[1]
        if number == 1 and not pages and not is_sound:
            continue
        sums = _checksum(page, _checksum(head, sums, order), order)
        recovered += bytes(head) + salts + struct.pack(">II", *sums) + bytes(page)
    path.with_name(f"{path.name}{_SUFFIX}").write_bytes(recovered)


def delete_damaged_copy(path: Path) -> None:
    """Delete the copy after recovery. From then on the journal verifies its commits itself."""
    path.with_name(f"{path.name}{_DAMAGED_SUFFIX}").unlink()


def _frames(file: BinaryIO) -> Iterator[tuple[int, int]]:
    """Yield the number of each frame of this log, and the file's pages if a transaction ends with it."""
    salts, size = _salts(file), _page_size(file)
    file.seek(0, 2)
    length = file.tell()
    for number, start in enumerate(
        range(_HEADER.size, length - size - _FRAME.size + 1, _FRAME.size + size), 1
    ):
        file.seek(start)
        _, pages, own, _, _ = _FRAME.unpack(file.read(_FRAME.size))
        if not _is_near(own, salts):
            return  # the rest was left by an earlier log
        yield number, pages


def _salts(file: BinaryIO) -> bytes:
    """Return the salts of the log, or those of its first frame if the header is damaged."""
    file.seek(0)
    head = file.read(_HEADER.size)
    if _is_sound(head):
        return head[16:24]
    file.seek(_HEADER.size + 8)
    return file.read(8)


def _is_sound(head: bytes) -> bool:
    magic, *_, first, second = _HEADER.unpack(head)
    order = "little" if magic == _LITTLE_ENDIAN else "big"
    return _checksum(memoryview(head)[:24], (0, 0), order) == (first, second)


def _page_size(file: BinaryIO) -> int:
    """Return the page size from the header of the database, which is not part of the log."""
    with Path(file.name.removesuffix(_DAMAGED_SUFFIX).removesuffix(_SUFFIX)).open("rb") as database:
        database.seek(16)
        size = int.from_bytes(database.read(2), "big")
    return 65536 if size == 1 else size


def _is_near(own: bytes, salts: bytes) -> bool:
    """Return whether salts are equal except for a few flipped bits. Those of another log are random."""
    return (int.from_bytes(own, "big") ^ int.from_bytes(salts, "big")).bit_count() <= 2


def _checksum(content: memoryview, sums: tuple[int, int], order: str) -> tuple[int, int]:
    words = array("I", bytes(content))
    if order == "big":
        words.byteswap()
    first, second = sums
    for i in range(0, len(words), 2):
        first = (first + words[i] + second) & 0xFFFFFFFF
        second = (second + words[i + 1] + first) & 0xFFFFFFFF
    return first, second
