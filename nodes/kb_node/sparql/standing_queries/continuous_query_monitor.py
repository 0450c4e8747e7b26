"""Evaluates the standing queries after the commits that may change their rows.

The standing queries have a reader of their own, which follows the commits one by one. If it cannot follow any
more because all triples were replaced, a new reader continues from there. If that one is too far behind as
well, or the reader has died, the remaining evaluations are done in one step.
"""

from __future__ import annotations

import math
import time
import uuid
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from itertools import count
from multiprocessing.connection import Connection, Pipe
from typing import Any, Final

from msgspec import Raw, msgpack

from semmap.nodes.kb_node.sparql.protocol import CommandReply, FromWorker, QueryRequest, QueryUpdate, outcomes
from semmap.nodes.kb_node.sparql.queries import text
from semmap.nodes.kb_node.sparql.readers import Reader, error_for_signal
from semmap.nodes.kb_node.sparql.standing_queries.standing_query import StandingQuery
from semmap.nodes.kb_node.sparql.triples.dataset import Delta
from semmap.schemas import codec, errors
from semmap.schemas.commands import Renew, Watch
from semmap.schemas.replies import Done
from semmap.schemas.sparql import RowsChanged, SparqlResult, Watching

STANDING: Final = 64
"""Largest number of standing queries."""
ROWS: Final = 10_000
TIMEOUT_S: Final = 2.0

_results: msgpack.Decoder[SparqlResult] = codec.decoder(SparqlResult)


@dataclass
class Evaluation:
    """An evaluation of a standing query after commit `seq`. Its rows after `since` are known."""

    standing: StandingQuery
    since: int
    seq: int
    number: int | None = None
    """The command that waits for the first rows."""


@dataclass
class ReaderSwitch:
    """From here on another reader evaluates, which has the triples of that time."""

    lane: Connection
    reader: Reader

    def end(self) -> None:
        """Stop the reader."""
        self.reader.end()
        self.lane.close()


class ContinuousQueryMonitor:
    """Keeps the standing queries, and publishes their changes in the order of the commits."""

    def __init__(self, send: Callable[[FromWorker], None], hire: Callable[[Connection], Reader]) -> None:
        """Create a monitor; `hire(lane)` returns a reader that replies on that lane."""
        self._send = send
        self._hire = hire
        self._seq = 0
        self._numbers = count()
        self._standing: dict[str, StandingQuery] = {}
        self._evaluations: deque[Evaluation | ReaderSwitch] = deque()
        self._running: Evaluation | None = None
        self._active: ReaderSwitch | None = None
        self._is_behind = False

    @property
    def connections(self) -> Iterator[Connection]:
        """Connections that become readable when an evaluation is done."""
        if self._active is not None and self._running is not None:
            yield self._active.lane

    @property
    def timeout_s(self) -> float | None:
        """Seconds until something must be done without a message, or None."""
        soonest = min((standing.ends for standing in self._standing.values()), default=math.inf)
        return None if soonest == math.inf else max(0.0, soonest - time.monotonic())

    @property
    def inferred_queries(self) -> Iterator[str]:
        """The queries that read inferred triples."""
        return (standing.query for standing in self._standing.values() if standing.inferred)

    # Input

    def handle(self, number: int, command: Watch | Renew, seq: int, demand: int = 0) -> None:
        """Handle a command at commit `seq`, with all measurements up to request `demand`.

        Raises UnknownName, NameTaken, Refused, and the errors of `text`.
        """
        self._seq = seq
        if isinstance(command, Watch):
            text.require_select(command.query or "")
            self._evaluations.append(
                Evaluation(self._register(command, demand), since=seq, seq=seq, number=number)
            )
            return
        if command.watch not in self._standing:
            raise errors.UnknownName(f"there is no standing query '{command.watch}', or it has ended")
        standing = self._standing[command.watch]
        if command.end:
            self._end_query(standing)
        standing.ends = time.monotonic() + standing.lease_s
        result = "has ended" if command.end else f"is renewed for {standing.lease_s:g} s"
        self._send(CommandReply(number=number, reply=_encoded(Done(text=f"{command.watch} {result}"))))

    def follow(self, delta: Delta) -> None:
        """Schedule the evaluations that a commit requires."""
        self._seq = delta.seq
        for standing in self._standing.values():
            if standing.is_touched(delta):
                self._evaluations.append(Evaluation(standing, since=delta.seq - 1, seq=delta.seq))

    def evaluate_all(self, seq: int) -> None:
        """Schedule the evaluation of all queries, because all triples were replaced after commit `seq`."""
        self._seq = seq
        self._evaluations.extend(Evaluation(s, since=seq - 1, seq=seq) for s in self._standing.values())

    def renew_reader(self) -> None:
        """Schedule a new reader, because the present one cannot follow any more after its remaining work."""
        if any(isinstance(evaluation, ReaderSwitch) for evaluation in self._evaluations):
            self._is_behind = True
        elif self._active is not None:
            self._evaluations.append(self._new_reader())

    def on_ready(self, connection: Connection) -> None:
        """Handle a reply or the exit of the reader."""
        if self._active is not None and connection is self._active.lane:
            self._finish()

    def advance(self) -> None:
        """Start the next evaluation and end expired leases."""
        for standing in [s for s in self._standing.values() if s.ends <= time.monotonic()]:
            self._end_query(standing)
        if self._running is None and self._is_behind:
            self.stop_readers()
        while self._running is None and self._evaluations:
            self._begin()

    def stop_readers(self) -> None:
        """Stop all readers; the next one does the remaining evaluations in one step."""
        reliefs = [evaluation for evaluation in self._evaluations if isinstance(evaluation, ReaderSwitch)]
        for reader in filter(None, (self._active, *reliefs)):
            reader.end()
        evaluations = [evaluation for evaluation in self._evaluations if isinstance(evaluation, Evaluation)]
        self._evaluations = deque(_in_one_step(evaluations, self._seq))
        self._active = None
        self._is_behind = False

    # Standing queries

    def _register(self, command: Watch, demand: int) -> StandingQuery:
        name = command.watch or f"q{uuid.uuid4().hex[:12]}"
        if name in self._standing:
            raise errors.NameTaken(f"there is a standing query '{name}' already")
        if len(self._standing) >= STANDING:
            raise errors.Refused(f"there are {STANDING} standing queries already; end one first")
        self._standing[name] = StandingQuery.of(command, name, demand)
        return self._standing[name]

    def _end_query(self, standing: StandingQuery, error: errors.SemmapError | None = None) -> None:
        """End a query; with an error, its subscribers receive the reason."""
        self._standing.pop(standing.watch, None)
        left = (
            evaluation
            for evaluation in self._evaluations
            if isinstance(evaluation, ReaderSwitch) or evaluation.standing is not standing
        )
        self._evaluations = deque(left)
        last = error and RowsChanged(watch=standing.watch, seq=self._seq, since=self._seq, error=error.text)
        self._send(QueryUpdate(watch=standing.watch, rows=last or None, ended=True))

    # Evaluations

    def _begin(self) -> None:
        if self._active is None:
            self.stop_readers()
            if not self._evaluations:
                return
            self._active = self._new_reader()
        evaluation = self._evaluations.popleft()
        if isinstance(evaluation, ReaderSwitch):
            self._active.end()
            self._active = evaluation
            return
        self._running = evaluation
        question = QueryRequest(
            number=next(self._numbers),
            seq=evaluation.seq,
            query=evaluation.standing.query,
            inferred=evaluation.standing.inferred,
            limit=ROWS,
            timeout_s=TIMEOUT_S,
            demand=evaluation.standing.demand,
        )
        with suppress(OSError):  # if the reader is dead, `_result` raises the error
            self._active.lane.send_bytes(msgpack.encode(question))

    def _new_reader(self) -> ReaderSwitch:
        lane, remote = Pipe()
        reader = self._hire(remote)
        remote.close()
        return ReaderSwitch(lane, reader)

    def _finish(self) -> None:
        evaluation, self._running = self._running, None
        if evaluation is None:
            raise errors.InternalError("no standing query is being evaluated")
        try:
            result = self._result()
        except errors.SemmapError as error:
            if evaluation.number is not None:
                self._send(CommandReply(number=evaluation.number, error=errors.to_message(error)))
            if evaluation.standing.watch in self._standing:
                self._end_query(evaluation.standing, error)
            return
        news = evaluation.standing.update_rows(result.rows, evaluation.since, evaluation.seq)
        if evaluation.number is not None:
            evaluation.standing.ends = time.monotonic() + evaluation.standing.lease_s
            self._send(
                CommandReply(number=evaluation.number, reply=_encoded(_watching(evaluation.standing, result)))
            )
        elif news is not None and evaluation.standing.watch in self._standing:
            self._send(QueryUpdate(watch=news.watch, rows=news))

    def _result(self) -> SparqlResult:
        """Return the result of the reader. Raises the query's error, also if the reader died."""
        if self._active is None:
            raise errors.InternalError("no reader evaluates a standing query")
        try:
            outcome = outcomes.decode(self._active.lane.recv_bytes())
        except (EOFError, OSError):
            number = self._active.reader.reap()
            self._active.lane.close()
            self._active = None
            raise error_for_signal(number, TIMEOUT_S) from None
        if outcome.error is not None:
            raise errors.from_message(outcome.error)
        return _results.decode(outcome.result)


def _encoded(message: Any) -> Raw:
    return Raw(msgpack.encode(message))


def _in_one_step(evaluations: Iterable[Evaluation], seq: int) -> Iterator[Evaluation]:
    """Yield one evaluation per standing query at the present commit, instead of several at past ones."""
    last: dict[str, Evaluation] = {}
    for evaluation in evaluations:
        earlier = last.setdefault(evaluation.standing.watch, evaluation)
        earlier.seq = seq
    yield from last.values()


def _watching(standing: StandingQuery, result: SparqlResult) -> Watching:
    return Watching(
        watch=standing.watch,
        variables=result.variables,
        rows=result.rows,
        seq=result.seq,
        lease_s=standing.lease_s,
        notes=result.notes,
    )
