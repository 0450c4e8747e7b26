"""Compression of files in messages: compressed by the sender, decompressed where they are parsed.

Compressed files (`map.ttl.gz`) are sent unchanged.
"""

from __future__ import annotations

import zlib
from typing import Final

from semmap.schemas.errors import BadFile

PACKED_FROM: Final = 32 << 20
"""The size from which files are compressed [bytes]."""
LARGEST: Final = 1 << 30
"""The maximum size of a file, compressed or not [bytes]: some millions of triples."""
_FREE: Final = 16 << 20
_AT_MOST: Final = 250
"""The maximum compression ratio of files larger than `_FREE`; RDF has a ratio of about 30."""
_MEMBERS: Final = 1000
"""The maximum number of members of a gzip file, as each one takes time."""
_MAGIC: Final = b"\x1f\x8b"
"""The first bytes of the gzip format, which no text begins with."""
_GZIP: Final = 31
"""zlib's window size argument for the gzip format."""


def packed(content: bytes) -> bytes:
    """Return the content of a file for a message, compressed with gzip if it is large."""
    if len(content) < PACKED_FROM or is_packed(content):
        return content
    return zlib.compress(content, 1, wbits=_GZIP)


def is_packed(content: bytes) -> bool:
    """Return whether the content is compressed."""
    return content.startswith(_MAGIC)


def unpacked(content: bytes, filename: str) -> bytes:
    """Return the decompressed content of a file. Raises BadFile if it cannot be decompressed."""
    members: list[bytes] = []
    size, rest = 0, content if is_packed(content) else b""
    largest = min(LARGEST, _FREE + _AT_MOST * len(content))
    try:
        while rest:
            if len(members) == _MEMBERS:
                raise BadFile(f"{_called(filename)}: more than {_MEMBERS:,} gzip members; compress it as one")
            member = zlib.decompressobj(wbits=_GZIP)
            members.append(member.decompress(rest, largest + 1 - size))
            size += len(members[-1])
            if size > largest:
                raise BadFile(f"{_called(filename)}: decompressed size exceeds {largest >> 20} MiB")
            if not member.eof:
                raise BadFile(f"{_called(filename)}: the gzip data is truncated")
            rest = member.unused_data.lstrip(b"\0")
    except zlib.error as error:
        raise BadFile(f"{_called(filename)}: cannot decompress: {error}") from None
    return b"".join(members) if members else content


def beginning(content: bytes, size: int, filename: str) -> bytes:
    """Return the first `size` bytes of the decompressed content. Raises BadFile if that fails."""
    if not is_packed(content):
        return content[:size]
    try:
        return zlib.decompressobj(wbits=_GZIP).decompress(content, size)
    except zlib.error as error:
        raise BadFile(f"{_called(filename)}: cannot decompress: {error}") from None


def _called(filename: str) -> str:
    return filename or "the file"
