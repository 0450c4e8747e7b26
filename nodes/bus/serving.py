"""Requests, answered either as queries or as puts that are acknowledged."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import zenoh
from msgspec import Struct, field

from nodes.bus.asking import Encoded
from nodes.bus.pubsub import publisher
from schemas import codec, errors, keys
from schemas.replies import Ack, Document

_JSON = "application/json"


def _send_nowhere(message: Any, ok: bool) -> None:
    """Of a request that nobody waits for an answer to."""


class Request(Struct, frozen=True):
    """A request as it came: from a query, or from a put that is answered on `semmap/ack`.

    `plain`: the reply may be a message that is `Encoded` already. `who` asks, by the key; whether that is
    proof is for those to say who serve `semmap/as/*/cmd`. `asker` tells askers apart: `who`, or the id of the
    session, or nothing of those who do not say. `source` is how Zenoh says that, to be passed on.
    """

    verb: str
    payload: bytes
    parameters: dict[str, str] = field(default_factory=dict)
    send: Callable[[Any, bool], None] = _send_nowhere
    plain: bool = False
    who: str = ""
    asker: str = ""
    source: Any = None

    def read(self, kind: Any) -> Any:
        """The message, of type `kind`. Raises BadRequest."""
        parameters = {k: v for k, v in self.parameters.items() if (k, v) != ("format", "json")}
        if self.payload:
            if parameters:
                raise errors.BadRequest("give the fields either in the message or as parameters, not both")
            return codec.decode(self.payload, kind)
        return codec.from_text(parameters, kind)

    def reply(self, message: Any) -> None:
        """Answer it."""
        self.send(message, True)

    def refuse(self, error: errors.SemmapError) -> None:
        """Answer it with an error."""
        self.send(errors.to_message(error), False)


def _request_of_query(prefix: str, query: zenoh.Query) -> Request:
    asked = str(query.key_expr)
    verb, who = keys.last_chunk(asked), keys.asked_as(asked) if prefix == keys.commands_as() else ""
    payload = query.payload.to_bytes() if query.payload is not None else b""
    parameters = dict(query.parameters)  # type: ignore[call-overload]
    as_json = "format" in parameters or codec.looks_like_json(payload)
    key = asked if who else f"{prefix}/{verb}" if "*" not in verb else prefix

    def send(message: Any, ok: bool) -> None:
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
            if ok:
                query.reply(key, content, encoding=encoding)
            else:
                query.reply_err(content, encoding=encoding)

    return Request(verb, payload, parameters, send, plain=not as_json, who=who, **_from(query, who))


def serve(
    session: zenoh.Session, prefix: str, receive: Callable[[Request], None], *, verb: str = "*"
) -> None:
    """Queries on `prefix/<verb>` go to `receive`, on a thread of Zenoh's, so it should only queue them.

    One that is not answered counts as not having come here: another who serves the key may answer it. Who
    serves a single verb is `complete` (Zenoh's word) for its key, so that it can be asked alone.
    """
    session.declare_queryable(
        f"{prefix}/{verb}", lambda query: receive(_request_of_query(prefix, query)), complete=verb != "*"
    )


def serve_puts(session: zenoh.Session, prefix: str, receive: Callable[[Request], None]) -> None:
    """Puts on `prefix` and `prefix/<verb>` go to `receive`; what is replied is published on `semmap/ack`."""
    acks = publisher(session, keys.ACK)

    def on_put(sample: zenoh.Sample) -> None:
        key, payload = str(sample.key_expr), sample.payload.to_bytes()
        said = _envelope(payload)
        verb = keys.last_chunk(key) if key != prefix else str(said.get("verb", ""))
        encode = codec.encode_json if codec.looks_like_json(payload) else codec.encode

        def send(message: Any, ok: bool) -> None:
            reply, error = (message, None) if ok else (None, message)
            acks.put(encode(Ack(id=str(said.get("id", "")), verb=verb, ok=ok, reply=reply, error=error)))

        receive(Request(verb, payload, {}, send, **_from(sample)))

    session.declare_subscriber(f"{prefix}/**", on_put)


def _from(message: zenoh.Query | zenoh.Sample, who: str = "") -> dict[str, Any]:
    """Who sent it: `who`, or the session, if that says so."""
    source = message.source_info
    return {"asker": who or ("" if source is None else str(source.source_id.zid)), "source": source}


def _envelope(payload: bytes) -> dict[str, Any]:
    """What can be read of a message before its type is known."""
    try:
        return dict(codec.decode(payload, dict[str, Any]))
    except errors.BadRequest:
        return {}
