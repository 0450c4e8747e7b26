"""A commit as it stands in the journal, made while the rest of it is worked out.

The triples of a large commit are most of it, and known before the entities that they change: another thread
compresses them meanwhile. The outcome is what `codec.encode` makes of the whole, piece by piece.
"""

from __future__ import annotations

import zlib
from concurrent.futures import Future
from threading import Thread
from typing import Final

from msgspec import Struct, structs

from schemas import codec
from schemas.commits import Commit, Departed
from schemas.entities import Entity

_MANY: Final = 1000
"""Triples; a thread for fewer takes longer than it saves."""


class _Effects(Struct):
    """The end of a commit."""

    changed: tuple[Entity, ...] = ()
    removed: tuple[Departed, ...] = ()


_MAP_OF_TWO: Final = 1
"""Bytes before the first field."""
_NONE: Final = codec.encode(_Effects())[_MAP_OF_TWO:]


class EarlyBody:
    """The body of a commit of which only the effects are not known yet."""

    def __init__(self, commit: Commit) -> None:
        self._deflate = zlib.compressobj(codec.DENSITY)
        self._head: Future[bytes] = Future()
        whole = memoryview(codec.encode(structs.replace(commit, changed=(), removed=())))
        assert whole[-len(_NONE) :] == _NONE
        Thread(target=self._compress, args=(whole[: -len(_NONE)],), daemon=True).start()

    def _compress(self, head: memoryview) -> None:
        self._head.set_result(self._deflate.compress(head))

    def finish(self, commit: Commit) -> bytes:
        """The whole, now that the effects are known."""
        effects = codec.encode(_Effects(changed=commit.changed, removed=commit.removed))[_MAP_OF_TWO:]
        return self._head.result() + self._deflate.compress(effects) + self._deflate.flush()


def early(commit: Commit) -> EarlyBody | None:
    """The beginning of the body of a commit whose triples are worth it."""
    return EarlyBody(commit) if len(commit.inserted) + len(commit.retracted) >= _MANY else None
