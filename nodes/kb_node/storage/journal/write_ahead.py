"""Damage to SQLite's write-ahead log, which holds the last commits until they are moved into the file.

SQLite takes a log that is damaged for one that ends there, as after a loss of power, and says nothing of the
commits behind that. So the log is looked at before SQLite opens it, and compared with what that found. A
damaged one is set aside as it is; for salvage its checksums are made anew, and commits prove themselves.
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

_HEADER: Final = struct.Struct(">IIII8sII")
"""What it is, version, page size, number of the log, salts, checksum of these."""
_FRAME: Final = struct.Struct(">II8sII")
"""Page, pages of the file (if a transaction ends with this frame), salts, checksum."""
_LITTLE_ENDIAN: Final = 0x377F0682
_VERSION: Final = 3007000
_SUFFIX: Final = "-wal"
_DAMAGED_SUFFIX: Final = "-wal.damaged"


class Log(NamedTuple):
    """A log as it is on disk. The file stays readable until `close`, whatever becomes of its name."""

    path: Path
    file: BinaryIO
    ends: tuple[int, ...]
    """The numbers of the frames that transactions end with, from 1."""
    is_before_boot: bool
    """Has the machine started since it was written? Then it may have lost power in the middle of that."""

    @property
    def has_valid_header(self) -> bool:
        """Is the beginning as SQLite wrote it?"""
        self.file.seek(0)
        return _is_sound(self.file.read(_HEADER.size))

    def has_lost_commits(self, recovered: int) -> bool:
        """Are there transactions behind the `recovered` frames, other than one that was never finished?"""
        behind = [end for end in self.ends if end > recovered]
        return len(behind) > (1 if self.is_before_boot else 0)

    def save_copy(self) -> None:
        """Keep a copy for salvage."""
        self.file.seek(0)
        with self.path.with_name(f"{self.path.name}{_DAMAGED_SUFFIX}").open("wb") as copy:
            shutil.copyfileobj(self.file, copy)


def inspect_log(path: Path) -> Log | None:
    """The log of the database at `path`, if there is one with anything in it."""
    log = path.with_name(f"{path.name}{_SUFFIX}")
    if not log.exists() or log.stat().st_size <= _HEADER.size:
        return None
    file = log.open("rb")
    ends = tuple(number for number, pages in _frames(file) if pages)
    booted_s = time.time() - time.clock_gettime(time.CLOCK_BOOTTIME)
    return Log(path, file, ends, log.stat().st_mtime < booted_s)


def has_damaged_copy(path: Path) -> bool:
    """Is there a damaged log that was not mended yet?"""
    return path.with_name(f"{path.name}{_DAMAGED_SUFFIX}").exists()


def recover(path: Path) -> None:
    """Let SQLite read all of the log that was set aside, damaged pages too.

    Not the first page, where it is damaged: SQLite could read nothing at all then, and the one before does.
    """
    damaged = path.with_name(f"{path.name}{_DAMAGED_SUFFIX}")
    content = memoryview(damaged.read_bytes())
    with damaged.open("rb") as file:
        salts, size = _salts(file), _page_size(file)
    order = "little"
    mended = bytearray(_HEADER.pack(_LITTLE_ENDIAN, _VERSION, size, 0, salts, 0, 0))
    sums = _checksum(memoryview(mended)[:24], (0, 0), order)
    mended[24:32] = struct.pack(">II", *sums)
    written: tuple[int, int] | None = None
    theirs = sys.byteorder  # where the head is damaged: that of this machine, as SQLite writes it
    if _is_sound(bytes(content[: _HEADER.size])):
        written = _HEADER.unpack_from(content)[-2:]
        theirs = "little" if _HEADER.unpack_from(content)[0] == _LITTLE_ENDIAN else "big"
    for start in range(_HEADER.size, len(content) - size - _FRAME.size + 1, _FRAME.size + size):
        number, pages, own, *said = _FRAME.unpack_from(content, start)
        if not _is_near(own, salts):
            break
        head, page = content[start : start + 8], content[start + _FRAME.size : start + _FRAME.size + size]
        is_sound = written is None or _checksum(page, _checksum(head, written, theirs), theirs) == (*said,)
        written = said[0], said[1]
        if number == 1 and not pages and not is_sound:
            continue
        sums = _checksum(page, _checksum(head, sums, order), order)
        mended += bytes(head) + salts + struct.pack(">II", *sums) + bytes(page)
    path.with_name(f"{path.name}{_SUFFIX}").write_bytes(mended)


def delete_damaged_copy(path: Path) -> None:
    """What was set aside is mended: from now on the journal proves its commits itself."""
    path.with_name(f"{path.name}{_DAMAGED_SUFFIX}").unlink()


def _frames(file: BinaryIO) -> Iterator[tuple[int, int]]:
    """The number of each frame of this log, and the pages of the file if a transaction ends with it."""
    salts, size = _salts(file), _page_size(file)
    file.seek(0, 2)
    length = file.tell()
    for number, start in enumerate(
        range(_HEADER.size, length - size - _FRAME.size + 1, _FRAME.size + size), 1
    ):
        file.seek(start)
        _, pages, own, _, _ = _FRAME.unpack(file.read(_FRAME.size))
        if not _is_near(own, salts):
            return  # from here on it is what an earlier log has left
        yield number, pages


def _salts(file: BinaryIO) -> bytes:
    """Those of the log; of its first frames where its head is damaged."""
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
    """Read from the database itself, whose head is not a part of the log."""
    with Path(file.name.removesuffix(_DAMAGED_SUFFIX).removesuffix(_SUFFIX)).open("rb") as database:
        database.seek(16)
        size = int.from_bytes(database.read(2), "big")
    return 65536 if size == 1 else size


def _is_near(own: bytes, salts: bytes) -> bool:
    """Are they the same, but for some flipped bits? Those of another log are random."""
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
