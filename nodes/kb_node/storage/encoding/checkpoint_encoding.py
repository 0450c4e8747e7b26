"""The encoding of a checkpoint: each term once, and triples as numbers of terms.

Thus a start creates each string once, and the map shares it. If the reasoner has columns, they are stored,
and a start infers nothing again. Otherwise the triples are stored. The content consists of frames that are
compressed one by one, with progress reports between them. Checkpoints of older versions can be read.
"""

from __future__ import annotations

import sys
from array import array
from collections.abc import Callable, Iterable, Iterator
from itertools import chain, islice
from typing import Final

from msgspec import Struct, msgpack

from semmap.nodes.kb_node.progress import split_batches
from semmap.nodes.kb_node.reasoner.abox.columns import Columns
from semmap.nodes.kb_node.storage.encoding import body_encoding, columns_encoding
from semmap.nodes.kb_node.storage.encoding.columns_encoding import StoredColumns
from semmap.nodes.kb_node.storage.encoding.frames import FrameCompressor, decompress_frames
from semmap.nodes.runtime.interning import EntityInterner
from semmap.schemas import codec, errors
from semmap.schemas.entities import Entity
from semmap.schemas.explanations import Triple

_MARK: Final = b"\xc1checkpoint 1"
"""The start of such a body, whose first byte does not occur in MessagePack."""
_TRIPLES: Final = 100_000
_ENTITIES: Final = 10_000
"""Items in a frame."""


class _Triples(Struct, frozen=True, array_like=True):
    """A frame: its new terms, and subject, predicate, object, subject, ... as numbers."""

    new_terms: list[str]
    numbers: bytes
    """32 bits each, little-endian."""


class _Body(Struct, frozen=True, array_like=True):
    seq: int
    read_by: bytes
    triples: list[bytes]
    entities: list[bytes]
    columns: StoredColumns | None = None


class _Whole(Struct, frozen=True, kw_only=True):
    """The format of older versions."""

    seq: int
    triples: tuple[Triple, ...] = ()
    entities: tuple[Entity, ...] = ()
    read_by: bytes = b""


class Checkpoint(Struct, frozen=True, kw_only=True):
    """The ABox after commit `seq`. A start replays only later commits."""

    seq: int
    triples: tuple[Triple, ...] = ()
    """With columns, only suppressed asserted facts."""
    entities: tuple[Entity, ...] = ()
    read_by: bytes = b""
    """The format of the inferences from the triples: the entities and the columns."""
    columns: Columns | None = None

    def all_triples(self) -> Iterable[Triple]:
        """Return all triples. With columns they include some of the TBox."""
        return self.triples if self.columns is None else chain(self.columns.triples(), self.triples)


_bodies = codec.decoder(_Body)
_triples = codec.decoder(_Triples)
_entities = codec.decoder(list[Entity])


def encode(checkpoint: Checkpoint, progress: Callable[[], None] = lambda: None) -> bytes:
    """Return the body of a checkpoint. `progress` is called between frames."""
    with FrameCompressor() as compressor:
        columns = (
            None if checkpoint.columns is None else columns_encoding.store(checkpoint.columns, compressor)
        )
        triples = [compressor.compress(frame) for frame in _frames_of_triples(checkpoint.triples, progress)]
        entities = [
            compressor.compress(msgpack.encode(part))
            for part in split_batches(checkpoint.entities, _ENTITIES, progress)
        ]
        body = _Body(
            seq=checkpoint.seq,
            read_by=checkpoint.read_by,
            triples=[frame.result() for frame in triples],
            entities=[frame.result() for frame in entities],
            columns=None if columns is None else columns(),
        )
    return _MARK + msgpack.encode(body)


def decode(body: bytes, progress: Callable[[], None] = lambda: None) -> Checkpoint:
    """Return the checkpoint. Equal terms are one object, and entities share equal parts."""
    if not body.startswith(_MARK):
        old: _Whole = body_encoding.decode(body, _Whole)
        return Checkpoint(seq=old.seq, triples=old.triples, entities=old.entities, read_by=old.read_by)
    stored = _bodies.decode(memoryview(body)[len(_MARK) :])
    triples: list[Triple] = []
    terms: list[str] = []
    for frame in decompress_frames(stored.triples):
        progress()
        frame_content = _triples.decode(frame)
        terms += frame_content.new_terms
        each = map(terms.__getitem__, _numbers(frame_content.numbers))
        triples += zip(each, each, each, strict=True)
    entities: list[Entity] = []
    shared = EntityInterner()
    for frame in decompress_frames(stored.entities):
        progress()
        entities += map(shared.entity, _entities.decode(frame))
    return Checkpoint(
        seq=stored.seq,
        triples=tuple(triples),
        entities=tuple(entities),
        read_by=stored.read_by,
        columns=None if stored.columns is None else columns_encoding.restore(stored.columns, progress),
    )


def _frames_of_triples(triples: Iterable[Triple], progress: Callable[[], None]) -> Iterator[bytes]:
    known: dict[str, int] = {}
    number = known.setdefault
    for part in split_batches(triples, _TRIPLES, progress):
        before = len(known)
        numbers = array("I", [number(term, len(known)) for term in chain.from_iterable(part)])
        new_terms = list(islice(reversed(known), len(known) - before))[::-1]
        yield msgpack.encode(_Triples(new_terms, _to_little_endian(numbers).tobytes()))


def _numbers(content: bytes) -> array[int]:
    numbers = array("I")
    numbers.frombytes(content)
    return _to_little_endian(numbers)


def _to_little_endian(numbers: array[int]) -> array[int]:
    if numbers.itemsize != 4:
        raise errors.InternalError("integers of this machine do not have 32 bits")
    if sys.byteorder == "big":
        numbers.byteswap()
    return numbers
