"""The commits since the triples were loaded, in memory shared with forked processes."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Final

from msgspec import msgpack

from semmap.nodes.kb_node.sparql.triples.dataset import Delta
from semmap.schemas import codec

_LENGTH_BYTES: Final = 4
_deltas = codec.decoder(Delta)


class Log:
    """A log to which one process appends. Each forked process reads on from its own position."""

    def __init__(self) -> None:
        self._file = os.memfd_create("commits")
        self._read_to = 0
        self.size = 0
        """Number of changed triples in the log."""

    def fileno(self) -> int:
        """Return the file descriptor of the memory."""
        return self._file

    def append(self, delta: Delta) -> None:
        """Append the next commit."""
        body = msgpack.encode(delta)
        frame = memoryview(len(body).to_bytes(_LENGTH_BYTES, "big") + body)
        while frame:
            frame = frame[os.write(self._file, frame) :]
        self.size += len(delta.everything)
        self._read_to = os.lseek(self._file, 0, os.SEEK_CUR)

    def read_all(self) -> Iterator[Delta]:
        """Yield all commits from the first one, and mark them as read."""
        self._read_to = 0
        return self.read_new()

    def read_new(self) -> Iterator[Delta]:
        """Yield the commits since the last call; each counts as read when it is yielded."""
        while len(head := os.pread(self._file, _LENGTH_BYTES, self._read_to)) == _LENGTH_BYTES:
            length = int.from_bytes(head, "big")
            body = os.pread(self._file, length, self._read_to + _LENGTH_BYTES)
            if len(body) < length:
                return  # it is being written
            self._read_to += _LENGTH_BYTES + length
            yield _deltas.decode(body)

    def close(self) -> None:
        """Close the log in this process; forked processes keep it."""
        os.close(self._file)
