"""Retention of recordings: files beyond an age or a total size are deleted.

A file that is being written is never deleted. A new file is started in time, so that no file holds too much.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Final, NamedTuple

from semmap.schemas.errors import BadRequest

PATTERN: Final = r"^[1-9][0-9]{0,5}(h|d|MB|GB)$"
_SECONDS: Final = {"h": 3600, "d": 86400}
_BYTES: Final = {"MB": 10**6, "GB": 10**9}
_PARTS: Final = 7
"""Each file holds about this fraction of the total, so the oldest seventh is deleted at once."""


class File(NamedTuple):
    """A recording: when it was last written [s since 1970], and its size."""

    path: Path
    written_s: float
    size_bytes: int


class Retention(NamedTuple):
    """The limits of retention. At most one of them is set; without a limit everything is kept."""

    age_s: int | None = None
    size_bytes: int | None = None

    @classmethod
    def read(cls, text: str) -> Retention:
        """Parse `12h`, `7d`, `500MB` or `20GB`. Raises BadRequest."""
        if not re.fullmatch(PATTERN, text):
            raise BadRequest(f"'{text}' is neither an age nor a size; examples: 12h, 7d, 500MB, 20GB")
        number, unit = int(text.rstrip("hdMGB")), text.lstrip("0123456789")
        if unit in _SECONDS:
            return cls(age_s=number * _SECONDS[unit])
        return cls(size_bytes=number * _BYTES[unit])

    def is_full(self, current: File, begun_s: float, now_s: float) -> bool:
        """Return whether a new file must be started."""
        if self.age_s is not None:
            return now_s - begun_s > self.age_s / _PARTS
        return self.size_bytes is not None and current.size_bytes > self.size_bytes / _PARTS

    def surplus(self, others: Iterable[File], current: File, now_s: float) -> list[File]:
        """Return the files to delete, oldest first."""
        oldest_first = sorted(others, key=lambda file: file.written_s)
        if self.age_s is not None:
            return [file for file in oldest_first if now_s - file.written_s > self.age_s]
        if self.size_bytes is None:
            return []
        gone, total = [], current.size_bytes + sum(file.size_bytes for file in oldest_first)
        for file in oldest_first:
            if total <= self.size_bytes:
                break
            gone.append(file)
            total -= file.size_bytes
        return gone


KEEP_ALL: Final = Retention()


def recordings(folder: Path) -> list[File]:
    """Return the recordings in a folder."""
    found = []
    for path in folder.glob("*.rrd"):
        try:
            stat = path.stat()
        except OSError:  # deleted since
            continue
        found.append(File(path, stat.st_mtime, stat.st_size))
    return found
