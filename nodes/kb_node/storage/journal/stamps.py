"""The times of commits, read once and cached."""

from __future__ import annotations

import threading
from array import array
from bisect import bisect_right
from itertools import accumulate

from msgspec import Struct

from semmap.nodes.kb_node.storage.encoding import body_encoding
from semmap.nodes.kb_node.storage.journal import rows
from semmap.nodes.kb_node.storage.journal.beginning import Beginning
from semmap.nodes.kb_node.storage.journal.sqlite_file import JournalFile


class Stamps:
    """The stamps of all commits in a journal [ns since 1970]. Any thread may use it."""

    def __init__(self, file: JournalFile, beginning: Beginning) -> None:
        self._file = file
        self._beginning = beginning
        self._known = array("q")
        self._reading = threading.Lock()

    def reset(self, beginning: Beginning) -> None:
        """Use another start of the history from now on."""
        with self._reading:
            self._beginning, self._known = beginning, array("q")

    def of(self, seq: int) -> int:
        """Return when a commit was made. Raises Damaged if it is missing."""
        with self._file.reading() as db:
            row = db.execute("SELECT body FROM commits WHERE seq = ?", (seq,)).fetchone()
        if row is None:
            raise rows.Damaged(self._file.path, seq)
        return _stamp(row[0])

    def seq_at(self, stamp_ns: int) -> int:
        """Return the last commit stamped up to a time, or one less than the first known one.

        If the clock was set back, a time occurs twice, and the second one counts. The last commit of the
        snapshot is known by its stamp, too.
        """
        with self._reading:
            stamps, begins = self._read_all(), self._beginning
            known = array("q", [begins.stamp_ns]) + stamps if begins.seq else stamps
            earliest_since = list(accumulate(reversed(known), min))[::-1]
            last = begins.seq + len(stamps)
        return last - len(known) + bisect_right(earliest_since, stamp_ns)

    def within(self, first_ns: int, last_ns: int) -> list[int]:
        """Return the commits stamped within these times, both included, in order."""
        with self._reading:
            stamps = enumerate(self._read_all(), start=self._beginning.seq + 1)
            return [seq for seq, stamp_ns in stamps if first_ns <= stamp_ns <= last_ns]

    def latest(self) -> int:
        """Return the latest stamp of any commit."""
        with self._reading:
            return max(self._read_all(), default=self._beginning.stamp_ns)

    def _read_all(self) -> array[int]:
        """Return the stamps of all commits, after reading new ones."""
        known = self._known
        while page := rows.read_page(self._file, self._beginning.seq + len(known)):
            known.extend(_stamp(row.body) for row in page)
        return known


class _Stamp(Struct):
    """The part of a commit with its time."""

    stamp_ns: int


def _stamp(body: bytes) -> int:
    found: _Stamp = body_encoding.decode(body, _Stamp)
    return found.stamp_ns
