"""The process that keeps the triples for SPARQL.

Started as `python -m semmap.nodes.kb_node.sparql.worker`.

A query cannot be interrupted while Oxigraph evaluates it, and its memory cannot be limited. Only a process
can be killed. If that process had the only copy of the triples, a hanging query would require loading them
again. Therefore this process keeps the triples and follows the commits, but never evaluates queries.

The readers, which are forked from it, evaluate them. A fork takes some milliseconds at 10 000 entities and
shares the memory. The node sends queries to the readers on separate lanes, so a query wakes only one process,
which reads new commits from the log first. Inferred triples are kept by a reasoner in this process, so that
the node only passes on its commits.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any, Final

from msgspec import msgpack, structs

from semmap.nodes.kb_node.reasoner.rules.facts import unpack
from semmap.nodes.kb_node.relations.facts.pair_properties import PairProperties
from semmap.nodes.kb_node.sparql.protocol import (
    CommandReply,
    Committed,
    FromWorker,
    Load,
    LoadFromDisk,
    MeasurementRequest,
    Placements,
    ReaderExited,
    StandingCommand,
    StartReader,
    StopReader,
    ToWorker,
    to_worker,
)
from semmap.nodes.kb_node.sparql.queries.evaluation import declared_in
from semmap.nodes.kb_node.sparql.queries.text import query_prefixes
from semmap.nodes.kb_node.sparql.readers import Reader
from semmap.nodes.kb_node.sparql.standing_queries.continuous_query_monitor import ContinuousQueryMonitor
from semmap.nodes.kb_node.sparql.triples.consequences import Consequences
from semmap.nodes.kb_node.sparql.triples.dataset import Dataset, Delta, DiskDataset
from semmap.nodes.kb_node.sparql.triples.log import Log
from semmap.nodes.kb_node.sparql.triples.measured_relations import MeasuredRelations, Needs, needs_of
from semmap.schemas import errors
from semmap.schemas.explanations import Triple

BACKLOG: Final = 50_000
"""Changed triples that a reader may be behind."""

IDLE_S: Final = 300.0
"""Measurements are dropped after this time without a query that needs them."""


class Worker:
    """Follows the commits and forks readers. `lanes` are the remote ends of the node's lanes."""

    def __init__(self, send: Callable[[FromWorker], None], lanes: Sequence[Connection]) -> None:
        self._send = send
        self._lanes = lanes
        self._dataset = Dataset(0, ())
        self._consequences: Consequences | None = None
        self._derived = PairProperties()
        self._measured: MeasuredRelations | None = None
        self._needed: dict[Needs, float] = {}
        """By need: the time until which it is kept [s, monotonic]."""
        self._log = Log()
        self._readers: dict[int, Reader] = {}
        self.monitor = ContinuousQueryMonitor(send, self._reader)

    @property
    def connections(self) -> Iterator[Connection]:
        """Connections that become readable when a reader has replied or exited."""
        yield from (reader.control for reader in self._readers.values())
        yield from self.monitor.connections

    def take(self, message: ToWorker) -> None:
        """Handle a message from the node."""
        match message:
            case Load():
                self._load(message)
            case LoadFromDisk():
                self._dataset = DiskDataset(Path(message.path), message.seq, message.settled)
                self._consequences = None
                self._begin_log()
                self.monitor.evaluate_all(message.settled)
            case Committed():
                self._follow(message)
            case Placements():
                self._measured = MeasuredRelations(self._derived, self._dataset, message)
            case MeasurementRequest():
                self._needed[self._needs(message.query)] = time.monotonic() + IDLE_S
                self._measure(message.demand)
            case StartReader():
                self._readers[message.lane] = self._reader(self._lanes[message.lane])
            case StopReader():
                if (reader := self._readers.pop(message.lane, None)) is not None:  # otherwise it has exited
                    reader.end()
                    self._send(ReaderExited(lane=message.lane, signal=0))
            case StandingCommand():
                try:
                    dataset = self._dataset
                    self.monitor.handle(message.number, message.command, dataset.seq, dataset.demand)
                except errors.SemmapError as error:
                    self._send(CommandReply(number=message.number, error=errors.to_message(error)))

    def done(self, connection: Connection) -> None:
        """Handle the exit of a reader, or a reply for a standing query."""
        for lane, reader in self._readers.items():
            if reader.control is connection:
                del self._readers[lane]
                self._send(ReaderExited(lane=lane, signal=reader.reap()))
                return
        self.monitor.on_ready(connection)

    def end(self) -> None:
        """Stop all readers."""
        for reader in self._readers.values():
            reader.end()
        self.monitor.stop_readers()

    def _load(self, load: Load) -> None:
        """Load all triples again; the standing queries continue and are evaluated again."""
        demand = self._dataset.demand
        self._dataset = Dataset(load.seq, load.asserted)
        self._dataset.demand = demand
        self._consequences = None
        if load.infers:
            closed = unpack(load.closure) if load.closure else None
            self._consequences = Consequences(load.asserted, self._dataset, load.derived_changes, closed)
        self._derived = PairProperties(load.asserted if load.infers else ())
        self._measured = None
        if load.placements is not None:
            self._measured = MeasuredRelations(self._derived, self._dataset, load.placements)
            self._measure(demand)
        self._begin_log()
        self.monitor.evaluate_all(load.seq)

    def _follow(self, committed: Committed) -> None:
        delta = committed.delta
        if self._consequences is not None:
            delta = self._consequences.after(delta, committed.derived_changes)
        self._dataset.apply(delta)
        if self._measured is not None:
            removed, added = self._measured.after(delta, committed.placed, committed.removed)
            self._dataset.apply(Delta(seq=delta.seq, unmeasured=removed, measured=added))
            delta = structs.replace(delta, unmeasured=removed, measured=added)
        self._log.append(delta)
        self.monitor.follow(delta)
        self._begin_log_if_long()
        if any(until < time.monotonic() for until in self._needed.values()):
            self._needed = {n: until for n, until in self._needed.items() if until >= time.monotonic()}
            self._measure(self._dataset.demand)

    def _needs(self, query: str) -> Needs:
        # imported late: rdflib's parser loads slowly, and few queries need it
        from semmap.nodes.kb_node.sparql.queries.footprint import patterns_of

        known = tuple(sorted(query_prefixes(declared_in(self._dataset)).items()))
        return needs_of(patterns_of(query, known), self._derived)

    def _measure(self, demand: int) -> None:
        """Update the measured triples in the dataset for request `demand`."""
        removed: tuple[Triple, ...] = ()
        added: tuple[Triple, ...] = ()
        if self._measured is not None:
            standing = map(self._needs, self.monitor.inferred_queries)
            removed, added = self._measured.update_needs(Needs.merge((*self._needed, *standing)))
        delta = Delta(seq=self._dataset.seq, unmeasured=removed, measured=added, demand=demand)
        self._log.append(delta)
        self._dataset.apply(delta)
        self._begin_log_if_long()

    def _begin_log_if_long(self) -> None:
        if self._log.size > BACKLOG:
            if isinstance(self._dataset, DiskDataset):
                self._dataset.merge_log(self._log.read_all())
            self._begin_log()

    def _begin_log(self) -> None:
        """Start a new log. Readers of the old one exit after their current query."""
        for reader in self._readers.values():
            reader.retire()
        self._log.close()
        self._log = Log()
        self.monitor.renew_reader()

    def _reader(self, lane: Connection) -> Reader:
        return Reader(lane, self._dataset, self._log, infers=self._consequences is not None)


def main(node: Connection, lanes: Sequence[Connection]) -> None:
    """Serve until the node closes the pipe."""

    def send(message: Any) -> None:
        node.send_bytes(msgpack.encode(message))

    worker = Worker(send, lanes)
    try:
        while True:
            for ready in wait([node, *worker.connections], worker.monitor.timeout_s):
                if ready is node:
                    worker.take(to_worker.decode(node.recv_bytes()))
                else:
                    if not isinstance(ready, Connection):
                        raise errors.InternalError("the SPARQL process waits for connections only")
                    worker.done(ready)
            worker.monitor.advance()
    except (EOFError, ConnectionError, KeyboardInterrupt):
        pass
    finally:
        worker.end()


if __name__ == "__main__":
    own, *others = (Connection(int(word)) for word in sys.argv[1:])
    main(own, others)
