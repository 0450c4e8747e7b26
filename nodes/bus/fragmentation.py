"""Fragmentation of messages that are larger than one Zenoh message may be.

A request is sent as several queries on its key, each answered before the next is sent; the reply to the last
query is the result. A reply is sent as several replies to its query. The attachment identifies the fragments.
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
"""Bytes; a larger message is split."""
MESSAGE_BYTES: Final = 16 << 20
"""Bytes of the largest message; a larger query is rejected, and a larger publication is ignored."""
PLANE_BYTES: Final = 64 << 20
"""Largest message that a session receives [bytes], for camera planes; Zenoh drops larger ones."""
PUBLICATION_BYTES: Final = MESSAGE_BYTES - (1 << 16)
"""Bytes of the largest publication, which is not split; leaves room for its metadata."""
REQUEST_BYTES: Final = DOCUMENT
"""Bytes of the largest request, and of all requests in assembly or in progress."""
_AT_A_TIME: Final = 16
_FRAGMENT_TIMEOUT_S: Final = 30.0
"""After this time without another fragment, a message is dropped."""
_AGAIN_S: Final = 1.0


class Fragment(Struct, frozen=True, array_like=True, forbid_unknown_fields=True):
    """The position of a fragment: `number` (from 0) of `count`, of the message `of`."""

    of: Annotated[str, Meta(min_length=1, max_length=64)]
    number: Annotated[int, Meta(ge=0)]
    count: Annotated[int, Meta(ge=2, le=1024)]

    @property
    def is_last(self) -> bool:
        """Whether the message is complete with this fragment."""
        return self.number == self.count - 1


def split(payload: bytes | bytearray | zenoh.ZBytes) -> Iterator[tuple[bytes, Fragment]]:
    """Yield the fragments of a payload, each with its position."""
    content = payload.to_bytes() if isinstance(payload, zenoh.ZBytes) else payload
    name, count = uuid.uuid4().hex, -(-len(content) // FRAGMENT_BYTES)
    view = memoryview(content)
    for number in range(count):
        fragment = Fragment(of=name, number=number, count=count)
        yield bytes(view[number * FRAGMENT_BYTES : (number + 1) * FRAGMENT_BYTES]), fragment


def fragment_of(attachment: zenoh.ZBytes | None) -> Fragment | None:
    """Return the position of a fragment; None for a whole message. Raises BadRequest."""
    return None if attachment is None else codec.decode(attachment.to_bytes(), Fragment)


class ReplyAssembler:
    """Assembles a reply from fragments, which arrive in order."""

    def __init__(self) -> None:
        self._content = bytearray()
        self._next = 0

    def take(self, fragment: Fragment, payload: zenoh.ZBytes) -> bytearray | None:
        """Add a fragment; return the message with the last one. Raises InternalError out of order."""
        if fragment.number != self._next or len(self._content) + len(payload) > 2 * REQUEST_BYTES:
            raise errors.InternalError("fragments of a reply arrived out of order")
        self._next += 1
        self._content += payload.to_bytes()
        return self._content if fragment.is_last else None


class _Arriving:
    def __init__(self, largest: int) -> None:
        self.content = bytearray()
        self.largest = largest
        self.next = 0
        self.at_s = time.monotonic()


class RequestAssembler:
    """Assembles requests from fragments, with a limit for all of them. Any thread may use it."""

    def __init__(self, *, most: int = REQUEST_BYTES) -> None:
        """`most` is the limit in bytes for requests in assembly and those that are not `done`."""
        self._most = most
        self._arriving: dict[str, _Arriving] = {}
        self._bytes = 0
        self._lock = threading.Lock()

    def take(self, fragment: Fragment, payload: bytes, largest: int) -> bytearray | None:
        """Add a fragment; return the request with the last one. It counts until `done` is called.

        Raises BadRequest if it exceeds `largest` bytes. Raises Busy if too many bytes are in assembly, or if
        an earlier fragment is missing and the request has to be sent again.
        """
        with self._lock:
            self._drop_expired()
            if fragment.number == 0:
                self._begin(fragment, largest)
            arriving = self._arriving.get(fragment.of)
            if arriving is None or arriving.next != fragment.number:
                raise errors.Busy(
                    f"fragment {fragment.number + 1} of {fragment.count} of a message arrived without the one"
                    " before; send the message again",
                    again_s=_AGAIN_S,
                )
            size = len(arriving.content) + len(payload)
            if size > arriving.largest:
                self._drop(fragment.of)
                raise too_large(size, arriving.largest)
            if self._bytes + len(payload) > self._most:
                self._drop(fragment.of)
                raise errors.Busy("too many large messages are being received", again_s=_AGAIN_S)
            arriving.content += payload
            arriving.next += 1
            arriving.at_s = time.monotonic()
            self._bytes += len(payload)
            return self._arriving.pop(fragment.of).content if fragment.is_last else None

    def done(self, size: int) -> None:
        """Release a request of `size` bytes that has been answered."""
        with self._lock:
            self._bytes -= size

    def _begin(self, fragment: Fragment, largest: int) -> None:
        self._drop(fragment.of)
        if len(self._arriving) >= _AT_A_TIME:
            raise errors.Busy("too many large messages are being received", again_s=_AGAIN_S)
        self._arriving[fragment.of] = _Arriving(largest)

    def _drop_expired(self) -> None:
        until_s = time.monotonic() - _FRAGMENT_TIMEOUT_S
        for name in [name for name, arriving in self._arriving.items() if arriving.at_s < until_s]:
            self._drop(name)

    def _drop(self, name: str) -> None:
        if (arriving := self._arriving.pop(name, None)) is not None:
            self._bytes -= len(arriving.content)


def too_large(size: int, largest: int) -> errors.BadRequest:
    """Return the error for a message of `size` bytes or more, if `largest` is the limit."""
    return errors.BadRequest(
        f"the message has {size / (1 << 20):,.1f} MB or more; one of this kind may have up to"
        f" {largest / (1 << 20):,g} MB"
    )
