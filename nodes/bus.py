"""The only code that knows Zenoh: open a session, ask, serve, publish, follow.

What was learnt by measuring (Zenoh 1.10.2): a session that has a Python callback keeps the process from
exiting until it is closed, so sessions are context managers; a `get` that finds nobody comes back empty
at once, so an empty answer is asked again until patience ends, and never read as an answer; a time-out
comes as an error reply that is not ours. The callback of a `get` is given a thread of its own unless it is
declared direct, which takes longer than the whole round trip; and replies wait for the end of the query
unless they need not be consolidated.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, Literal, NoReturn

import zenoh
from zenoh import ext

from schemas import codec, errors, keys
from schemas.replies import Ack, Document
from schemas.scenes import CameraFrame

DEFAULT_ENDPOINT = "tcp/127.0.0.1:7447"
PATIENCE_S = 3.0
RESTART_S = 30.0
"""Seconds: as long as a node takes to be back after a kill, on a busy machine and with a large map."""
TIMEOUT_S = 30.0

_ERROR_ENCODING = "application/msgpack;semmap.ErrorMessage.v1"
_JSON = "application/json"
_NOT_REACHED = ("Unable to connect", "Can not create a new", "deadline has elapsed")
_AS_THEY_COME = zenoh.ConsolidationMode.NONE


@dataclass(frozen=True)
class Encoded:
    """A message as it came: to be decoded, or passed on."""

    payload: zenoh.ZBytes
    encoding: zenoh.Encoding
    kind: Any

    def decode(self) -> Any:
        """The message, of type `kind`. Raises BadRequest."""
        return codec.decode(self.payload.to_bytes(), self.kind)


@dataclass(frozen=True)
class Network:
    """How a process joins the system: a node listens, a client does not.

    A "peer" reaches each node by itself, a "client" all of them by the one that it connects to. `namespace`
    prefixes every key (one robot of many).

    A client whose connection is refused tries again for `patience_s`; 0 is once.
    """

    connect: tuple[str, ...] = (DEFAULT_ENDPOINT,)
    listen: tuple[str, ...] = ()
    mode: str = "client"
    namespace: str = ""
    patience_s: float = PATIENCE_S

    def as_config(self) -> zenoh.Config:
        """Scouting and shared memory off; a node goes on trying to connect, a client gives up."""
        node = bool(self.listen)
        retry = {"period_init_ms": 100, "period_max_ms": 500, "period_increase_factor": 2}
        values: dict[str, Any] = {
            "mode": self.mode,
            "connect/endpoints": list(self.connect),
            "connect/timeout_ms": -1 if node else int(self.patience_s * 1000),
            "connect/exit_on_failure": not node,
            "connect/retry": retry,
            "listen/endpoints": list(self.listen),
            "scouting/multicast/enabled": False,
            "transport/shared_memory/enabled": False,
            "transport/link/tx/lease": 2000,
            "transport/unicast/open_timeout": int(PATIENCE_S * 1000),
        }
        if self.namespace:
            values["namespace"] = self.namespace
        config = zenoh.Config()
        for key, value in values.items():
            config.insert_json5(key, json.dumps(value))
        return config


@contextmanager
def open_session(network: Network) -> Iterator[zenoh.Session]:
    """A session that is closed whatever happens. Raises NoAnswer or BadRequest (a malformed endpoint)."""
    try:
        session = zenoh.open(network.as_config())
    except zenoh.ZError as error:
        where = ", ".join((*network.listen, *network.connect))
        if not network.listen and any(said in str(error) for said in _NOT_REACHED):
            raise errors.NoAnswer(f"no system answers at {where}; start one with: semmap up") from None
        if "Endpoints must be of the form" in str(error):
            raise errors.BadRequest(f"'{where}' is no Zenoh endpoint, such as {DEFAULT_ENDPOINT}") from None
        reason = str(error).split(" at /", 1)[0]
        raise errors.BadRequest(f"cannot open a session at {where}: {reason}") from None
    try:
        yield session
    finally:
        session.close()  # type: ignore[no-untyped-call]


def ask(
    session: zenoh.Session,
    prefix: str,
    verb: str,
    message: Any,
    kind: Any,
    *,
    timeout_s: float = TIMEOUT_S,
    patience_s: float = PATIENCE_S,
    meanwhile: Callable[[], None] | None = None,
    first_hand: bool = False,
) -> Any:
    """Send `message` to `prefix/verb` and return the reply, of type `kind`.

    `meanwhile` is called again and again while the answer takes its time. `first_hand`: whoever serves just
    this verb is asked, and those who serve all verbs of the prefix only if there is no such one.

    Raises the error of the reply; NoAnswer when nobody serves the key within `patience_s` or the one
    that does takes longer than `timeout_s`.
    """
    key = f"{prefix}/{verb}"
    payload, encoding = codec.encode(message), codec.encoding_of(message)
    deadline = time.monotonic() + patience_s
    while True:
        replies = session.get(
            key,
            payload=payload,
            encoding=encoding,
            timeout=timeout_s,
            consolidation=_AS_THEY_COME,
            target=zenoh.QueryTarget.ALL_COMPLETE if first_hand else zenoh.QueryTarget.BEST_MATCHING,
        )
        for reply in replies if meanwhile is None else _polled(replies, meanwhile):
            return read_reply(key, reply, kind, timeout_s).decode()
        if first_hand:
            first_hand = False
            continue
        if time.monotonic() > deadline:
            _nobody(key)
        time.sleep(0.01)


def _polled(replies: Any, meanwhile: Callable[[], None]) -> Iterator[zenoh.Reply]:
    while True:
        try:
            reply = replies.try_recv()
        except zenoh.ZError:  # there will be no more
            return
        if reply is not None:
            yield reply
        else:
            meanwhile()
            time.sleep(0.02)


def ask_later(
    session: zenoh.Session,
    prefix: str,
    verb: str,
    message: Any,
    kind: Any,
    answer: Callable[[Callable[[], Encoded]], None],
    *,
    timeout_s: float = TIMEOUT_S,
) -> None:
    """Like `ask`, without waiting: `answer` is given a function that returns the reply or raises its error.

    It is called once, on the thread with which Zenoh receives everything, so it should only queue.
    """
    key = f"{prefix}/{verb}"
    waiting = [answer]

    def on_reply(reply: zenoh.Reply) -> None:
        if waiting:
            waiting.pop()(lambda: read_reply(key, reply, kind, timeout_s))

    def on_end() -> None:
        if waiting:
            waiting.pop()(lambda: _nobody(key))

    handler = zenoh.handlers.Callback(on_reply, on_end, indirect=False)
    payload, encoding = codec.encode(message), codec.encoding_of(message)
    session.get(
        key, handler, payload=payload, encoding=encoding, timeout=timeout_s, consolidation=_AS_THEY_COME
    )


def read_reply(key: str, reply: zenoh.Reply, kind: Any, timeout_s: float) -> Encoded:
    """The message of a reply, of type `kind`; raises the error that it carries."""
    if reply.ok is not None:
        return Encoded(reply.ok.payload, reply.ok.encoding, kind)
    assert reply.err is not None
    if str(reply.err.encoding) != _ERROR_ENCODING:
        raise errors.NoAnswer(f"{key} did not answer within {timeout_s:g} s")
    raise errors.from_message(codec.decode(reply.err.payload.to_bytes(), errors.ErrorMessage))


def _nobody(key: str) -> NoReturn:
    node = keys.SERVED_BY.get(key.rpartition("/")[0])
    why = f"{node} does not run" if node else "nobody serves it"
    raise errors.NoAnswer(
        f"no answer on {key}: {why}, or is just starting (see: semmap status), or this client may not ask it"
    )


@dataclass(frozen=True)
class Request:
    """A request as it came: from a query, or from a put that is answered on `semmap/ack`.

    `plain`: the reply may be a message that is `Encoded` already.
    """

    verb: str
    payload: bytes
    parameters: dict[str, str] = field(default_factory=dict)
    send: Callable[[Any, bool], None] = field(default=lambda message, ok: None)
    plain: bool = False

    def read(self, kind: Any) -> Any:
        """The message, of type `kind`. Raises BadRequest."""
        parameters = {k: v for k, v in self.parameters.items() if (k, v) != ("format", "json")}
        if self.payload:
            if parameters:
                raise errors.BadRequest("give the fields in the message or as parameters, not both")
            return codec.decode(self.payload, kind)
        return codec.from_text(parameters, kind)

    def reply(self, message: Any) -> None:
        """Answer it."""
        self.send(message, True)

    def refuse(self, error: errors.SemmapError) -> None:
        """Answer it with an error."""
        self.send(errors.to_message(error), False)


def _request_of_query(prefix: str, query: zenoh.Query) -> Request:
    verb = keys.last_chunk(str(query.key_expr))
    payload = query.payload.to_bytes() if query.payload is not None else b""
    parameters = dict(query.parameters)  # type: ignore[call-overload]
    as_json = "format" in parameters or codec.looks_like_json(payload)
    key = f"{prefix}/{verb}" if "*" not in verb else prefix

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

    return Request(verb, payload, parameters, send, plain=not as_json)


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

        receive(Request(verb, payload, {}, send))

    session.declare_subscriber(f"{prefix}/**", on_put)


def _envelope(payload: bytes) -> dict[str, Any]:
    """What can be read of a message before its type is known."""
    try:
        return dict(codec.decode(payload, dict[str, Any]))
    except errors.BadRequest:
        return {}


def publisher(session: zenoh.Session, topic: keys.Topic, key: str | None = None) -> Any:
    """A publisher with the topic's quality of service."""
    key = key or topic.key
    if topic.qos == "newest":
        return session.declare_publisher(key, congestion_control=zenoh.CongestionControl.DROP)
    return ext.declare_advanced_publisher(
        session,
        key,
        congestion_control=zenoh.CongestionControl.BLOCK,
        cache=ext.CacheConfig(max_samples=1000),
        sample_miss_detection=ext.MissDetectionConfig(heartbeat=None, sporadic_heartbeat=0.5),
        publisher_detection=True,
    )


def watched(session: zenoh.Session, topic: keys.Topic) -> Callable[[], bool]:
    """A function that tells whether anybody follows any key of `topic` just now."""
    publisher = session.declare_publisher(topic.key)
    return lambda: publisher.matching_status.matching  # type: ignore[attr-defined]


def follow(session: zenoh.Session, topic: keys.Topic, receive: Callable[[str, Any], None]) -> Any:
    """Each publication of `topic` goes to `receive(key, message)`, on a thread of Zenoh's.

    A malformed one is dropped: whoever sent it is not one of ours.
    """

    def on_sample(sample: zenoh.Sample) -> None:
        if sample.kind == zenoh.SampleKind.DELETE:
            receive(str(sample.key_expr), None)
            return
        try:
            message = codec.decode(sample.payload.to_bytes(), topic.message)
        except errors.BadRequest:
            return
        receive(str(sample.key_expr), message)

    if topic.qos == "newest" or "*" in topic.key:
        return session.declare_subscriber(topic.key, on_sample)
    return ext.declare_advanced_subscriber(
        session,
        topic.key,
        on_sample,
        recovery=ext.RecoveryConfig(periodic_queries=None, heartbeat=True),
    )


def follow_cameras(
    session: zenoh.Session,
    plane: Literal["rgb", "depth"],
    receive: Callable[[CameraFrame, Callable[[], bytes]], None],
    refuse: Callable[[str], None],
) -> None:
    """Each plane of each camera goes to `receive(frame, read)`, where `read()` gives its pixels.

    On a thread of Zenoh's, so they should only be kept. `refuse(reason)` is told of what is no frame.
    """

    def on_sample(sample: zenoh.Sample) -> None:
        try:
            attached = sample.attachment.to_bytes() if sample.attachment is not None else b""
            receive(codec.decode(attached, CameraFrame), sample.payload.to_bytes)
        except errors.BadRequest as error:
            refuse(f"{sample.key_expr}: {error.text}")

    session.declare_subscriber(keys.camera_key("*", plane), on_sample)


def listen(session: zenoh.Session, key_expr: str) -> Iterator[tuple[str, str]]:
    """Key and content, as JSON, of what is published from now on. Raises BadRequest for no key expression."""
    try:
        subscriber = session.declare_subscriber(key_expr)
    except zenoh.ZError as error:
        raise errors.BadRequest(
            f"'{key_expr}' is no key expression: {str(error).split(' at /', 1)[0]}"
        ) from None
    for sample in subscriber:
        if sample.kind == zenoh.SampleKind.DELETE:
            yield str(sample.key_expr), "gone"
        else:
            yield str(sample.key_expr), codec.as_json(sample.payload.to_bytes())
