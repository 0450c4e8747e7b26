"""Fills a store on disk from triples on stdin: `python -m nodes.kb_node.sparql.triples.filling PATH`.

They come in frames, each a MessagePack list of triples behind its length. Says on stdout how many triples the
store has: fewer than came where two differ in the spelling of a number.
"""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Sequence
from typing import Any, BinaryIO, Final

import pyoxigraph as ox
from msgspec import msgpack

Triples = Sequence[tuple[str, str, str]]
_LENGTH_BYTES: Final = 4
_triples = msgpack.Decoder(list[tuple[str, str, str]])


def frame(triples: Triples) -> bytes:
    """Some triples as they are sent."""
    body = msgpack.encode(triples)
    return len(body).to_bytes(_LENGTH_BYTES, "big") + body


class _Text(io.RawIOBase):
    """The frames of a stream, to be read as N-Triples."""

    def __init__(self, frames: BinaryIO) -> None:
        super().__init__()
        self._frames = frames
        self._rest = memoryview(b"")

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        if not self._rest and (head := self._frames.read(_LENGTH_BYTES)):
            triples = _triples.decode(self._frames.read(int.from_bytes(head, "big")))
            self._rest = memoryview("".join([f"{s} {p} {o} .\n" for s, p, o in triples]).encode())
        there = memoryview(buffer)
        count = min(len(there), len(self._rest))
        there[:count], self._rest = self._rest[:count], self._rest[count:]
        return count


def main(path: str) -> None:
    """Read to the end, then say."""
    os.nice(5)  # the map itself comes first
    store = ox.Store(path)
    text = io.BufferedReader(_Text(sys.stdin.buffer), 1 << 20)
    store.bulk_load(input=text, format=ox.RdfFormat.N_TRIPLES)
    store.flush()
    print(len(store), flush=True)


if __name__ == "__main__":
    main(sys.argv[1])
