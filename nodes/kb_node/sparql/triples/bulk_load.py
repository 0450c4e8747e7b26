"""Contents triples from stdin into a store on disk.

Usage: `python -m semmap.nodes.kb_node.sparql.triples.bulk_load PATH [BASE [packed]]`.

The input consists of frames, each a MessagePack list of triples with its length before it. With a base IRI, a
Turtle document follows after an empty frame, compressed with gzip if `packed`. The program prints the number
of triples in the store. It is smaller than the number received if two triples differ only in the spelling of
a number.
"""

from __future__ import annotations

import gzip
import io
import os
import sys
from collections.abc import Sequence
from typing import IO, Any, BinaryIO, Final

import pyoxigraph as ox
from msgspec import msgpack

from semmap.schemas import codec

Triples = Sequence[tuple[str, str, str]]
_LENGTH_BYTES: Final = 4
_triples = codec.decoder(list[tuple[str, str, str]])


END: Final = bytes(_LENGTH_BYTES)
"""An empty frame."""
PACKED: Final = "packed"


def frame(triples: Triples) -> bytes:
    """Return some triples as a frame."""
    body = msgpack.encode(triples)
    return len(body).to_bytes(_LENGTH_BYTES, "big") + body


class _Text(io.RawIOBase):
    """The frames of a stream up to an empty one, as N-Triples text."""

    def __init__(self, frames: BinaryIO) -> None:
        super().__init__()
        self._frames = frames
        self._rest = memoryview(b"")
        self._is_over = False

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        if not self._rest and not self._is_over:
            length = int.from_bytes(self._frames.read(_LENGTH_BYTES), "big")
            triples = _triples.decode(self._frames.read(length)) if length else ()
            self._is_over = not length
            self._rest = memoryview("".join([f"{s} {p} {o} .\n" for s, p, o in triples]).encode())
        there = memoryview(buffer)
        count = min(len(there), len(self._rest))
        there[:count], self._rest = self._rest[:count], self._rest[count:]
        return count


def main(path: str, base: str | None = None, form: str = "") -> None:
    """Load everything, then print the number of triples."""
    os.nice(15)  # the map itself has priority
    store = ox.Store(path)
    text = io.BufferedReader(_Text(sys.stdin.buffer), 1 << 20)
    store.bulk_load(input=text, format=ox.RdfFormat.N_TRIPLES, lenient=True)  # it was checked for the map
    if base is not None:
        document: IO[bytes] = sys.stdin.buffer
        if form == PACKED:
            document = io.BufferedReader(gzip.GzipFile(fileobj=document), 1 << 20)
        store.bulk_load(input=document, format=ox.RdfFormat.TURTLE, base_iri=base)
    store.flush()
    print(len(store), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
