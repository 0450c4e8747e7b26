"""A checkpoint as it stands in the journal: each term once, and what is said in numbers of terms.

So a start makes each text once, in however many triples it is, and the map shares it. Where the reasoner has
columns, they are kept, and a start concludes nothing anew; else it is the triples. All is in frames that are
compressed one by one, with a word of progress between them. What older versions wrote is read as well.
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
from semmap.nodes.kb_node.storage.encoding import columns_encoding, dense
from semmap.nodes.kb_node.storage.encoding.columns_encoding import StoredColumns
from semmap.nodes.kb_node.storage.encoding.frames import Compressing, unpacked
from semmap.nodes.runtime.shared_parts import SharedParts
from semmap.schemas import codec, errors
from semmap.schemas.entities import Entity
from semmap.schemas.explanations import Triple

_MARK: Final = b"\xc1checkpoint 1"
"""How such a body begins; nothing in MessagePack begins with its first byte."""
_TRIPLES: Final = 100_000
_ENTITIES: Final = 10_000
"""In a frame."""


class _Triples(Struct, frozen=True, array_like=True):
    """A frame: the terms that were in none before, and subject, predicate, object, subject, ..."""

    new_terms: list[str]
    numbers: bytes
    """32 bits each, the lowest first."""


class _Body(Struct, frozen=True, array_like=True):
    seq: int
    read_by: bytes
    triples: list[bytes]
    entities: list[bytes]
    columns: StoredColumns | None = None


class _Whole(Struct, frozen=True, kw_only=True):
    """What older versions wrote."""

    seq: int
    triples: tuple[Triple, ...] = ()
    entities: tuple[Entity, ...] = ()
    read_by: bytes = b""


class Checkpoint(Struct, frozen=True, kw_only=True):
    """The ABox after commit `seq`: start-up replays only what came later."""

    seq: int
    triples: tuple[Triple, ...] = ()
    """Where there are columns, only what is asserted and set aside."""
    entities: tuple[Entity, ...] = ()
    read_by: bytes = b""
    """The format of the conclusions that were drawn from the triples: the entities, and the columns."""
    columns: Columns | None = None

    def said(self) -> Iterable[Triple]:
        """The triples, wherever they are; in columns some of the TBox are among them."""
        return self.triples if self.columns is None else chain(self.columns.triples(), self.triples)


_bodies = codec.decoder(_Body)
_triples = codec.decoder(_Triples)
_entities = codec.decoder(list[Entity])


def encode(checkpoint: Checkpoint, progress: Callable[[], None] = lambda: None) -> bytes:
    """The body of a checkpoint. `progress` is called between frames."""
    with Compressing() as beside:
        columns = None if checkpoint.columns is None else columns_encoding.store(checkpoint.columns, beside)
        triples = [beside.dense(frame) for frame in _frames_of_triples(checkpoint.triples, progress)]
        entities = [
            beside.dense(msgpack.encode(part))
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
    """What was encoded; equal terms are one object, and entities share what they have in common."""
    if not body.startswith(_MARK):
        old: _Whole = dense.decode(body, _Whole)
        return Checkpoint(seq=old.seq, triples=old.triples, entities=old.entities, read_by=old.read_by)
    stored = _bodies.decode(memoryview(body)[len(_MARK) :])
    triples: list[Triple] = []
    terms: list[str] = []
    for frame in unpacked(stored.triples):
        progress()
        said = _triples.decode(frame)
        terms += said.new_terms
        each = map(terms.__getitem__, _numbers(said.numbers))
        triples += zip(each, each, each, strict=True)
    entities: list[Entity] = []
    shared = SharedParts()
    for frame in unpacked(stored.entities):
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
        yield msgpack.encode(_Triples(new_terms, _in_order(numbers).tobytes()))


def _numbers(content: bytes) -> array[int]:
    numbers = array("I")
    numbers.frombytes(content)
    return _in_order(numbers)


def _in_order(numbers: array[int]) -> array[int]:
    if numbers.itemsize != 4:
        raise errors.InternalError("integers of this machine do not have 32 bits")
    if sys.byteorder == "big":
        numbers.byteswap()
    return numbers
