"""The commits since the triples were loaded, in memory that a process shares with those forked from it."""

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
    """One process appends; those that were forked from it each read on from where it was then."""

    def __init__(self) -> None:
        self._file = os.memfd_create("commits")
        self._read_to = 0
        self.size = 0
        """How many changed triples it holds."""

    def fileno(self) -> int:
        """Of the memory."""
        return self._file

    def append(self, delta: Delta) -> None:
        """The next commit."""
        body = msgpack.encode(delta)
        frame = memoryview(len(body).to_bytes(_LENGTH_BYTES, "big") + body)
        while frame:
            frame = frame[os.write(self._file, frame) :]
        self.size += len(delta.everything)
        self._read_to = os.lseek(self._file, 0, os.SEEK_CUR)

    def read_all(self) -> Iterator[Delta]:
        """From the first on; they count as read."""
        self._read_to = 0
        return self.read_new()

    def read_new(self) -> Iterator[Delta]:
        """Those that came since it was last read here; each counts as read when it is given."""
        while len(head := os.pread(self._file, _LENGTH_BYTES, self._read_to)) == _LENGTH_BYTES:
            length = int.from_bytes(head, "big")
            body = os.pread(self._file, length, self._read_to + _LENGTH_BYTES)
            if len(body) < length:
                return  # it is being written
            self._read_to += _LENGTH_BYTES + length
            yield _deltas.decode(body)

    def close(self) -> None:
        """Here; those who were forked keep it."""
        os.close(self._file)
