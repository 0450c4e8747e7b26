"""The content of files on its way: packed once, by who sends it, and unpacked where it is read.

Files that are packed already (`map.ttl.gz`) travel as they are.
"""

from __future__ import annotations

import zlib
from typing import Final

from semmap.schemas.errors import BadFile

PACKED_FROM: Final = 32 << 20
"""Bytes; smaller files travel as they are."""
LARGEST: Final = 1 << 30
"""Bytes that a file may have, packed or not: some millions of triples, and an end for what has none."""
_FREE: Final = 16 << 20
_AT_MOST: Final = 250
"""How many times larger than packed a file may be, beyond what is free; RDF is some 30 times."""
_MEMBERS: Final = 1000
"""Pieces that a packed file may have: gzip files may be put one after the other, and each takes its time."""
_MAGIC: Final = b"\x1f\x8b"
"""How gzip's format begins; no text does."""
_GZIP: Final = 31
"""zlib's word for that format."""


def packed(content: bytes) -> bytes:
    """The content of a file as a message carries it: with gzip if it is large."""
    if len(content) < PACKED_FROM or is_packed(content):
        return content
    return zlib.compress(content, 1, wbits=_GZIP)


def is_packed(content: bytes) -> bool:
    """Did it come packed?"""
    return content.startswith(_MAGIC)


def unpacked(content: bytes, filename: str) -> bytes:
    """The content of a file, whether it came packed or not. Raises BadFile for what cannot be unpacked."""
    members: list[bytes] = []
    size, rest = 0, content if is_packed(content) else b""
    largest = min(LARGEST, _FREE + _AT_MOST * len(content))
    try:
        while rest:
            if len(members) == _MEMBERS:
                raise BadFile(
                    f"{_called(filename)} is packed in more than {_MEMBERS:,} pieces; pack it as one"
                )
            member = zlib.decompressobj(wbits=_GZIP)
            members.append(member.decompress(rest, largest + 1 - size))
            size += len(members[-1])
            if size > largest:
                raise BadFile(f"{_called(filename)} is larger than {largest >> 20} MiB when it is unpacked")
            if not member.eof:
                raise BadFile(f"{_called(filename)} ends too early to be unpacked")
            rest = member.unused_data.lstrip(b"\0")
    except zlib.error as error:
        raise BadFile(f"{_called(filename)} cannot be unpacked: {error}") from None
    return b"".join(members) if members else content


def beginning(content: bytes, size: int, filename: str) -> bytes:
    """The first `size` bytes of what `unpacked` gives. Raises BadFile for what cannot be unpacked."""
    if not is_packed(content):
        return content[:size]
    try:
        return zlib.decompressobj(wbits=_GZIP).decompress(content, size)
    except zlib.error as error:
        raise BadFile(f"{_called(filename)} cannot be unpacked: {error}") from None


def _called(filename: str) -> str:
    return filename or "the file"
