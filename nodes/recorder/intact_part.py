"""Reads the intact part of a recording.

The file may be truncated, because it grows or its writer was killed, or it may be damaged.
"""

from __future__ import annotations

import os
import shutil
import struct
import tempfile
import warnings
from bisect import bisect_left
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final, NamedTuple

from rerun.chunk import RrdReader

from semmap.schemas import errors

_SIGNATURE: Final = b"RRF"
_FILE_HEADER_BYTES: Final = 12
_MESSAGE_HEADER: Final = struct.Struct("<QQ")
"""Kind and length of a message, stored before it."""


class IntactPart(NamedTuple):
    """The file of the intact part, how many bytes at the end of the recording it lacks, and why."""

    path: Path
    left_out: int = 0
    why: str = ""

    def describe(self, recording: Path) -> str:
        """Describe the ignored part; empty if there is none."""
        return f"{recording} {self.why}; its last {self.left_out} bytes are ignored" if self.left_out else ""


def require_recording(path: Path) -> None:
    """Raise BadFile, with the reason, if `path` is not a recording."""
    try:
        with path.open("rb") as file:
            signature = file.read(len(_SIGNATURE))
    except FileNotFoundError:
        raise errors.BadFile(f"no such file: {path}") from None
    except OSError as error:
        raise errors.BadFile(f"cannot read {path}: {error.strerror}") from None
    if signature != _SIGNATURE:
        raise errors.BadFile(f"{path} is not a recording (.rrd)")


@contextmanager
def open_intact_part(path: Path) -> Iterator[IntactPart]:
    """Yield the recording, or a copy of its readable part. Raises BadFile if nothing is readable."""
    require_recording(path)
    if (fault := _fault(path)) is None:
        yield IntactPart(path)
        return
    ends, size = _message_ends(path), path.stat().st_size
    if not ends:
        raise errors.BadFile(f"cannot read {path}: {fault}")
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder, path.name)
        shutil.copyfile(path, copy)
        os.truncate(copy, ends[-1])
        why = "ends in the middle of a message"
        if _fault(copy) is not None:
            number = bisect_left(ends, True, key=lambda end: _is_damaged(path, copy, end))
            if not number:
                raise errors.BadFile(f"cannot read {path}: {fault}")
            shutil.copyfile(path, copy)
            os.truncate(copy, ends[number - 1])
            why = f"is damaged after {ends[number - 1]} bytes"
        yield IntactPart(copy, size - copy.stat().st_size, why)


def chunks(path: Path) -> Iterator[Any]:
    """Yield the chunks of a recording. Raises RuntimeError or ValueError at a damaged chunk."""
    with warnings.catch_warnings():
        # A recording that is not closed, because it grows or its writer was killed, has no footer.
        warnings.filterwarnings("ignore", message=".*no footer")
        yield from RrdReader(path).stream()


def _is_damaged(path: Path, copy: Path, end: int) -> bool:
    """Return whether the first `end` bytes contain damage."""
    shutil.copyfile(path, copy)
    os.truncate(copy, end)
    return _fault(copy) is not None


def _fault(path: Path) -> str | None:
    """Return why the file cannot be read to its end; None if it can be."""
    try:
        for _ in chunks(path):
            pass
    except (RuntimeError, ValueError) as error:
        return str(error)
    return None


def _message_ends(path: Path) -> list[int]:
    """Return the end of each complete message."""
    ends = []
    with path.open("rb") as file:
        size, end = file.seek(0, os.SEEK_END), _FILE_HEADER_BYTES
        while (start := end + _MESSAGE_HEADER.size) <= size:
            file.seek(end)
            _, length = _MESSAGE_HEADER.unpack(file.read(_MESSAGE_HEADER.size))
            if start + length > size:
                break
            end = start + length
            ends.append(end)
    return ends
