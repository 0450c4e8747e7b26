"""Queries: ask and wait for the reply, or have it handed over later.

What was learnt by measuring (Zenoh 1.10.2): a `get` that finds nobody comes back empty at once, so an empty
answer is asked again until patience ends, and never read as an answer; a time-out comes as an error reply
that is not ours. The callback of a `get` is given a thread of its own unless it is declared direct, which
takes longer than the whole round trip; and replies wait for the end of the query unless they need not be
consolidated.
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
_HAD_IT_S = 0.1
"""A question that ends without an answer after so long was with somebody, who has gone meanwhile."""

BUSY_S = 60.0
"""Seconds for which one who is told to come again does so."""
_SLOWER: Final = 1.5
"""How much longer one who was sent away again waits than the last time."""
_LONGEST_S: Final = 5.0

_TIME_IS_UP = b"Timeout"
_ERROR_ENCODING = "application/msgpack;semmap.ErrorMessage.v1"
_AS_THEY_COME = zenoh.ConsolidationMode.NONE


_ROUND_S: Final = 60.0
"""Zenoh (1.10.2) keeps a kilobyte of every question until its time-out, long after it was answered. So what
is quick as a rule has this time-out, and is asked a second time with all the time that it may take."""


class TimedOut(errors.NoAnswer):
    """Who was asked has not answered in the time that was given for it."""


def first_round_s(message: Any, timeout_s: float) -> float:
    """The time-out [s] of the first question when the answer may take `timeout_s`; raises TimedOut then."""
    return min(timeout_s, _ROUND_S) if getattr(message, "is_quick", False) else timeout_s


class ForeignReply(errors.NoAnswer):
    """Only somebody has answered who is not one of the nodes that serve the key."""


class BusyBackoff:
    """With those who are busy: when to come again, later each time and never all at once."""

    def __init__(self) -> None:
        self._until_s = time.monotonic() + BUSY_S
        self._times = 0

    def pause_s(self, busy: errors.Busy) -> float:
        """After how long [s] to ask again. Raises `busy` when it has taken too long."""
        if time.monotonic() > self._until_s:
            raise busy
        wanted_s = min((busy.again_s or 1.0) * _SLOWER**self._times, _LONGEST_S)
        self._times += 1
        return wanted_s * random.uniform(0.5, 1.5)


class Encoded(Struct, frozen=True):
    """A message as it came: to be decoded, or passed on."""

    payload: zenoh.ZBytes | bytearray
    encoding: zenoh.Encoding
    kind: Any

    def decode(self) -> Any:
        """The message, of type `kind`. Raises BadRequest."""
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

    `meanwhile` is called again and again while the answer takes its time. `prefer_complete`: whoever serves just
    this verb is asked, and those who serve all verbs of the prefix only if there is no such one. With
    `liveliness`, those of this session, the question ends, and is asked again, when who was asked is gone; and
    a reply counts only if it is by a node that serves the key: where another program has answered, everybody
    who serves the key is asked.

    Who answers that it is busy is asked again, for a minute.

    Raises the error of the reply; ForeignReply when nobody else has answered; NoAnswer when nobody serves the
    key for `patience_s` or the one that does takes longer than `timeout_s`.
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
        if (last := _sent_ahead(session, key, payload, encoding, liveliness)) is not None:
            replies = _get(
                session,
                key,
                liveliness.of(servers) if liveliness else None,
                encoding=encoding,
                timeout=round_s,
                target=target,
                **last,
            )
        gathered = fragmentation.ReplyAssembler()
        try:
            for reply in replies if on_wait is None or last is None else _polled(replies, on_wait):
                if liveliness is not None:
                    liveliness.look(servers)
                if liveliness is None or liveliness.vouch(servers, reply) or _is_late(reply):
                    if (whole := read_reply(key, reply, kind, round_s, gathered)) is not None:
                        return whole.decode()
                    continue
                if not foreign:
                    foreign, deadline_s = True, time.monotonic() + patience_s
                    if liveliness.is_news(key):
                        log.warning("%s", _foreign(key, servers))
                target = zenoh.QueryTarget.ALL
        except TimedOut:
            if round_s == timeout_s:
                raise
            round_s = timeout_s
            continue
        took_s = (now_s := time.monotonic()) - asked_at_s
        if took_s > _HAD_IT_S and (liveliness is None or liveliness.has_seen(servers)):
            deadline_s = now_s + patience_s
        if prefer_complete:
            prefer_complete = False
            target = zenoh.QueryTarget.ALL if foreign else zenoh.QueryTarget.BEST_MATCHING
            continue
        if now_s > deadline_s and foreign:
            raise ForeignReply(_foreign(key, servers))
        if now_s > deadline_s:
            _nobody(key)
        if on_wait is not None:
            on_wait()
        time.sleep(0.01)


def _sent_ahead(
    session: zenoh.Session,
    key: str,
    payload: bytes,
    encoding: str,
    liveliness: LivelinessMonitor | None,
    source: zenoh.SourceInfo | None = None,
) -> dict[str, Any] | None:
    """What is left to be sent as the question itself: of a large payload, the last piece.

    None if nobody has taken the others. Raises the error that a piece is answered with.
    """
    if len(payload) <= fragmentation.FRAGMENT_BYTES:
        return {"payload": payload}
    servers = keys.servers(*key.rsplit("/", 1))
    for content, piece in fragmentation.split(payload):
        sent = {"payload": content, "attachment": codec.encode(piece)}
        if piece.is_last:
            return sent
        lifeline = liveliness.of(servers) if liveliness else None
        for reply in _get(session, key, lifeline, source, encoding=encoding, timeout=TIMEOUT_S, **sent):
            if liveliness is None or liveliness.vouch(servers, reply):
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
    """The replies as they come; none if the lifeline has just been cut. `source`: in whose name."""
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
        except zenoh.ZError:  # there will be no more
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
    """Like `ask`, without waiting: `answer` is given a function that returns the reply or raises its error.

    `everybody` who serves the key is asked, as one should after a ForeignReply. `source` is that of a request
    in whose name it is asked. `answer` is called once, on the thread with which Zenoh receives everything, so
    it should only queue. One who is busy is not asked again: `Patience` tells when to.
    """
    key = f"{prefix}/{verb}"
    waiting, servers = [answer], keys.servers(prefix, verb)
    foreign: list[zenoh.Reply] = []
    gathered = fragmentation.ReplyAssembler()

    def on_reply(reply: zenoh.Reply) -> None:
        if liveliness is not None and not liveliness.vouch(servers, reply) and not _is_late(reply):
            foreign.append(reply)
        elif not waiting:
            return
        elif reply.ok is None or reply.ok.attachment is None:
            waiting.pop()(lambda: read_whole(key, reply, kind, timeout_s))
        else:
            on_piece(reply)

    def on_piece(reply: zenoh.Reply) -> None:
        try:
            whole = read_reply(key, reply, kind, timeout_s, gathered)
        except errors.SemmapError as error:
            waiting.pop()(partial(_raise, error))
        else:
            if whole is not None:
                waiting.pop()(lambda: whole)

    def refuse() -> NoReturn:
        if foreign:
            raise ForeignReply(_foreign(key, servers))
        _nobody(key)

    def on_end() -> None:
        if waiting:
            waiting.pop()(refuse)

    handler = zenoh.handlers.Callback(on_reply, on_end, indirect=False)
    payload, encoding = codec.encode(message), codec.encoding_of(message)
    try:
        last = _sent_ahead(session, key, payload, encoding, liveliness, source)
    except errors.SemmapError as error:
        answer(partial(_raise, error))
        return
    if last is None:
        on_end()
        return
    lifeline = liveliness.of(servers) if liveliness else None
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
    """The message of a reply that came in one, of type `kind`; raises the error that it carries."""
    whole = read_reply(key, reply, kind, timeout_s)
    if whole is None:
        raise errors.InternalError(f"{key} replied with a piece of a message")
    return whole


def read_reply(
    key: str,
    reply: zenoh.Reply,
    kind: Any,
    timeout_s: float,
    gathered: fragmentation.ReplyAssembler | None = None,
) -> Encoded | None:
    """The message of a reply, of type `kind`; None for a piece after which others come.

    Raises the error that it carries.
    """
    if (sample := reply.ok) is not None:
        if gathered is None or (piece := fragmentation.fragment_of(sample.attachment)) is None:
            return Encoded(sample.payload, sample.encoding, kind)
        whole = gathered.take(piece, sample.payload)
        return None if whole is None else Encoded(whole, sample.encoding, kind)
    error = reply.err
    if error is None:
        raise errors.InternalError(f"{key} replied with neither a message nor an error")
    if str(error.encoding) != _ERROR_ENCODING:
        raise TimedOut(f"{key} did not answer within {timeout_s:g} s")
    raise errors.from_message(codec.decode(error.payload.to_bytes(), errors.ErrorMessage))


def _is_late(reply: zenoh.Reply) -> bool:
    """Is it no answer, but Zenoh's word that time has run out? It may come as its next neighbour's."""
    error = reply.err
    if error is None or str(error.encoding) == _ERROR_ENCODING:
        return False
    return error.payload.to_bytes() == _TIME_IS_UP


def _foreign(key: str, servers: tuple[str, ...]) -> str:
    return (
        f"a program that is not {errors.enumerated(servers)} answers on {key}; its answers are ignored"
        " (semmap up --secure keeps strangers out)"
    )


def _nobody(key: str) -> NoReturn:
    node = keys.SERVED_BY.get(keys.served(key.rpartition("/")[0]))
    if name := keys.asked_as(key):
        raise errors.NoAnswer(
            f"no answer on {key}: not permitted, or not there: {name}'s certificate may have been revoked,"
            f" or {node} is not running, or is starting"
        )
    why = f"{node} is not running" if node else "no node serves it"
    raise errors.NoAnswer(
        f"no answer on {key}: {why}, or is starting (see: semmap status), or this client lacks permission"
    )
