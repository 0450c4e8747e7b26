"""Queries: send one and wait for the reply, or receive it in a callback.

Observed with Zenoh 1.10.2:

- A `get` without a queryable returns immediately and empty. An empty result is therefore repeated until the
  patience ends.
- A time-out arrives as an error reply that is not ours.
- The callback of a `get` runs on a thread of its own unless it is declared direct. Starting the thread takes
  longer than the whole round trip.
- Replies wait for the end of the query unless consolidation is off.
"""

from __future__ import annotations

import logging
import random
import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any, Final, NoReturn

import zenoh
from msgspec import Struct

from semmap.nodes.bus import fragmentation
from semmap.nodes.bus.liveliness import LivelinessMonitor
from semmap.nodes.bus.session import PATIENCE_S
from semmap.schemas import codec, errors, keys
from semmap.schemas.replies import Done

log = logging.getLogger(__name__)

TIMEOUT_S = 30.0
_WAS_RECEIVED_S = 0.1
"""A query that ends without a reply after this time had reached a node, which has gone since."""

BUSY_S = 60.0
"""Seconds for which a query to a busy node is repeated."""
_SLOWER: Final = 1.5
"""Factor by which each pause is longer than the last."""
_LONGEST_S: Final = 5.0

_TIME_IS_UP = b"Timeout"
_ERROR_ENCODING = "application/msgpack;semmap.ErrorMessage.v1"
_AS_THEY_COME = zenoh.ConsolidationMode.NONE


_ROUND_S: Final = 60.0
"""Time-out of the first query: Zenoh (1.10.2) keeps a kilobyte for every query until its time-out, even after
the reply. A query that is usually quick is therefore repeated once with the full time-out."""


class TimedOut(errors.NoAnswer):
    """The node has not replied within the time-out."""


def first_round_s(message: Any, timeout_s: float) -> float:
    """Return the time-out [s] of the first query; it raises TimedOut if `timeout_s` is longer."""
    return min(timeout_s, _ROUND_S) if getattr(message, "is_quick", False) else timeout_s


class ForeignReply(errors.NoAnswer):
    """Only a program has answered that is not one of the nodes that serve the key."""


class BusyBackoff:
    """The pauses between queries to a busy node: increasing, and randomized."""

    def __init__(self) -> None:
        self._until_s = time.monotonic() + BUSY_S
        self._times = 0

    def pause_s(self, busy: errors.Busy) -> float:
        """Return the pause [s] before the next query. Raises `busy` when the time is up."""
        if time.monotonic() > self._until_s:
            raise busy
        wanted_s = min((busy.again_s or 1.0) * _SLOWER**self._times, _LONGEST_S)
        self._times += 1
        return wanted_s * random.uniform(0.5, 1.5)


class Encoded(Struct, frozen=True):
    """An encoded message, to be decoded or forwarded."""

    payload: zenoh.ZBytes | bytearray
    encoding: zenoh.Encoding
    kind: Any

    def decode(self) -> Any:
        """Return the message, of type `kind`. Raises BadRequest."""
        payload = self.payload
        return codec.decode(payload if isinstance(payload, bytearray) else payload.to_bytes(), self.kind)


def ask(
    session: zenoh.Session,
    prefix: str,
    verb: str,
    message: Any,
    kind: Any,
    *,
    timeout_s: float = TIMEOUT_S,
    patience_s: float = PATIENCE_S,
    on_wait: Callable[[], None] | None = None,
    prefer_complete: bool = False,
    liveliness: LivelinessMonitor | None = None,
) -> Any:
    """Send `message` to `prefix/verb` and return the reply, of type `kind`.

    - `on_wait` is called repeatedly while waiting.
    - `prefer_complete` first queries a node that serves only this command, then those that serve all commands
      of the prefix.
    - With `liveliness`, the query is repeated when the node goes away. Only replies of nodes that serve the
      key count: after a foreign reply, all queryables of the key are queried.

    A busy node is queried again for a minute.

    Raises the error of the reply; ForeignReply if only foreign programs have answered; NoAnswer if no node
    serves the key for `patience_s`, or if the reply takes longer than `timeout_s`.
    """
    how = (timeout_s, patience_s, on_wait, prefer_complete, liveliness)
    try:
        return _ask(session, prefix, verb, message, kind, *how)
    except errors.Busy as error:
        busy, patience = error, BusyBackoff()
    while True:
        until_s = time.monotonic() + patience.pause_s(busy)
        while (left_s := until_s - time.monotonic()) > 0:
            if on_wait is not None:
                on_wait()
            time.sleep(min(left_s, 0.1))
        try:
            return _ask(session, prefix, verb, message, kind, *how)
        except errors.Busy as error:
            busy = error


def _ask(
    session: zenoh.Session,
    prefix: str,
    verb: str,
    message: Any,
    kind: Any,
    timeout_s: float,
    patience_s: float,
    on_wait: Callable[[], None] | None,
    prefer_complete: bool,
    liveliness: LivelinessMonitor | None,
) -> Any:
    key = f"{prefix}/{verb}"
    payload, encoding = codec.encode(message), codec.encoding_of(message)
    deadline_s = time.monotonic() + patience_s
    servers, foreign = keys.servers(prefix, verb), False
    round_s = first_round_s(message, timeout_s)
    target = zenoh.QueryTarget.ALL_COMPLETE if prefer_complete else zenoh.QueryTarget.BEST_MATCHING
    while True:
        asked_at_s = time.monotonic()
        replies: Any = ()
        if (last := _send_leading_fragments(session, key, payload, encoding, liveliness)) is not None:
            replies = _get(
                session,
                key,
                liveliness.token_for(servers) if liveliness else None,
                encoding=encoding,
                timeout=round_s,
                target=target,
                **last,
            )
        assembler = fragmentation.ReplyAssembler()
        try:
            for reply in replies if on_wait is None or last is None else _polled(replies, on_wait):
                if liveliness is not None:
                    liveliness.wait_until_known(servers)
                if liveliness is None or liveliness.is_from(servers, reply) or _is_late(reply):
                    if (whole := read_reply(key, reply, kind, round_s, assembler)) is not None:
                        return whole.decode()
                    continue
                if not foreign:
                    foreign, deadline_s = True, time.monotonic() + patience_s
                    if liveliness.is_first_foreign_reply(key):
                        log.warning("%s", _foreign(key, servers))
                target = zenoh.QueryTarget.ALL
        except TimedOut:
            if round_s == timeout_s:
                raise
            round_s = timeout_s
            continue
        took_s = (now_s := time.monotonic()) - asked_at_s
        if took_s > _WAS_RECEIVED_S and (liveliness is None or liveliness.has_seen(servers)):
            deadline_s = now_s + patience_s
        if prefer_complete:
            prefer_complete = False
            target = zenoh.QueryTarget.ALL if foreign else zenoh.QueryTarget.BEST_MATCHING
            continue
        if now_s > deadline_s and foreign:
            raise ForeignReply(_foreign(key, servers))
        if now_s > deadline_s:
            _raise_no_answer(key)
        if on_wait is not None:
            on_wait()
        time.sleep(0.01)


def _send_leading_fragments(
    session: zenoh.Session,
    key: str,
    payload: bytes,
    encoding: str,
    liveliness: LivelinessMonitor | None,
    source: zenoh.SourceInfo | None = None,
) -> dict[str, Any] | None:
    """Send all fragments of a large payload but the last; return the options for the final query.

    Returns None if no node has accepted them. Raises the error of a reply to a fragment.
    """
    if len(payload) <= fragmentation.FRAGMENT_BYTES:
        return {"payload": payload}
    servers = keys.servers(*key.rsplit("/", 1))
    for content, piece in fragmentation.split(payload):
        sent = {"payload": content, "attachment": codec.encode(piece)}
        if piece.is_last:
            return sent
        lifeline = liveliness.token_for(servers) if liveliness else None
        for reply in _get(session, key, lifeline, source, encoding=encoding, timeout=TIMEOUT_S, **sent):
            if liveliness is None or liveliness.is_from(servers, reply):
                read_reply(key, reply, Done, TIMEOUT_S)
                break
        else:
            return None
    return None


def _get(
    session: zenoh.Session,
    key: str,
    lifeline: zenoh.CancellationToken | None,
    source: zenoh.SourceInfo | None = None,
    **options: Any,
) -> Any:
    """Return the replies as they arrive; none if the node has just gone. `source` is the original client."""
    source = source or zenoh.SourceInfo(session.id, 0)
    try:
        return session.get(
            key, consolidation=_AS_THEY_COME, cancellation_token=lifeline, source_info=source, **options
        )
    except zenoh.ZError:
        if lifeline is None or not lifeline.is_cancelled:
            raise
        return ()


def _polled(replies: Any, on_wait: Callable[[], None]) -> Iterator[zenoh.Reply]:
    while True:
        try:
            reply = replies.try_recv()
        except zenoh.ZError:  # no more replies
            return
        if reply is not None:
            yield reply
        else:
            on_wait()
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
    liveliness: LivelinessMonitor | None = None,
    ask_all: bool = False,
    source: Any = None,
) -> None:
    """Send a query without waiting; `answer` receives a function that returns the reply or raises its error.

    `ask_all` queries all queryables of the key, as is needed after a ForeignReply. `source` identifies the
    client of a forwarded request.

    `answer` is called once on Zenoh's receiving thread, so it must only queue. Busy nodes are not queried
    again: use `BusyBackoff`.
    """
    key = f"{prefix}/{verb}"
    waiting, servers = [answer], keys.servers(prefix, verb)
    foreign: list[zenoh.Reply] = []
    assembler = fragmentation.ReplyAssembler()

    def on_reply(reply: zenoh.Reply) -> None:
        if liveliness is not None and not liveliness.is_from(servers, reply) and not _is_late(reply):
            foreign.append(reply)
        elif not waiting:
            return
        elif reply.ok is None or reply.ok.attachment is None:
            waiting.pop()(lambda: read_whole(key, reply, kind, timeout_s))
        else:
            on_piece(reply)

    def on_piece(reply: zenoh.Reply) -> None:
        try:
            whole = read_reply(key, reply, kind, timeout_s, assembler)
        except errors.SemmapError as error:
            waiting.pop()(partial(_raise, error))
        else:
            if whole is not None:
                waiting.pop()(lambda: whole)

    def refuse() -> NoReturn:
        if foreign:
            raise ForeignReply(_foreign(key, servers))
        _raise_no_answer(key)

    def on_end() -> None:
        if waiting:
            waiting.pop()(refuse)

    handler = zenoh.handlers.Callback(on_reply, on_end, indirect=False)
    payload, encoding = codec.encode(message), codec.encoding_of(message)
    try:
        last = _send_leading_fragments(session, key, payload, encoding, liveliness, source)
    except errors.SemmapError as error:
        answer(partial(_raise, error))
        return
    if last is None:
        on_end()
        return
    lifeline = liveliness.token_for(servers) if liveliness else None
    target = zenoh.QueryTarget.ALL if ask_all else zenoh.QueryTarget.BEST_MATCHING
    _get(
        session,
        key,
        lifeline,
        source,
        handler=handler,
        encoding=encoding,
        timeout=timeout_s,
        target=target,
        **last,
    )


def _raise(error: errors.SemmapError) -> NoReturn:
    raise error


def read_whole(key: str, reply: zenoh.Reply, kind: Any, timeout_s: float) -> Encoded:
    """Return the message of a reply in one part, of type `kind`. Raises the error of the reply."""
    whole = read_reply(key, reply, kind, timeout_s)
    if whole is None:
        raise errors.InternalError(f"{key} replied with a fragment of a message")
    return whole


def read_reply(
    key: str,
    reply: zenoh.Reply,
    kind: Any,
    timeout_s: float,
    assembler: fragmentation.ReplyAssembler | None = None,
) -> Encoded | None:
    """Return the message of a reply, of type `kind`; None for a fragment before the last.

    Raises the error of the reply.
    """
    if (sample := reply.ok) is not None:
        if assembler is None or (piece := fragmentation.fragment_of(sample.attachment)) is None:
            return Encoded(sample.payload, sample.encoding, kind)
        whole = assembler.take(piece, sample.payload)
        return None if whole is None else Encoded(whole, sample.encoding, kind)
    error = reply.err
    if error is None:
        raise errors.InternalError(f"{key} replied with neither a message nor an error")
    if str(error.encoding) != _ERROR_ENCODING:
        raise TimedOut(f"{key} did not answer within {timeout_s:g} s")
    raise errors.from_message(codec.decode(error.payload.to_bytes(), errors.ErrorMessage))


def _is_late(reply: zenoh.Reply) -> bool:
    """Return whether a reply is Zenoh's time-out, which may arrive in the name of a neighbour."""
    error = reply.err
    if error is None or str(error.encoding) == _ERROR_ENCODING:
        return False
    return error.payload.to_bytes() == _TIME_IS_UP


def _foreign(key: str, servers: tuple[str, ...]) -> str:
    return (
        f"a program that is not {errors.enumerated(servers)} answers on {key}; its replies are ignored"
        " (to admit only certified programs: semmap up --secure)"
    )


def _raise_no_answer(key: str) -> NoReturn:
    node = keys.SERVED_BY.get(keys.served(key.rpartition("/")[0]))
    if name := keys.asked_as(key):
        raise errors.NoAnswer(
            f"no response on {key}: {name} is not permitted (certificate revoked?),"
            f" or {node} is not running or still starting; see: semmap status"
        )
    why = f"{node} is not running" if node else "no node serves it"
    raise errors.NoAnswer(
        f"no response on {key}: {why} or still starting, or this client lacks permission; see: semmap status"
    )
