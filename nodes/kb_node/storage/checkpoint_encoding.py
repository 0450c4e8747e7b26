"""A checkpoint as it stands in the journal: each term once, and triples as numbers of terms.

So a start makes each text once, in however many triples it is, and the map shares it. Triples and entities
are in frames that are compressed one by one, with a word of progress between them. What older versions wrote,
one message, is read as well.
"""

from __future__ import annotations

import sys
import zlib
from array import array
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import chain, islice
from typing import Final

from msgspec import Struct, msgpack

from nodes.kb_node.progress import parts
from nodes.runtime.shared_parts import SharedParts
from schemas import codec
from schemas.entities import Entity
from schemas.explanations import Triple

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


class Checkpoint(Struct, frozen=True, kw_only=True):
    """The ABox after commit `seq`: start-up replays only what came later."""

    seq: int
    triples: tuple[Triple, ...] = ()
    entities: tuple[Entity, ...] = ()
    read_by: bytes = b""
    """The format of the conclusions, the entities among them, that were drawn from the triples."""


_bodies = msgpack.Decoder(_Body)
_triples = msgpack.Decoder(_Triples)
_entities = msgpack.Decoder(list[Entity])


def encode(checkpoint: Checkpoint, progress: Callable[[], None] = lambda: None) -> bytes:
    """The body of a checkpoint. `progress` is called between frames."""
    with ThreadPoolExecutor(1) as beside:  # compresses a frame while the next one is made
        triples = [beside.submit(_dense, f) for f in _frames_of_triples(checkpoint.triples, progress)]
        entities = [
            beside.submit(_dense, msgpack.encode(part))
            for part in parts(checkpoint.entities, _ENTITIES, progress)
        ]
        body = _Body(
            seq=checkpoint.seq,
            read_by=checkpoint.read_by,
            triples=[frame.result() for frame in triples],
            entities=[frame.result() for frame in entities],
        )
    return _MARK + msgpack.encode(body)


def decode(body: bytes, progress: Callable[[], None] = lambda: None) -> Checkpoint:
    """What was encoded; equal terms are one object, and entities share what they have in common."""
    if not body.startswith(_MARK):
        return codec.decode(body, Checkpoint)
    stored = _bodies.decode(memoryview(body)[len(_MARK) :])
    triples: list[Triple] = []
    terms: list[str] = []
    for frame in _unpacked(stored.triples):
        progress()
        said = _triples.decode(frame)
        terms += said.new_terms
        each = map(terms.__getitem__, _numbers(said.numbers))
        triples += zip(each, each, each, strict=True)
    entities: list[Entity] = []
    shared = SharedParts()
    for frame in _unpacked(stored.entities):
        progress()
        entities += map(shared.entity, _entities.decode(frame))
    return Checkpoint(
        seq=stored.seq, triples=tuple(triples), entities=tuple(entities), read_by=stored.read_by
    )


def _frames_of_triples(triples: Iterable[Triple], progress: Callable[[], None]) -> Iterator[bytes]:
    known: dict[str, int] = {}
    number = known.setdefault
    for part in parts(triples, _TRIPLES, progress):
        before = len(known)
        numbers = array("I", [number(term, len(known)) for term in chain.from_iterable(part)])
        new_terms = list(islice(reversed(known), len(known) - before))[::-1]
        yield msgpack.encode(_Triples(new_terms, _in_order(numbers).tobytes()))


def _numbers(content: bytes) -> array[int]:
    numbers = array("I")
    numbers.frombytes(content)
    return _in_order(numbers)


def _in_order(numbers: array[int]) -> array[int]:
    assert numbers.itemsize == 4
    if sys.byteorder == "big":
        numbers.byteswap()
    return numbers


def _unpacked(frames: Sequence[bytes]) -> Iterator[bytes]:
    """Each frame as it was; the next one is unpacked while the last one is read."""
    with ThreadPoolExecutor(1) as beside:
        ahead = deque[Future[bytes]]()
        for frame in frames:
            ahead.append(beside.submit(zlib.decompress, frame))
            if len(ahead) > 1:
                yield ahead.popleft().result()
        while ahead:
            yield ahead.popleft().result()


def _dense(frame: bytes) -> bytes:
    return zlib.compress(frame, codec.DENSITY)
