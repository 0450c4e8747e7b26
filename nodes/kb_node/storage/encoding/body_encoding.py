"""The encoding of bodies on disk: MessagePack, compressed if that takes less time than writing it.

Messages over the network are never compressed, so that they cannot grow when they are read.
"""

from __future__ import annotations

import zlib
from collections.abc import Collection, Iterator
from typing import Any, Final

from semmap.schemas import codec
from semmap.schemas.errors import BadRequest

LARGEST: Final = 4 << 30
"""The greatest size of a decompressed body [bytes]."""
COMPRESSION_LEVEL: Final = 1
"""The fastest level of zlib."""
_PIECE: Final = 1 << 20
"""The size of the pieces in which a compressed body is searched [bytes]."""
_DENSE: Final = b"x"
"""The first byte of zlib data, with which no MessagePack map starts."""


def encode(message: Any, *, compressed_from: int) -> bytes:
    """Return `message` as MessagePack, compressed (zlib) from `compressed_from` bytes on."""
    body = codec.encode(message)
    return body if len(body) < compressed_from else zlib.compress(body, COMPRESSION_LEVEL)


def decode(body: bytes, kind: Any) -> Any:
    """Return the message of type `kind` in `body`. Raises BadRequest if it is damaged."""
    return codec.decode(_decompress(body) if body[:1] == _DENSE else body, kind)


def find_contained(body: bytes, patterns: Collection[bytes]) -> set[bytes]:
    """Return those of the patterns that occur in the MessagePack of `body`, without decoding it.

    Raises BadRequest if it is damaged.
    """
    if body[:1] != _DENSE:
        return {pattern for pattern in patterns if pattern in body}
    found: set[bytes] = set()
    overlap = max(map(len, patterns), default=1)
    end = b""
    for piece in _decompressed_pieces(body):
        piece = end + piece
        found.update(pattern for pattern in patterns if pattern in piece)
        end = piece[-overlap:]
    return found


def _decompressed_pieces(body: bytes) -> Iterator[bytes]:
    decompressor = zlib.decompressobj()
    rest = body
    while rest and not decompressor.eof:
        try:
            yield decompressor.decompress(rest, _PIECE)
        except zlib.error as error:
            raise _damage(error) from None
        rest = decompressor.unconsumed_tail


def _decompress(body: bytes) -> bytes:
    decompressor = zlib.decompressobj()
    try:
        content = decompressor.decompress(body, LARGEST)
    except zlib.error as error:
        raise _damage(error) from None
    if not decompressor.eof:
        reason = f"is larger than {LARGEST >> 20} MB" if decompressor.unconsumed_tail else "ends too early"
        raise BadRequest(f"{codec.MALFORMED}it {reason}")
    return content


def _damage(error: zlib.error) -> BadRequest:
    return BadRequest(f"{codec.MALFORMED}it is not valid MessagePack, JSON or zlib: {error}")
