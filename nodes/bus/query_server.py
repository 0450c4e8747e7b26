"""Requests, received as queries or as puts; puts are acknowledged by a publication."""

from __future__ import annotations

import contextlib
import queue
import threading
from collections.abc import Callable
from functools import partial
from typing import Any

import zenoh
from msgspec import Struct, field

from semmap.nodes.bus import fragmentation
from semmap.nodes.bus.pubsub import publisher
from semmap.nodes.bus.query_client import Encoded
from semmap.schemas import codec, errors, keys
from semmap.schemas.calls import largest
from semmap.schemas.replies import Ack, Document, Done

_JSON = "application/json"
_ACKS = 20_000
"""Largest number of acknowledgements to publish; then puts are read only as these are sent."""
_LOOK_S = 0.5
"""Interval [s] of polling while waiting for room."""


def _send_nowhere(message: Any, ok: bool) -> None:
    """Discard the reply to a request without a client."""


class Request(Struct, frozen=True):
    """A request from a query, or from a put that is answered on `semmap/ack`.

    With `plain`, the reply may be `Encoded`. `who` is the client by the key; whether that is certified is
    decided by those who serve `semmap/as/*/cmd`. `source` is the session as reported by Zenoh, for
    forwarding. A put has no client that waits.
    """

    verb: str
    payload: bytes | bytearray
    parameters: dict[str, str] = field(default_factory=dict)
    send: Callable[[Any, bool], None] = _send_nowhere
    plain: bool = False
    who: str = ""
    source: Any = None
    is_put: bool = False

    @property
    def asker(self) -> str:
        """Identifies the client: `who`, the id of the session, or "" if it is unknown."""
        return self.who or self._instance

    @property
    def waits(self) -> str:
        """The id of the session that waits for the reply, or "" if none is known."""
        return "" if self.is_put else self._instance

    @property
    def _instance(self) -> str:
        return "" if self.source is None else str(self.source.source_id.zid)

    def read(self, kind: Any) -> Any:
        """Return the message, of type `kind`. Raises BadRequest."""
        if len(self.payload) > (most := largest(kind)):
            raise fragmentation.too_large(len(self.payload), most)
        parameters = {k: v for k, v in self.parameters.items() if (k, v) != ("format", "json")}
        if self.payload:
            if parameters:
                raise errors.BadRequest("fields must be either in the message or in the parameters, not both")
            return codec.decode(self.payload, kind)
        return codec.from_text(parameters, kind)

    def reply(self, message: Any) -> None:
        """Reply with a message."""
        self.send(message, True)

    def refuse(self, error: errors.SemmapError) -> None:
        """Reply with an error."""
        self.send(errors.to_message(error), False)


def _request_of_query(
    prefix: str, query: zenoh.Query, arrivals: fragmentation.RequestAssembler, most: Most
) -> Request | None:
    """Return the request; None for a fragment before the last. Raises the error to reply with."""
    asked = str(query.key_expr)
    verb, who = keys.last_chunk(asked), keys.asked_as(asked) if prefix == keys.commands_as() else ""
    sent = query.payload
    if sent is not None and len(sent) > fragmentation.MESSAGE_BYTES:
        raise fragmentation.too_large(len(sent), fragmentation.MESSAGE_BYTES)
    payload: bytes | bytearray = sent.to_bytes() if sent is not None else b""
    done = _nothing_to_do
    if (piece := fragmentation.fragment_of(query.attachment)) is not None:
        whole = arrivals.take(piece, bytes(payload), most(verb))
        if whole is None:
            return None
        payload, done = whole, partial(arrivals.done, len(whole))
    parameters = dict(query.parameters)  # type: ignore[call-overload]
    as_json = "format" in parameters or codec.looks_like_json(payload)
    key = _reply_key(prefix, asked, verb, who)

    def send(message: Any, ok: bool) -> None:
        done()
        content: Any
        encoding: Any
        if isinstance(message, Encoded):
            content, encoding = message.payload, message.encoding
        elif as_json and isinstance(message, Document):
            content, encoding = message.content, message.media_type
        elif as_json:
            content, encoding = codec.encode_json(message), _JSON
        else:
            content, encoding = codec.encode(message), codec.encoding_of(message)
        with query:
            if not ok:
                query.reply_err(content, encoding=encoding)
            elif len(content) <= fragmentation.FRAGMENT_BYTES:
                query.reply(key, content, encoding=encoding)
            elif as_json:
                _refuse(query, _too_long(len(content)), as_json=True)
            else:
                for part, which in fragmentation.split(content):
                    query.reply(key, part, encoding=encoding, attachment=codec.encode(which))

    return Request(verb, payload, parameters, send, plain=not as_json, who=who, source=query.source_info)


def _nothing_to_do() -> None:
    """Do nothing: a message in one part needs no release."""


def _reply_key(prefix: str, asked: str, verb: str, who: str) -> str:
    return asked if who else f"{prefix}/{verb}" if "*" not in verb else prefix


def _too_long(size: int) -> errors.Refused:
    return errors.Refused(
        f"the reply has {size >> 20:,} MB; the limit for JSON is {fragmentation.FRAGMENT_BYTES >> 20} MB;"
        " request less, or use semmap's client, which receives fragments"
    )


def _refuse(query: zenoh.Query, error: errors.SemmapError, *, as_json: bool) -> None:
    message = errors.to_message(error)
    if as_json:
        query.reply_err(codec.encode_json(message), encoding=_JSON)
    else:
        query.reply_err(codec.encode(message), encoding=codec.encoding_of(message))


Most = Callable[[str], int]
"""Returns the largest size of a request of a command [bytes]."""


def _request_limit(_: str) -> int:
    return fragmentation.REQUEST_BYTES


def serve(
    session: zenoh.Session,
    prefix: str,
    receive: Callable[[Request], None],
    *,
    verb: str = "*",
    most: Most = _request_limit,
) -> None:
    """Pass queries on `prefix/<verb>` to `receive`, on a thread of Zenoh, so it must only queue them.

    A query without a reply counts as not received, so another queryable of the key may answer it. A queryable
    of a single verb is `complete` (Zenoh's term) for its key, so it can be queried alone. A fragmented
    request may have `most(verb)` bytes.
    """
    arrivals = fragmentation.RequestAssembler()

    def on_query(query: zenoh.Query) -> None:
        try:
            request = _request_of_query(prefix, query, arrivals, most)
        except Exception as error:  # otherwise the query would never be answered
            with query:
                _refuse(query, _as_ours(error), as_json=False)
            return
        if request is not None:
            receive(request)
            return
        asked = str(query.key_expr)
        with query:
            query.reply(asked, codec.encode(_TAKEN), encoding=codec.encoding_of(_TAKEN))

    session.declare_queryable(f"{prefix}/{verb}", on_query, complete=verb != "*")


_TAKEN = Done(text="go on")
"""The reply to a fragment before the last."""


def _as_ours(error: Exception) -> errors.SemmapError:
    if isinstance(error, errors.SemmapError):
        return error
    return errors.BadRequest(f"the request cannot be read: {type(error).__name__}: {error}")


def serve_puts(session: zenoh.Session, prefix: str, receive: Callable[[Request], None]) -> None:
    """Pass puts on `prefix` and `prefix/<verb>` to `receive`; replies are published on `semmap/ack`."""
    acks = _Acks(session)

    def on_put(sample: zenoh.Sample) -> None:
        acks.wait_for_room()
        key, payload = str(sample.key_expr), sample.payload.to_bytes()
        envelope = _envelope(payload)
        verb = keys.last_chunk(key) if key != prefix else str(envelope.verb)
        encode = codec.encode_json if codec.looks_like_json(payload) else codec.encode

        def send(message: Any, ok: bool) -> None:
            reply, error = (message, None) if ok else (None, message)
            ack = encode(Ack(id=str(envelope.id), verb=verb, ok=ok, reply=reply, error=error))
            if len(ack) > fragmentation.FRAGMENT_BYTES:
                long = errors.to_message(_too_long(len(ack)))
                ack = encode(Ack(id=str(envelope.id), verb=verb, ok=False, reply=None, error=long))
            acks.put(ack)

        if len(payload) > fragmentation.MESSAGE_BYTES:
            send(errors.to_message(fragmentation.too_large(len(payload), fragmentation.MESSAGE_BYTES)), False)
            return
        receive(Request(verb, payload, {}, send, source=sample.source_info, is_put=True))

    session.declare_subscriber(f"{prefix}/**", zenoh.handlers.Callback(on_put, acks.end))


class _Acks:
    """Publishes acknowledgements in order, on a thread of its own.

    A slow subscriber delays this thread and, once `_ACKS` of them wait, the incoming puts. It never delays
    the thread that owns a node's state.
    """

    def __init__(self, session: zenoh.Session) -> None:
        self._publisher = publisher(session, keys.ACK)
        self._waiting: queue.SimpleQueue[bytes | None] = queue.SimpleQueue()
        self._has_room = threading.Event()
        self._has_room.set()
        self._has_ended = False
        threading.Thread(target=self._publish, name="acks", daemon=True).start()

    def put(self, ack: bytes) -> None:
        """Publish an acknowledgement soon. Any thread may call this; it never waits."""
        if self._has_ended:
            return
        self._waiting.put(ack)
        if self._waiting.qsize() >= _ACKS:
            self._has_room.clear()

    def wait_for_room(self) -> None:
        """Return when fewer than half of `_ACKS` wait, or none will be published any more.

        It also polls: the queue may have drained between the two lines of `put` that find it full and clear
        the event, and then no other thread would set it.
        """
        while not self._has_room.wait(_LOOK_S):
            if self._has_ended or self._waiting.qsize() < _ACKS // 2:
                self._has_room.set()

    def end(self) -> None:
        """Stop after the waiting acknowledgements."""
        self._waiting.put(None)

    def _publish(self) -> None:
        try:
            while (ack := self._waiting.get()) is not None:
                if self._waiting.qsize() < _ACKS // 2:
                    self._has_room.set()
                with contextlib.suppress(zenoh.ZError):  # the session is closed; the rest is dropped
                    self._publisher.put(ack)
        finally:
            self._has_ended = True
            self._has_room.set()


class _Envelope(Struct):
    """The fields of a message that are read before its type is known."""

    verb: str | int | float | bool | None = ""
    id: str | int | float | bool | None = ""


def _envelope(payload: bytes) -> _Envelope:
    try:
        envelope: _Envelope = codec.decode(payload, _Envelope)
        return envelope
    except errors.BadRequest:
        return _Envelope()
