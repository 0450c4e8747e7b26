"""A commit as it stands in the journal, made while the rest of it is worked out.

The triples of a large commit are most of it, and known before the entities that they change: another thread
encodes and compresses them meanwhile, some thousand at a time, so that the whole is never in memory but
compressed. The outcome is what `dense.encode` makes of the whole.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import chain
from typing import Any, Final

from msgspec import structs

from nodes.kb_node.progress import parts
from nodes.kb_node.storage.encoding import dense
from schemas import codec
from schemas.commits import Commit

_MANY: Final = 1000
"""Triples; a thread for fewer takes longer than it saves."""
_PIECE: Final = 10_000
"""Elements of a list that are encoded together: some megabytes, and a few milliseconds."""
_FIELDS: Final = Commit.__struct_encode_fields__
_EFFECTS: Final = ("changed", "removed", "notes")
"""The end of a commit."""
_BEGINNING: Final = _FIELDS[: -len(_EFFECTS)]
assert (*_BEGINNING, *_EFFECTS) == _FIELDS == Commit.__struct_fields__


class EarlyBody:
    """The body of a commit of which only the effects are not known yet."""

    def __init__(self, commit: Commit) -> None:
        self._is_wanted = True
        self._deflate = zlib.compressobj(dense.DENSITY)
        self._beside = ThreadPoolExecutor(1)
        beginning = chain([_heading(_MAP, len(_FIELDS))], _encoded(commit, _BEGINNING))
        self._head = self._beside.submit(self._compressed, beginning)

    def finish(self, commit: Commit) -> Future[bytes]:
        """The whole, now that the effects are known."""
        whole = self._beside.submit(self._whole, _encoded(commit, _EFFECTS))
        self._beside.shutdown(wait=False)
        return whole

    def give_up(self) -> None:
        """Nobody wants it any more."""
        self._is_wanted = False

    def _whole(self, effects: Iterator[bytes]) -> bytes:
        return self._head.result() + self._compressed(effects) + self._deflate.flush()

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
        for piece in parts(value, _PIECE, _nothing):
            yield codec.encode(piece)[len(_heading(_ARRAY, len(piece))) :]


def _nothing() -> None:
    pass
