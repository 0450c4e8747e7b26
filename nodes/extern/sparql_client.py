"""The client of a standing query: its rows, and the rows that appear and disappear."""

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
    """The rows of a query, and their changes. It is returned by `Client.watch`.

    `changes` waits for changes and renews the lease. After a restart of the knowledge base, it runs the query
    again and returns the difference.
    """

    def __init__(self, session: bus.Session, ask: Callable[..., Any], wanted: commands.Watch) -> None:
        """Start the query; `ask(verb, command, type)` sends requests. Raises BadRequest, Refused."""
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
        """Iterate over the changes, in order, until the query is closed.

        Raises Refused if the system cancelled the query, and NoAnswer after `timeout` seconds without a
        change.
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
                seq = min(seq, again.seq - 1)  # the numbers of another map may be lower
            if news.error:
                raise errors.Refused(news.error)
            if news.seq <= seq:
                continue
            seq = news.seq
            rows = rows - Counter(news.disappeared) + Counter(news.appeared)
            yield news
            end_at = time.monotonic() + patience_s

    def close(self) -> None:
        """End the query. An iteration over `changes` on another thread ends, too."""
        self._subscriber.undeclare()
        self._news.put(None)
        with contextlib.suppress(errors.SemmapError):
            renewal = commands.Renew(watch=self._name, end=True)
            self._ask("renew", renewal, replies.Done, patience_s=0.0, timeout_s=2.0)

    def _watch(self) -> Watching:
        watching: Watching = self._ask("watch", self._command, Watching, timeout_s=_ASK_S)
        return watching

    def _renew(self) -> Watching | None:
        """Renew the lease. Returns the current rows if the query had ended and was started again."""
        try:
            self._ask("renew", commands.Renew(watch=self._name), replies.Done)
        except errors.UnknownName:
            return self._watch()
        except errors.NoAnswer:
            pass  # the next renewal may succeed before the lease expires
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
