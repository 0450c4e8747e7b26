"""The process that keeps the triples for SPARQL, beside the node.

Started as `python -m semmap.nodes.kb_node.sparql.worker`.

A query cannot be interrupted while Oxigraph evaluates it, nor can its memory be bounded: only a process can
be ended. Were that the one with the triples, a hanging query would cost loading them again. So this process
only keeps the triples and follows the commits, and never evaluates; its readers do, which are forked from it:
that takes some milliseconds at 10 000 entities, shares the memory, and a copy of the triples at one commit is
what a query wants. The node asks them on lanes of their own and is answered there, so that a look-up wakes
one process only, which brings itself up to date from the log when it is asked. What follows is kept by a
reasoner here, so that the node's thread only hands on its commits.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any, Final

from msgspec import msgpack, structs

from semmap.nodes.kb_node.relations.facts.derived import Derived
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
"""How many changed triples a reader may be behind."""

IDLE_S: Final = 300.0
"""After this time without a question about it, what was measured is forgotten."""


class Worker:
    """Follows the commits, and forks readers. `lanes`: one end of each; the node has the other."""

    def __init__(self, send: Callable[[FromWorker], None], lanes: Sequence[Connection]) -> None:
        self._send = send
        self._lanes = lanes
        self._dataset = Dataset(0, ())
        self._consequences: Consequences | None = None
        self._derived = Derived()
        self._measured: MeasuredRelations | None = None
        self._needed: dict[Needs, float] = {}
        """By whom it was asked: until when it is kept [s, monotonic]."""
        self._log = Log()
        self._readers: dict[int, Reader] = {}
        self.monitor = ContinuousQueryMonitor(send, self._reader)

    @property
    def connections(self) -> Iterator[Connection]:
        """Readable when somebody is done."""
        yield from (reader.control for reader in self._readers.values())
        yield from self.monitor.connections

    def take(self, message: ToWorker) -> None:
        """The triples, a commit, a command, or that a lane needs a reader."""
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
                if (reader := self._readers.pop(message.lane, None)) is not None:  # else it has gone
                    reader.end()
                    self._send(ReaderExited(lane=message.lane, signal=0))
            case StandingCommand():
                try:
                    dataset = self._dataset
                    self.monitor.handle(message.number, message.command, dataset.seq, dataset.demand)
                except errors.SemmapError as error:
                    self._send(CommandReply(number=message.number, error=errors.to_message(error)))

    def done(self, connection: Connection) -> None:
        """A reader has gone, or the one of the standing queries has answered."""
        for lane, reader in self._readers.items():
            if reader.control is connection:
                del self._readers[lane]
                self._send(ReaderExited(lane=lane, signal=reader.reap()))
                return
        self.monitor.on_ready(connection)

    def end(self) -> None:
        """Leave nobody behind."""
        for reader in self._readers.values():
            reader.end()
        self.monitor.stop_readers()

    def _load(self, load: Load) -> None:
        """Begin anew; the standing queries go on, with a look at what has changed for them."""
        demand = self._dataset.demand
        self._dataset = Dataset(load.seq, load.asserted)
        self._dataset.demand = demand
        self._consequences = (
            Consequences(load.asserted, self._dataset, load.derived_changes) if load.infers else None
        )
        self._derived = Derived(load.asserted if load.infers else ())
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
            gone, come = self._measured.after(delta, committed.placed, committed.removed)
            self._dataset.apply(Delta(seq=delta.seq, unmeasured=gone, measured=come))
            delta = structs.replace(delta, unmeasured=gone, measured=come)
        self._log.append(delta)
        self.monitor.follow(delta)
        self._begin_log_if_long()
        if any(until < time.monotonic() for until in self._needed.values()):
            self._needed = {n: until for n, until in self._needed.items() if until >= time.monotonic()}
            self._measure(self._dataset.demand)

    def _needs(self, query: str) -> Needs:
        # rdflib's parser takes long to load, and few queries need it
        from semmap.nodes.kb_node.sparql.queries.footprint import patterns_of

        known = tuple(sorted(query_prefixes(declared_in(self._dataset)).items()))
        return needs_of(patterns_of(query, known), self._derived)

    def _measure(self, demand: int) -> None:
        """Let the dataset have what is needed now, under that number."""
        gone: tuple[Triple, ...] = ()
        come: tuple[Triple, ...] = ()
        if self._measured is not None:
            standing = map(self._needs, self.monitor.inferred_queries)
            gone, come = self._measured.update_needs(Needs.merge((*self._needed, *standing)))
        delta = Delta(seq=self._dataset.seq, unmeasured=gone, measured=come, demand=demand)
        self._log.append(delta)
        self._dataset.apply(delta)
        self._begin_log_if_long()

    def _begin_log_if_long(self) -> None:
        if self._log.size > BACKLOG:
            if isinstance(self._dataset, DiskDataset):
                self._dataset.merge_log(self._log.read_all())
            self._begin_log()

    def _begin_log(self) -> None:
        """Those who read the old one cannot catch up any more: they go as soon as they have answered."""
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
