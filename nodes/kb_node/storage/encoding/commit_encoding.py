"""A commit as it stands in the journal, made while the rest of it is worked out.

The triples of a large commit are most of it, and known before the entities that they change, and these before
it is worked out where they are. Another thread encodes and compresses them meanwhile, some thousand at a
time, so that the whole is never in memory but compressed. The outcome is what `dense.encode` makes of it.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import chain
from typing import Any, Final

from msgspec import structs

from semmap.nodes.kb_node.progress import split_batches
from semmap.nodes.kb_node.storage.encoding import dense
from semmap.schemas import codec
from semmap.schemas.commits import Commit
from semmap.schemas.entities import Entity

_MANY: Final = 1000
"""Triples; a thread for fewer takes longer than it saves."""
_PIECE: Final = 10_000
"""Elements of a list that are encoded together: some megabytes, and a few milliseconds."""
_FIELDS: Final = Commit.__struct_encode_fields__
_CHANGED: Final = ("changed",)
_OTHERS: Final = ("removed", "notes")
_EFFECTS: Final = (*_CHANGED, *_OTHERS)
"""The end of a commit."""
_BEGINNING: Final = _FIELDS[: -len(_EFFECTS)]


class EarlyBody:
    """The body of a commit of which only the effects are not known yet."""

    def __init__(self, commit: Commit) -> None:
        self._is_wanted = True
        self._deflate = zlib.compressobj(dense.DENSITY)
        self._beside = ThreadPoolExecutor(1)
        beginning = chain([_heading(_MAP, len(_FIELDS))], _encoded(commit, _BEGINNING))
        self._head = self._beside.submit(self._compressed, beginning)
        self._without = self._deflate
        """What has compressed no more than the head."""
        self._changed: Sequence[Entity] | None = None
        self._middle: Future[bytes]

    def expect(self, commit: Commit) -> None:
        """It is likely to change the entities that it has now."""
        self._changed = commit.changed
        self._middle = self._beside.submit(self._expected, _encoded(commit, _CHANGED))

    def finish(self, commit: Commit) -> Future[bytes]:
        """The whole, now that the effects are known."""
        whole = self._beside.submit(self._whole, commit)
        self._beside.shutdown(wait=False)
        return whole

    def give_up(self) -> None:
        """Nobody wants it any more."""
        self._is_wanted = False

    def _expected(self, changed: Iterator[bytes]) -> bytes:
        self._without = self._deflate.copy()
        return self._compressed(changed)

    def _whole(self, commit: Commit) -> bytes:
        if commit.changed is self._changed:
            begun = self._head.result() + self._middle.result()
            return begun + self._compressed(_encoded(commit, _OTHERS)) + self._deflate.flush()
        self._deflate = self._without
        return self._head.result() + self._compressed(_encoded(commit, _EFFECTS)) + self._deflate.flush()

    def _compressed(self, pieces: Iterator[bytes]) -> bytes:
        found = bytearray()
        for piece in pieces:
            if not self._is_wanted:
                break
            found += self._deflate.compress(piece)
        return bytes(found)


def early(commit: Commit, after: str) -> EarlyBody | None:
    """The beginning of the body of a commit whose triples are worth it; `after` is the digest before it."""
    if len(commit.inserted) + len(commit.retracted) < _MANY:
        return None
    return EarlyBody(structs.replace(commit, digest=after))


_MAP: Final = (0x80, 0xDE)
_ARRAY: Final = (0x90, 0xDC)
"""How MessagePack begins a short one, and a longer one; the longest has the code after that."""


def _heading(codes: tuple[int, int], count: int) -> bytes:
    """What stands before so many elements."""
    short, long = codes
    if count < 1 << 4:
        return bytes([short | count])
    size = 2 if count < 1 << 16 else 4
    return bytes([long + size // 4]) + count.to_bytes(size, "big")


def _encoded(commit: Commit, names: Sequence[str]) -> Iterator[bytes]:
    """These fields, each after its name; a long list comes in pieces."""
    for name in names:
        value: Any = getattr(commit, name)
        yield codec.encode(name)
        if not isinstance(value, tuple) or len(value) <= _PIECE:
            yield codec.encode(value)
            continue
        yield _heading(_ARRAY, len(value))
        for piece in split_batches(value, _PIECE, _nothing):
            yield codec.encode(piece)[len(_heading(_ARRAY, len(piece))) :]


def _nothing() -> None:
    pass
