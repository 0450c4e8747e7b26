"""Messages that are larger than one that Zenoh is to carry: they travel in pieces, and arrive as one.

A request goes as so many queries on its key, each answered before the next is sent; the answer to the last is
the answer. A reply comes as so many replies to its query. What belongs together is in the attachment.
"""

from __future__ import annotations

import threading
import time
import uuid
from collections.abc import Iterator
from typing import Annotated, Final

import zenoh
from msgspec import Meta, Struct

from semmap.schemas import codec, errors
from semmap.schemas.calls import DOCUMENT

FRAGMENT_BYTES: Final = 8 << 20
"""Bytes; what is larger is cut."""
MESSAGE_BYTES: Final = 16 << 20
"""Bytes of the largest message; a question of more is refused, and a publication ignored."""
PLANE_BYTES: Final = 64 << 20
"""Bytes that a session takes, for planes of cameras; what is larger is dropped on arrival, by Zenoh."""
PUBLICATION_BYTES: Final = MESSAGE_BYTES - (1 << 16)
"""Bytes of the largest publication, which is not cut: there is room for what goes with it."""
REQUEST_BYTES: Final = DOCUMENT
"""Bytes of the largest request, and of all that are put together or worked on at a time."""
_AT_A_TIME: Final = 16
_FRAGMENT_TIMEOUT_S: Final = 30.0
"""After so long without another piece, nobody waits for the rest."""
_AGAIN_S: Final = 1.0


class Fragment(Struct, frozen=True, array_like=True, forbid_unknown_fields=True):
    """Which piece it is: `number` (from 0) of `count`, of the message called `of`."""

    of: Annotated[str, Meta(min_length=1, max_length=64)]
    number: Annotated[int, Meta(ge=0)]
    count: Annotated[int, Meta(ge=2, le=1024)]

    @property
    def is_last(self) -> bool:
        """Is the message whole with this one?"""
        return self.number == self.count - 1


def split(payload: bytes | bytearray | zenoh.ZBytes) -> Iterator[tuple[bytes, Fragment]]:
    """The pieces of a payload, each with which it is."""
    content = payload.to_bytes() if isinstance(payload, zenoh.ZBytes) else payload
    name, count = uuid.uuid4().hex, -(-len(content) // FRAGMENT_BYTES)
    view = memoryview(content)
    for number in range(count):
        piece = Fragment(of=name, number=number, count=count)
        yield bytes(view[number * FRAGMENT_BYTES : (number + 1) * FRAGMENT_BYTES]), piece


def fragment_of(attachment: zenoh.ZBytes | None) -> Fragment | None:
    """Which piece a message is, if it is one. Raises BadRequest."""
    return None if attachment is None else codec.decode(attachment.to_bytes(), Fragment)


class ReplyAssembler:
    """A reply, piece by piece. They come in order."""

    def __init__(self) -> None:
        self._content = bytearray()
        self._next = 0

    def take(self, piece: Fragment, payload: zenoh.ZBytes) -> bytearray | None:
        """The whole, with its last piece. Raises InternalError for one that is not the next."""
        if piece.number != self._next or len(self._content) + len(payload) > 2 * REQUEST_BYTES:
            raise errors.InternalError("the pieces of a reply do not belong together")
        self._next += 1
        self._content += payload.to_bytes()
        return self._content if piece.is_last else None


class _Arriving:
    def __init__(self, largest: int) -> None:
        self.content = bytearray()
        self.largest = largest
        self.next = 0
        self.at_s = time.monotonic()


class RequestAssembler:
    """Requests that are put together, bounded in all. Any thread may use it."""

    def __init__(self, *, most: int = REQUEST_BYTES) -> None:
        """`most` bytes, of what is put together and what is not `done` with."""
        self._most = most
        self._arriving: dict[str, _Arriving] = {}
        self._bytes = 0
        self._lock = threading.Lock()

    def take(self, piece: Fragment, payload: bytes, largest: int) -> bytearray | None:
        """The whole, with its last piece; it counts until it is `done`.

        Raises BadRequest when it gets larger than `largest` bytes; Busy when too much is put together already
        or its beginning is not here any more, so that it has to be sent again.
        """
        with self._lock:
            self._drop_expired()
            if piece.number == 0:
                self._begin(piece, largest)
            arriving = self._arriving.get(piece.of)
            if arriving is None or arriving.next != piece.number:
                raise errors.Busy(
                    f"piece {piece.number + 1} of {piece.count} of a message came, and not the one before;"
                    " send it again from its beginning",
                    again_s=_AGAIN_S,
                )
            size = len(arriving.content) + len(payload)
            if size > arriving.largest:
                self._drop(piece.of)
                raise too_large(size, arriving.largest)
            if self._bytes + len(payload) > self._most:
                self._drop(piece.of)
                raise errors.Busy("too many large messages are coming in already", again_s=_AGAIN_S)
            arriving.content += payload
            arriving.next += 1
            arriving.at_s = time.monotonic()
            self._bytes += len(payload)
            return self._arriving.pop(piece.of).content if piece.is_last else None

    def done(self, size: int) -> None:
        """A whole one, of `size` bytes, has been answered."""
        with self._lock:
            self._bytes -= size

    def _begin(self, piece: Fragment, largest: int) -> None:
        self._drop(piece.of)
        if len(self._arriving) >= _AT_A_TIME:
            raise errors.Busy("too many large messages are coming in already", again_s=_AGAIN_S)
        self._arriving[piece.of] = _Arriving(largest)

    def _drop_expired(self) -> None:
        until_s = time.monotonic() - _FRAGMENT_TIMEOUT_S
        for name in [name for name, arriving in self._arriving.items() if arriving.at_s < until_s]:
            self._drop(name)

    def _drop(self, name: str) -> None:
        if (arriving := self._arriving.pop(name, None)) is not None:
            self._bytes -= len(arriving.content)


def too_large(size: int, largest: int) -> errors.BadRequest:
    """The error of a message of `size` bytes, or more, where `largest` is what it may have."""
    return errors.BadRequest(
        f"the message has {size / (1 << 20):,.1f} MB or more; one of this kind may have up to"
        f" {largest / (1 << 20):,g} MB"
    )
