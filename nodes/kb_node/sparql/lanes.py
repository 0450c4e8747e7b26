"""Lanes: direct connections between the node and the reader processes.

A lane is a pair of sockets. The SPARQL process keeps the remote end for whichever reader serves the lane, so
a query that no reader has taken waits there for the next one. A lane has one query at a time.

Clients are served in turn, and every query gets a lane soon. If all lanes are busy, only a few queries that
take long keep theirs. The others are preempted: their readers are stopped, and they start again when one of
the long ones is done. The duration of a query need not be known in advance.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import count
from multiprocessing.connection import Connection, Pipe
from typing import Any, Final

from msgspec import msgpack

from semmap.nodes.kb_node.sparql.protocol import (
    QueryOutcome,
    QueryRequest,
    ReaderExited,
    StartReader,
    StopReader,
    outcomes,
)
from semmap.nodes.kb_node.sparql.readers import error_for_signal
from semmap.nodes.runtime.fair_queue import FairQueue
from semmap.schemas import codec, errors
from semmap.schemas.commands import Sparql
from semmap.schemas.sparql import SparqlResult

LANES: Final = 6
"""Queries that are evaluated at the same time."""
LONG_RUNNING: Final = 3
"""Long-running queries that keep their lanes while others wait."""
LONG_S: Final = 0.3
"""A query that runs longer is long-running [s]."""
_EACH: Final = 64
_ALL: Final = 256
"""Queries of one client, and of all, that may wait."""
_SHORT: Final = 16_000
"""Bytes that a lane accepts without blocking. A lane never holds two queries."""


@dataclass
class _Query:
    question: QueryRequest
    asker: str = ""
    future: Future[SparqlResult] = field(default_factory=Future)
    began_s: float = 0.0
    was_preempted: bool = False

    def is_long_running(self, now_s: float) -> bool:
        """Return whether the query is long-running."""
        return self.was_preempted or now_s - self.began_s >= LONG_S


@dataclass
class _Lane:
    number: int
    connection: Connection
    has_reader: bool = False
    query: _Query | None = None
    is_closing: bool = False
    """Whether its reader is being stopped."""


class Lanes:
    """The node's ends of the lanes. Any thread may send queries."""

    def __init__(self, send: Callable[[Any, Connection | None], None]) -> None:
        """Create the lanes; `send(message, connection)` queues a message.

        Without a connection the message goes to the SPARQL process.
        """
        self._send = send
        pairs = [Pipe() for _ in range(LANES)]
        self._lanes = [_Lane(number, here) for number, (here, _) in enumerate(pairs)]
        self.remote_ends: Sequence[Connection] = [there for _, there in pairs]
        """The remote ends. They are closed here once they have been passed on."""
        self._waiting: FairQueue[_Query] = FairQueue(each=_EACH, everyone=_ALL)
        self._set_aside: FairQueue[_Query] = FairQueue()
        self._timer: threading.Timer | None = None
        self._numbers = count()
        self._lock = threading.Lock()
        for lane in self._lanes:
            threading.Thread(target=self._listen, args=(lane,), name="sparql", daemon=True).start()

    def ask(self, command: Sparql, seq: int, demand: int = 0, asker: str = "") -> Future[SparqlResult]:
        """Return the answer as of commit `seq` or later, with the measurements of request `demand`.

        Raises Busy if too many queries wait.
        """
        question = QueryRequest(
            number=next(self._numbers),
            seq=seq,
            query=command.query,
            inferred=command.inferred,
            limit=command.limit,
            timeout_s=command.timeout,
            demand=demand,
        )
        query = _Query(question, asker)
        with self._lock:
            again_s = self._waiting.put(asker, query)
            if again_s is not None:
                raise errors.Busy(
                    f"{len(self._waiting)} SPARQL queries are waiting; try again in {again_s:.1f} s",
                    again_s=again_s,
                )
            self._dispatch()
        return query.future

    def on_reader_exit(self, left: ReaderExited) -> None:
        """Handle the exit of a reader."""
        lane = self._lanes[left.lane]
        with self._lock:
            lane.has_reader = lane.is_closing = False
            query = lane.query
            if query is None:
                self._dispatch()
                return
            if not left.signal:  # it did not take the query, or has returned it
                self._start_reader(lane)
                return
            lane.query = None
            self._dispatch()
        query.future.set_exception(error_for_signal(left.signal, query.question.timeout_s))

    def close(self, error: Exception) -> None:
        """Fail all queries, because there will be no more readers."""
        with self._lock:
            waiting = [*iter(self._waiting.take, None), *iter(self._set_aside.take, None)]
            left = [*(lane.query for lane in self._lanes), *waiting]
            if self._timer is not None:
                self._timer.cancel()
            for lane in self._lanes:
                lane.query = None
        for query in filter(None, left):
            query.future.set_exception(error)

    def _dispatch(self) -> None:
        """Assign waiting queries to free lanes, those with readers first."""
        free = [lane for lane in self._lanes if lane.query is None and not lane.is_closing]
        for lane in sorted(free, key=lambda lane: not lane.has_reader):
            if (query := self._next_query()) is None:
                return
            lane.query, query.began_s = query, time.monotonic()
            if not lane.has_reader:
                self._start_reader(lane)
            self._put(lane, query)
        if len(self._waiting):
            self._schedule_preemption()

    def _next_query(self) -> _Query | None:
        """Return the next query; a preempted one if few enough are long-running."""
        query = None
        if len(self._set_aside) and len(self._long_running(time.monotonic())) < LONG_RUNNING:
            query = self._set_aside.take()
        return query or self._waiting.take()

    def _long_running(self, now_s: float) -> list[_Lane]:
        """Return the lanes with long-running queries, first those that were preempted before."""
        lanes = [lane for lane in self._lanes if lane.query is not None and lane.query.is_long_running(now_s)]
        return sorted(lanes, key=lambda lane: (not lane.query.was_preempted, lane.query.began_s))  # type: ignore[union-attr]

    def _schedule_preemption(self) -> None:
        """Start a timer for the time when the next query becomes long-running."""
        if self._timer is None:
            now_s = time.monotonic()
            quick = [
                lane.query for lane in self._lanes if lane.query and not lane.query.is_long_running(now_s)
            ]
            wait_s = min((query.began_s + LONG_S - now_s for query in quick), default=LONG_S)
            self._timer = threading.Timer(wait_s, self._preempt)
            self._timer.daemon = True
            self._timer.start()

    def _preempt(self) -> None:
        """Preempt long-running queries beyond a few, if others wait."""
        with self._lock:
            self._timer = None
            beyond = self._long_running(time.monotonic())[LONG_RUNNING:]
            for lane in beyond[: len(self._waiting)]:
                query, lane.query, lane.is_closing = lane.query, None, True
                if query is None:
                    raise errors.InternalError("a lane that takes long has no query")
                query.was_preempted = True
                self._set_aside.put(query.asker, query)
                self._send(StopReader(lane=lane.number), None)
            if len(self._waiting):
                self._schedule_preemption()

    def _start_reader(self, lane: _Lane) -> None:
        lane.has_reader = True
        self._send(StartReader(lane=lane.number), None)

    def _put(self, lane: _Lane, query: _Query) -> None:
        """Send from this thread if that cannot block, because a switch of threads takes longer."""
        if len(query.question.query) * 4 > _SHORT:
            self._send(query.question, lane.connection)
        else:
            with suppress(OSError):  # the SPARQL process has ended, which its own pipe reports
                lane.connection.send_bytes(msgpack.encode(query.question))

    def _listen(self, lane: _Lane) -> None:
        with suppress(EOFError, OSError), lane.connection as connection:
            while True:
                self._take(lane, outcomes.decode(connection.recv_bytes()))

    def _take(self, lane: _Lane, outcome: QueryOutcome) -> None:
        with self._lock:
            query = lane.query
            if query is None or query.question.number != outcome.number:
                return  # it was cancelled
            if outcome.old:
                self._put(lane, query)
                return
            lane.query = None
            self._dispatch()
        if outcome.error is not None:
            query.future.set_exception(errors.from_message(outcome.error))
        else:
            query.future.set_result(codec.decode(bytes(outcome.result), SparqlResult))
