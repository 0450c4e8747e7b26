"""Detects that a recording is no longer written. Rerun itself only logs this, on its own thread."""

from __future__ import annotations

import shutil
from pathlib import Path

CHECK_S = 2.0
"""Interval of the checks: several times the delay until recorded data reaches the file."""
_ROOM_BYTES = 1 << 20


class FileMonitor:
    """Monitors a file that grows whenever something is recorded."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._size = -1
        self._written = 0
        self._recorded = 0

    def find_problem(self, recorded: int) -> str:
        """Describe the problem, or return an empty text.

        Must be called every `CHECK_S`. `recorded` is the total number of records so far.
        """
        before, self._recorded = self._recorded, recorded
        try:
            size = self._path.stat().st_size
        except OSError as error:
            return f"cannot write recording {self._path}: {error.strerror}"
        if size != self._size:
            self._size, self._written = size, recorded
            return ""
        if before <= self._written:
            return ""
        return f"recording {self._path} is no longer written{self._cause()}"

    def _cause(self) -> str:
        try:
            full = shutil.disk_usage(self._path.parent).free < _ROOM_BYTES
        except OSError:
            return ""
        return ": the disk is full" if full else ""
