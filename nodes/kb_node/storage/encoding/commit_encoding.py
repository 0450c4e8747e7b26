"""A commit as it stands in the journal, made while the rest of it is worked out.

The triples of a large commit are most of it, and known before the entities that they change: another thread
compresses them meanwhile. The outcome is what `dense.encode` makes of the whole, piece by piece.
"""

from __future__ import annotations

import zlib
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Final

from msgspec import Struct, structs

from nodes.kb_node.storage.encoding import dense
from schemas import codec
from schemas.commits import Commit, Departed
from schemas.entities import Entity

_MANY: Final = 1000
"""Triples; a thread for fewer takes longer than it saves."""


class _Effects(Struct):
    """The end of a commit."""

    changed: tuple[Entity, ...] = ()
    removed: tuple[Departed, ...] = ()
    notes: tuple[str, ...] = ()


_MAP_OF_FEW: Final = 1
"""Bytes before the first field."""


def _plain(part: Commit | _Effects) -> bytes:
    """Never compressed by itself, however large it is."""
    return codec.encode(part)


_NONE: Final = _plain(_Effects())[_MAP_OF_FEW:]


class EarlyBody:
    """The body of a commit of which only the effects are not known yet."""

    def __init__(self, commit: Commit) -> None:
        self._deflate = zlib.compressobj(dense.DENSITY)
        self._beside = ThreadPoolExecutor(1)
        whole = memoryview(_plain(structs.replace(commit, changed=(), removed=(), notes=())))
        assert whole[-len(_NONE) :] == _NONE
        self._head = self._beside.submit(self._deflate.compress, whole[: -len(_NONE)])

    def finish(self, commit: Commit) -> Future[bytes]:
        """The whole, now that the effects are known."""
        effects = _plain(_Effects(changed=commit.changed, removed=commit.removed, notes=commit.notes))[
            _MAP_OF_FEW:
        ]
        whole = self._beside.submit(self._whole, effects)
        self._beside.shutdown(wait=False)
        return whole

    def _whole(self, effects: bytes) -> bytes:
        return self._head.result() + self._deflate.compress(effects) + self._deflate.flush()


def early(commit: Commit, after: str) -> EarlyBody | None:
    """The beginning of the body of a commit whose triples are worth it; `after` is the digest before it."""
    if len(commit.inserted) + len(commit.retracted) < _MANY:
        return None
    return EarlyBody(structs.replace(commit, digest=after))
