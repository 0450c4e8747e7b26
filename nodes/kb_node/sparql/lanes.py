"""Lanes: how the node asks its readers, without anybody between.

A lane is a pair of sockets. Its other end the SPARQL process keeps for whichever reader minds it, so that a
question that no reader has taken waits there for the next. A question has a lane to itself until it is
answered, so that one that takes long delays none but those that come when no lane is left.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import count
from multiprocessing.connection import Connection, Pipe
from typing import Any, Final

from msgspec import msgpack

from nodes.kb_node.sparql.protocol import Hire, Left, Outcome, Question, outcomes
from nodes.kb_node.sparql.readers import cause_of_death
from schemas import codec, errors
from schemas.commands import Sparql
from schemas.sparql import SparqlResult

LANES: Final = 4
"""How many queries are evaluated at once."""
_SHORT: Final = 16_000
"""Bytes that a lane always takes without waiting: there are never two questions in one."""


@dataclass
class _Query:
    question: Question
    future: Future[SparqlResult] = field(default_factory=Future)


@dataclass
class _Lane:
    number: int
    connection: Connection
    has_reader: bool = False
    query: _Query | None = None


class Lanes:
    """The node's ends. Any thread may ask."""

    def __init__(self, send: Callable[[Any, Connection | None], None]) -> None:
        """`send(message, connection)` queues a message, without a connection one to the SPARQL process."""
        self._send = send
        pairs = [Pipe() for _ in range(LANES)]
        self._lanes = [_Lane(number, here) for number, (here, _) in enumerate(pairs)]
        self.others: Sequence[Connection] = [there for _, there in pairs]
        """The other ends; who hands them over closes them here."""
        self._waiting: deque[_Query] = deque()
        self._numbers = count()
        self._lock = threading.Lock()
        for lane in self._lanes:
            threading.Thread(target=self._listen, args=(lane,), name="sparql", daemon=True).start()

    def ask(self, command: Sparql, seq: int, demand: int = 0) -> Future[SparqlResult]:
        """The answer as of commit `seq` or later, with what was demanded under that number."""
        question = Question(
            number=next(self._numbers),
            seq=seq,
            query=command.query,
            inferred=command.inferred,
            limit=command.limit,
            timeout_s=command.timeout,
            demand=demand,
        )
        query = _Query(question)
        with self._lock:
            self._waiting.append(query)
            self._hand_out()
        return query.future

    def leave(self, left: Left) -> None:
        """A reader is no more."""
        lane = self._lanes[left.lane]
        with self._lock:
            lane.has_reader = False
            query = lane.query
            if query is None:
                return
            if not left.signal:  # it did not take the question, or has given it back
                self._hire(lane)
                return
            lane.query = None
            self._hand_out()
        query.future.set_exception(cause_of_death(left.signal, query.question.timeout_s))

    def close(self, error: Exception) -> None:
        """There will be no more readers; nobody waits any longer."""
        with self._lock:
            left = [*(lane.query for lane in self._lanes), *self._waiting]
            self._waiting.clear()
            for lane in self._lanes:
                lane.query = None
        for query in filter(None, left):
            query.future.set_exception(error)

    def _hand_out(self) -> None:
        """Give the questions that wait to lanes that are free, those with readers first."""
        free = [lane for lane in self._lanes if lane.query is None]
        for lane in sorted(free, key=lambda lane: not lane.has_reader)[: len(self._waiting)]:
            lane.query = self._waiting.popleft()
            if not lane.has_reader:
                self._hire(lane)
            self._put(lane, lane.query)

    def _hire(self, lane: _Lane) -> None:
        lane.has_reader = True
        self._send(Hire(lane=lane.number), None)

    def _put(self, lane: _Lane, query: _Query) -> None:
        """From here, if it cannot take long: to wake another thread does."""
        if len(query.question.query) * 4 > _SHORT:
            self._send(query.question, lane.connection)
        else:
            with suppress(OSError):  # then all is over, as the SPARQL process's own pipe tells
                lane.connection.send_bytes(msgpack.encode(query.question))

    def _listen(self, lane: _Lane) -> None:
        with suppress(EOFError, OSError), lane.connection as connection:
            while True:
                self._take(lane, outcomes.decode(connection.recv_bytes()))

    def _take(self, lane: _Lane, outcome: Outcome) -> None:
        with self._lock:
            query = lane.query
            if query is None or query.question.number != outcome.number:
                return  # it was given up
            if outcome.old:
                self._put(lane, query)
                return
            lane.query = None
            self._hand_out()
        if outcome.error is not None:
            query.future.set_exception(errors.from_message(outcome.error))
        else:
            query.future.set_result(codec.decode(bytes(outcome.result), SparqlResult))
