"""Tells when a recording is no longer written. Rerun itself only logs it, on a thread of its own."""

from __future__ import annotations

import shutil
from pathlib import Path

CHECK_S = 2.0
"""Between two looks: several times as long as what is recorded takes to reach the file."""
_ROOM_BYTES = 1 << 20


class FileMonitor:
    """Of one file, which grows whenever something is recorded."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._size = -1
        self._written = 0
        self._recorded = 0

    def find_problem(self, recorded: int) -> str:
        """What is wrong, in a sentence; empty if nothing is. `recorded` counts all that was by now.

        To be asked every `CHECK_S`.
        """
        before, self._recorded = self._recorded, recorded
        try:
            size = self._path.stat().st_size
        except OSError as error:
            return f"the recording {self._path} cannot be written: {error.strerror}"
        if size != self._size:
            self._size, self._written = size, recorded
            return ""
        if before <= self._written:
            return ""
        return f"the recording {self._path} is not written any more{self._why()}"

    def _why(self) -> str:
        try:
            full = shutil.disk_usage(self._path.parent).free < _ROOM_BYTES
        except OSError:
            return ""
        return ": the disk is full" if full else ""
