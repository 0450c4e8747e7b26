"""The encoding of a commit, which starts while the rest of it is still being computed.

Most of a large commit are its triples, which are known before the changed entities, and these before the
locations. Another thread encodes and compresses them in pieces, so that the whole is never in memory
uncompressed. The result equals that of `body_encoding.encode`.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import chain
from typing import Any, Final

from msgspec import structs

from semmap.nodes.kb_node.progress import split_batches
from semmap.nodes.kb_node.storage.encoding import body_encoding
from semmap.schemas import codec
from semmap.schemas.commits import Commit
from semmap.schemas.entities import Entity

_MANY: Final = 1000
"""Triples. For fewer a thread costs more time than it saves."""
_PIECE: Final = 10_000
"""List elements that are encoded together: some megabytes, and a few milliseconds."""
_FIELDS: Final = Commit.__struct_encode_fields__
_CHANGED: Final = ("changed",)
_OTHERS: Final = ("removed", "notes")
_EFFECTS: Final = (*_CHANGED, *_OTHERS)
"""The last fields of a commit."""
_BEGINNING: Final = _FIELDS[: -len(_EFFECTS)]


class EarlyBody:
    """The body of a commit of which only the effects are unknown."""

    def __init__(self, commit: Commit) -> None:
        self._is_active = True
        self._deflate = zlib.compressobj(body_encoding.COMPRESSION_LEVEL)
        self._executor = ThreadPoolExecutor(1)
        beginning = chain([_header(_MAP, len(_FIELDS))], _encode_fields(commit, _BEGINNING))
        self._head = self._executor.submit(self._compress, beginning)
        self._without = self._deflate
        """The compressor state after the head only."""
        self._changed: Sequence[Entity] | None = None
        self._middle: Future[bytes]

    def expect(self, commit: Commit) -> None:
        """Encode the entities that the commit is likely to change."""
        self._changed = commit.changed
        self._middle = self._executor.submit(self._encode_expected, _encode_fields(commit, _CHANGED))

    def finish(self, commit: Commit) -> Future[bytes]:
        """Return the whole body, now that the effects are known."""
        whole = self._executor.submit(self._encode_whole, commit)
        self._executor.shutdown(wait=False)
        return whole

    def discard(self) -> None:
        """Stop the encoding, because the commit was aborted."""
        self._is_active = False

    def _encode_expected(self, changed: Iterator[bytes]) -> bytes:
        self._without = self._deflate.copy()
        return self._compress(changed)

    def _encode_whole(self, commit: Commit) -> bytes:
        if commit.changed is self._changed:
            begun = self._head.result() + self._middle.result()
            return begun + self._compress(_encode_fields(commit, _OTHERS)) + self._deflate.flush()
        self._deflate = self._without
        return self._head.result() + self._compress(_encode_fields(commit, _EFFECTS)) + self._deflate.flush()

    def _compress(self, pieces: Iterator[bytes]) -> bytes:
        found = bytearray()
        for piece in pieces:
            if not self._is_active:
                break
            found += self._deflate.compress(piece)
        return bytes(found)


def begin_body(commit: Commit, after: str) -> EarlyBody | None:
    """Start to encode a commit with enough triples, else return None. `after` is the digest before it."""
    if len(commit.inserted) + len(commit.retracted) < _MANY:
        return None
    return EarlyBody(structs.replace(commit, digest=after))


_MAP: Final = (0x80, 0xDE)
_ARRAY: Final = (0x90, 0xDC)
"""The MessagePack codes of a short and a longer one. The longest has the next code."""


def _header(codes: tuple[int, int], count: int) -> bytes:
    """Return the MessagePack header of a map or array with this many elements."""
    short, long = codes
    if count < 1 << 4:
        return bytes([short | count])
    size = 2 if count < 1 << 16 else 4
    return bytes([long + size // 4]) + count.to_bytes(size, "big")


def _encode_fields(commit: Commit, names: Sequence[str]) -> Iterator[bytes]:
    """Yield these fields, each after its name. A long list is encoded in pieces."""
    for name in names:
        value: Any = getattr(commit, name)
        yield codec.encode(name)
        if not isinstance(value, tuple) or len(value) <= _PIECE:
            yield codec.encode(value)
            continue
        yield _header(_ARRAY, len(value))
        for piece in split_batches(value, _PIECE, _ignore_progress):
            yield codec.encode(piece)[len(_header(_ARRAY, len(piece))) :]


def _ignore_progress() -> None:
    pass
