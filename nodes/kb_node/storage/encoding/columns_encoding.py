"""The encoding of the reasoner's columns in a checkpoint: strings and numbers in compressed frames."""

from __future__ import annotations

import sys
from array import array
from collections.abc import Callable, Iterable, Iterator
from typing import Final

from msgspec import Struct, msgpack

from semmap.nodes.kb_node.reasoner.abox.columns import Claimed, Columns, KindSaid
from semmap.nodes.kb_node.storage.encoding.frames import FrameCompressor, decompress_frames
from semmap.schemas import codec, errors

_TERMS: Final = 100_000
_NUMBERS: Final = 1 << 20
"""Items in a frame."""


class _Head(Struct, frozen=True, array_like=True):
    """The short parts."""

    schema: bytes
    size: int
    classes: list[str]
    properties: list[str]
    kinds: list[KindSaid]
    reasons: list[tuple[int, list[Claimed]]]


class StoredColumns(Struct, frozen=True, array_like=True):
    """Columns in frames."""

    head: bytes
    terms: list[bytes]
    source: bytes
    numbers: list[list[bytes]]
    """By frame: numbers of nodes and edges, and the links of outgoing and incoming edges."""


_heads = codec.decoder(_Head)
_terms = codec.decoder(list[str])


def store(columns: Columns, compressor: FrameCompressor) -> Callable[[], StoredColumns]:
    """Start to compress columns, and return a function that waits for the result."""
    head = _Head(
        columns.schema, columns.size, columns.classes, columns.properties, columns.kinds, columns.reasons
    )
    packed_head, source = compressor.compress(msgpack.encode(head)), compressor.compress(columns.source)
    terms = [
        compressor.compress(msgpack.encode(columns.terms[start : start + _TERMS]))
        for start in range(0, len(columns.terms), _TERMS)
    ]
    numbers = [[compressor.compress(frame) for frame in _frames(column)] for column in _columns(columns)]
    return lambda: StoredColumns(
        packed_head.result(),
        [frame.result() for frame in terms],
        source.result(),
        [[frame.result() for frame in column] for column in numbers],
    )


def restore(stored: StoredColumns, progress: Callable[[], None]) -> Columns:
    """Return the columns. `progress` is called between frames."""
    (head,) = map(_heads.decode, decompress_frames([stored.head]))
    (source,) = decompress_frames([stored.source])
    terms: list[str] = []
    for frame in decompress_frames(stored.terms):
        progress()
        terms += _terms.decode(frame)
    columns: list[array[int]] = []
    for frames in stored.numbers:
        column = array("i")
        for frame in decompress_frames(frames):
            progress()
            column.frombytes(frame)
        columns.append(_to_little_endian(column))
    kind, places, subject, predicate, object_, *links = columns
    return Columns(
        schema=head.schema,
        size=head.size,
        classes=head.classes,
        properties=head.properties,
        kinds=head.kinds,
        reasons=head.reasons,
        terms=terms,
        kind=kind,
        places=places,
        subject=subject,
        predicate=predicate,
        object=object_,
        source=source,
        out=tuple(links[:4]),
        into=tuple(links[4:]),
    )


def _columns(columns: Columns) -> Iterable[array[int]]:
    yield from (columns.kind, columns.places, columns.subject, columns.predicate, columns.object)
    yield from columns.out
    yield from columns.into


def _frames(column: array[int]) -> Iterator[bytes]:
    for start in range(0, len(column), _NUMBERS):
        yield _to_little_endian(column[start : start + _NUMBERS]).tobytes()


def _to_little_endian(numbers: array[int]) -> array[int]:
    """Convert to 32 bits, little-endian. The given column must not be used afterwards."""
    if numbers.itemsize != 4:
        raise errors.InternalError("integers of this machine do not have 32 bits")
    if sys.byteorder == "big":
        numbers.byteswap()
    return numbers
