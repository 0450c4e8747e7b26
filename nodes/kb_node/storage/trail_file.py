"""The file with the trail of live poses, beside the journal: lines of JSON in two segments of bounded size.

It only grows at its end, so that an end of the process loses at most the lines that are not written yet. If
the newest segment is full, it replaces the older one, whose lines are dropped.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import BinaryIO, Final, Literal

import msgspec
from msgspec import Struct

from semmap.nodes.kb_node.storage.journal.layout import FILENAME as JOURNAL
from semmap.schemas.entities import Vector

FILENAME: Final = f"{JOURNAL}.trail"
"""Beside the journal, with which it is archived if a new map is started."""
_OLDER: Final = f"{FILENAME}.1"
ON_PERIOD_NS: Final = 5_000_000_000
"""The interval of the `on` lines.

If no line follows within twice this time, recording ended with the last one, also without an `end`.
"""
SEGMENT_BYTES: Final = 16 << 20
"""The size of a full segment. The file and the older segment together have at most twice this size."""

Kind = Literal["at", "end", "on", "start"]


class TrailLine(Struct, frozen=True, array_like=True):
    """One line of a trail at `ns` [since 1970].

    - `at`: an entity is at a position [m], in all of these places,
    - `end`: its live poses ended,
    - `on`: all others are unchanged,
    - `start`: the knowledge base started, and its earlier state ended with the previous line.
    """

    ns: int
    kind: Kind
    name: str = ""
    at: Vector | None = None
    places: tuple[str, ...] = ()


class TrailFile:
    """Appends lines. For one thread; `read_lines` is for any."""

    def __init__(self, folder: Path, segment_bytes: int = SEGMENT_BYTES) -> None:
        """Nothing is written before the first line."""
        self._file, self._older = folder / FILENAME, folder / _OLDER
        self._segment_bytes = segment_bytes
        self._is_ended = False

    def append(self, lines: Iterable[TrailLine]) -> bool:
        """Append lines. Return whether the segment is full. Raises OSError."""
        content = b"".join(msgspec.json.encode(line) + b"\n" for line in lines)
        with self._file.open("ab") as opened:
            if not self._is_ended and opened.tell():  # the last line may be incomplete
                content = b"\n" + content
            self._is_ended = False
            opened.write(content)
            opened.flush()
            self._is_ended = True
            return opened.tell() >= self._segment_bytes

    def begin_segment(self) -> None:
        """Begin a new segment and drop the older one. Raises OSError."""
        self._file.replace(self._older)


def read_lines(folder: Path) -> Iterator[TrailLine]:
    """Yield the complete lines of both segments, in order. For any thread."""
    decoder = msgspec.json.Decoder(TrailLine)
    for line in _read_segments(folder):
        try:
            yield decoder.decode(line)
        except (msgspec.DecodeError, UnicodeDecodeError):  # torn by the end of the process, or damaged
            continue


def _read_segments(folder: Path) -> list[bytes]:
    """Return the lines of both segments, also if a new segment is begun meanwhile.

    The newer segment is opened first: if it is then moved, it is still read, once.
    """
    with ExitStack() as opened:
        newer, older = (_open(folder / name, opened) for name in (FILENAME, _OLDER))
        if newer and older and os.path.sameopenfile(newer.fileno(), older.fileno()):
            older = None
        return [line for file in (older, newer) if file for line in file.read().splitlines()]


def _open(file: Path, opened: ExitStack) -> BinaryIO | None:
    try:
        return opened.enter_context(file.open("rb"))
    except FileNotFoundError:
        return None
