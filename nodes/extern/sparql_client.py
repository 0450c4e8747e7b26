"""A standing query on the client's side: its rows, and what appears and disappears from then on."""

from __future__ import annotations

import contextlib
import math
import queue
import time
import uuid
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any

from msgspec import structs

from semmap.nodes import bus
from semmap.schemas import commands, errors, keys, replies
from semmap.schemas.sparql import Row, RowsChanged, Watching

_LEASE_S = 30.0
_RENEW_S = 5.0
_ASK_S = 200.0


class StandingQuery:
    """The rows of a query as they are, and news of them; use `Client.watch`.

    `changes` waits for the news and renews the lease meanwhile; when the knowledge base was restarted, it
    asks again and tells what changed in between, too.
    """

    def __init__(self, session: bus.Session, ask: Callable[..., Any], wanted: commands.Watch) -> None:
        """`ask(verb, command, kind)` asks the system. Raises BadRequest, Refused for nothing to watch."""
        self._ask = ask
        self._name = f"q{uuid.uuid4().hex[:12]}"
        self._command = structs.replace(wanted, watch=self._name, lease=_LEASE_S)
        self._news: queue.SimpleQueue[RowsChanged | None] = queue.SimpleQueue()
        topic = keys.QUERY._replace(key=keys.query_key(self._name))
        self._subscriber = bus.follow(session, topic, lambda _, news: self._news.put(news))
        try:
            self._seen = self._watch()
        except errors.SemmapError:
            self._subscriber.undeclare()
            raise
        self.variables = self._seen.variables
        self.rows = self._seen.rows
        self.seq = self._seen.seq
        self.notes = self._seen.notes

    def changes(self, *, timeout: float | None = None) -> Iterator[RowsChanged]:
        """The news, in order, until it is closed.

        Raises Refused when the query had to be cancelled, NoAnswer when `timeout` seconds have brought none.
        """
        rows, seq = Counter(self.rows), self.seq
        renew_at = time.monotonic() + _RENEW_S
        patience_s = math.inf if timeout is None else timeout
        end_at = time.monotonic() + patience_s
        while True:
            try:
                news = self._news.get(timeout=max(0.0, min(renew_at, end_at) - time.monotonic()))
                if news is None:
                    return
            except queue.Empty:
                if time.monotonic() >= end_at:
                    raise errors.NoAnswer(f"no rows changed within {patience_s:g} s") from None
                renew_at = time.monotonic() + _RENEW_S
                if (again := self._renew()) is None:
                    continue
                news = _difference(rows, seq, again)
                if not news.appeared and not news.disappeared:
                    seq = again.seq
                    continue
                seq = min(seq, again.seq - 1)  # another map's numbers may be lower
            if news.error:
                raise errors.Refused(news.error)
            if news.seq <= seq:
                continue
            seq = news.seq
            rows = rows - Counter(news.disappeared) + Counter(news.appeared)
            yield news
            end_at = time.monotonic() + patience_s

    def close(self) -> None:
        """End it; whoever waits for news on another thread gets no more."""
        self._subscriber.undeclare()
        self._news.put(None)
        with contextlib.suppress(errors.SemmapError):
            renewal = commands.Renew(watch=self._name, end=True)
            self._ask("renew", renewal, replies.Done, patience_s=0.0, timeout_s=2.0)

    def _watch(self) -> Watching:
        watching: Watching = self._ask("watch", self._command, Watching, timeout_s=_ASK_S)
        return watching

    def _renew(self) -> Watching | None:
        """Renew the lease; returns the present rows if the query had ended and was started again."""
        try:
            self._ask("renew", commands.Renew(watch=self._name), replies.Done)
        except errors.UnknownName:
            return self._watch()
        except errors.NoAnswer:
            pass  # it may come back, and the lease lasts for several times
        return None


def _difference(rows: Counter[Row], since: int, now: Watching) -> RowsChanged:
    new = Counter(now.rows)
    return RowsChanged(
        watch=now.watch,
        seq=now.seq,
        since=since,
        appeared=tuple((new - rows).elements()),
        disappeared=tuple((rows - new).elements()),
    )
