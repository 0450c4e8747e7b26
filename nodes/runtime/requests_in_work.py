"""Recognises requests that end their node: they are sent again after a restart, and would end it again.

A node writes the request that it works on to a small file. The file survives the process, so the next process
counts that request. After two ends the request is rejected until the system is restarted. The file is not
synchronised to the disk, because only an end of the process matters, not one of the machine.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

import msgspec

from semmap.schemas import errors

IN_WORK_VARIABLE: Final = "SEMMAP_IN_WORK"
"""The folder of the files, which `semmap up` empties; unset without a supervisor."""
MAX_ENDS: Final = 2
"""A request that has ended its node this many times is rejected."""
_DIGEST_BYTES: Final = 16
_NONE: Final = bytes(2 * _DIGEST_BYTES)
_MAX_COUNTED: Final = 1000
"""The largest number of counted requests; the oldest are dropped."""


def is_counted(kind: Any) -> bool:
    """Return whether requests of this type are counted: those that contain an id, or transactions with ids.

    Requests without an id, which all nodes send when they start, cannot be told apart.
    """
    return not {"id", "transactions"}.isdisjoint(getattr(kind, "__struct_fields__", ()))


def count_ends(ends: Mapping[str, int], in_work: str) -> dict[str, int]:
    """Return the ends by request, after a process has ended during the request `in_work`, or "" for none."""
    if not in_work:
        return dict(ends)
    counted = {request: count for request, count in ends.items() if request != in_work}
    counted[in_work] = ends.get(in_work, 0) + 1
    return dict(list(counted.items())[-_MAX_COUNTED:])


class RequestsInWork:
    """The file of one node; owned by the thread that handles its requests."""

    def __init__(self, node: str, path: Path | None) -> None:
        """Read the file at `path`, and count the request during which the last process ended.

        Without a file, for example on a full disk, no request is counted.
        """
        self._node = node
        self._ends: dict[str, int] = {}
        self._current = ""
        self._file: int | None = None
        if path is None:
            return
        with suppress(OSError):
            self._file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
            content = path.read_bytes()
            with suppress(msgspec.DecodeError, UnicodeDecodeError):  # new, or only partly written
                ends = msgspec.json.decode(content[len(_NONE) :], type=dict[str, int])
                self._ends = count_ends(ends, content[: len(_NONE)].strip(b"\0").decode("ascii"))
            self._write_all(self._file)

    @classmethod
    def of(cls, node: str) -> RequestsInWork:
        """Open the file of a node in the folder that its supervisor has set."""
        folder = os.environ.get(IN_WORK_VARIABLE)
        return cls(node, Path(folder) / node if folder else None)

    def begin(self, asker: str, verb: str, payload: bytes | bytearray) -> None:
        """Note that work on a request begins. Raises Refused if it has ended the node twice."""
        if self._file is None:
            return
        digest = hashlib.blake2b(payload, digest_size=_DIGEST_BYTES, key=f"{asker} {verb}".encode()[:64])
        request = digest.hexdigest()
        if self._ends and self._ends.get(request, 0) >= MAX_ENDS:
            raise errors.Refused(
                f"{self._node}: request rejected: it ended the node twice; restart the system to try it again"
            )
        self._current = request
        with suppress(OSError):
            os.pwrite(self._file, request.encode(), 0)

    def end(self) -> None:
        """Note that the node has survived the current request, if there is one."""
        if self._file is None or not self._current:
            return
        if self._ends.pop(self._current, None) is not None:
            self._write_all(self._file)
        else:
            with suppress(OSError):
                os.pwrite(self._file, _NONE, 0)
        self._current = ""

    def _write_all(self, file: int) -> None:
        content = _NONE + msgspec.json.encode(self._ends)
        with suppress(OSError):
            os.pwrite(file, content, 0)
            os.ftruncate(file, len(content))
