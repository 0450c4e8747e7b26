"""Bodies on disk: MessagePack, compressed where that takes less time than to write it.

Messages are never compressed: what comes over the wire must not grow when it is read.
"""

from __future__ import annotations

import zlib
from typing import Any, Final

from semmap.schemas import codec
from semmap.schemas.errors import BadRequest

LARGEST: Final = 4 << 30
"""Bytes that a body may unfold to."""
COMPRESSION_LEVEL: Final = 1
"""How hard zlib tries: not very."""
_DENSE: Final = b"x"
"""How zlib's format begins, and no MessagePack map."""


def encode(message: Any, *, dense_from: int) -> bytes:
    """`message` as MessagePack, compressed (zlib) from `dense_from` bytes on; `decode` takes both."""
    body = codec.encode(message)
    return body if len(body) < dense_from else zlib.compress(body, COMPRESSION_LEVEL)


def decode(body: bytes, kind: Any) -> Any:
    """The message in `body`, of type `kind`. Raises BadRequest for one that is damaged."""
    return codec.decode(_unfolded(body) if body[:1] == _DENSE else body, kind)


def _unfolded(body: bytes) -> bytes:
    unfolding = zlib.decompressobj()
    try:
        content = unfolding.decompress(body, LARGEST)
    except zlib.error as error:
        raise BadRequest(f"{codec.MALFORMED}it is not valid MessagePack, JSON or zlib: {error}") from None
    if not unfolding.eof:
        reason = f"is larger than {LARGEST >> 20} MB" if unfolding.unconsumed_tail else "ends too early"
        raise BadRequest(f"{codec.MALFORMED}it {reason}")
    return content
