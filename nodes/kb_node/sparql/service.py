"""The interface of the node to SPARQL: commits in, future results and row changes out.

The first query starts the process, which follows the commits from then on. Separate threads serve its pipe
and the lanes of its readers, so that the node's thread never waits.
"""

from __future__ import annotations

import logging
import queue
import subprocess
import sys
import threading
from collections.abc import Callable, Iterable
from concurrent.futures import Future
from itertools import count
from multiprocessing.connection import Connection, Pipe
from typing import Any, overload

from msgspec import msgpack

from semmap.nodes.kb_node.derived_facts import UNCHANGED, DerivedChanges
from semmap.nodes.kb_node.reasoner.rules.facts import Facts, pack
from semmap.nodes.kb_node.relations.facts.pair_properties import PairProperties
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.sparql.lanes import Lanes
from semmap.nodes.kb_node.sparql.protocol import (
    CommandReply,
    Committed,
    Load,
    LoadFromDisk,
    MeasurementRequest,
    Placements,
    QueryUpdate,
    ReaderExited,
    StandingCommand,
    from_worker,
)
from semmap.nodes.kb_node.sparql.queries.predicates import may_use_properties
from semmap.nodes.kb_node.sparql.triples.dataset import Delta
from semmap.nodes.kb_node.sparql.triples.large_map import FilledStore, LargeMap, delta_of
from semmap.nodes.runtime.futures import settle
from semmap.ontology import vocabulary as v
from semmap.schemas import codec, errors
from semmap.schemas.calls import Call, reply_type
from semmap.schemas.commands import Renew, Sparql, Watch
from semmap.schemas.commits import Commit
from semmap.schemas.explanations import Triple
from semmap.schemas.replies import Done
from semmap.schemas.sparql import SparqlResult, Watching

log = logging.getLogger(__name__)


class SparqlService:
    """Evaluates SPARQL queries. Owned by the node's thread."""

    def __init__(
        self,
        asserted: Callable[[], Iterable[Triple]],
        publish: Callable[[QueryUpdate], None],
        large_map: LargeMap | None = None,
        derived_changes: Callable[[], DerivedChanges] = DerivedChanges,
        placements: Callable[[], Placements] | None = None,
        closed: Callable[[], Facts | None] = lambda: None,
    ) -> None:
        """Create the service; `asserted()` returns the present triples, and `publish` receives row changes.

        `derived_changes()` returns the computed and suppressed facts. `placements()` returns the poses, for
        queries that need measurements. `closed()` returns the closure of the TBox, if it is known, so that
        the process does not compute it again.

        With a `large_map` the triples of a large map are in a store on disk. The store is created in the
        background: after a large commit immediately, otherwise at the first query. Inferred triples are
        always kept in memory.
        """
        self._asserted = asserted
        self._derived_changes = derived_changes
        self._placements = placements
        self._closed = closed
        self._measured: frozenset[str] = frozenset()
        """The local names of the properties that must be measured."""
        self._measures = False
        """Whether a query has requested measurements."""
        self._demands = count(1)
        self._publish = publish
        self._large = large_map
        self._worker: _Worker | None = None
        self._infers = False
        self._seq = 0
        self._since_filling: list[Delta] | None = None
        """While a store is created: the commits since its start."""
        self._deferred: list[Callable[[], None]] = []
        """Commands about standing queries that wait for the triples."""

    @overload
    def ask(self, command: Sparql, seq: int, asker: str = ...) -> Future[SparqlResult]: ...
    @overload
    def ask(self, command: Watch, seq: int, asker: str = ...) -> Future[Watching]: ...
    @overload
    def ask(self, command: Renew, seq: int, asker: str = ...) -> Future[Done]: ...
    def ask(self, command: Sparql | Watch | Renew, seq: int, asker: str = "") -> Future[Any]:
        """Return the reply to a command of `asker` about the map after commit `seq`."""
        self._seq = seq
        if self._worker is None or not self._worker.is_alive:
            if isinstance(command, Renew):
                raise errors.UnknownName(f"there is no standing query '{command.watch}', or it has ended")
            self._worker = _Worker(self._publish)
            self._measures = False
            self._infers = command.inferred
            self._load()
        elif not isinstance(command, Renew) and command.inferred and not self._infers:
            self._infers = True
            self._load()
        demand = 0 if isinstance(command, Renew) else self._demand(self._worker, command)
        if self._since_filling is None or isinstance(command, Sparql):  # it waits for its commit itself
            return self._worker.ask(command, seq, demand, asker)
        worker, future = self._worker, Future[Any]()
        self._deferred.append(lambda: settle(future, lambda: worker.ask(command, self._seq)))
        return future

    def _demand(self, worker: _Worker, command: Sparql | Watch) -> int:
        """Request the measurements that a query may need. Return their number, or 0 if it needs none."""
        query = command.query
        if self._placements is None or not command.inferred or not self._measured or query is None:
            return 0
        if not may_use_properties(query, self._measured):
            return 0
        if not self._measures:
            self._measures = True
            worker.send(self._placements())
        demand = next(self._demands)
        worker.send(MeasurementRequest(demand=demand, query=query))
        return demand

    def prefetch(self, commit_id: str, turtle: bytes, base: str, *, packed: bytes = b"") -> None:
        """Start to load a Turtle document that the commit with this id will insert.

        `discard_prepared` cancels that. `packed` is the compressed document, if it was compressed.
        """
        if self._large is not None and not self._infers and self._since_filling is None:
            self._large.prefetch(commit_id, turtle, base, packed=packed)

    def discard_prepared(self) -> None:
        """Discard the document that was prefetched."""
        if self._large is not None:
            self._large.discard()

    def prepare(self, commit: Commit) -> Callable[[], None]:
        """Prepare for a commit that is being checked. The returned function aborts the preparation."""
        if self._large is None or self._infers or self._since_filling is not None:
            return lambda: None
        return self._large.prepare(commit)

    def follow(self, commit: Commit, derived_changes: DerivedChanges = UNCHANGED) -> None:
        """Apply a commit, with its changes of computed facts. Commits must come in order."""
        self._seq = commit.seq
        is_much = self._large is not None and self._large.is_large_change(commit)
        if commit.tbox:
            self._since_filling = None  # the store that is being created has the previous TBox
        if self._since_filling is not None:
            self._since_filling.append(delta_of(commit))
        elif is_much and not self._infers:
            self._fill(commit)
        elif self._worker is None:
            return
        elif commit.tbox:
            self._load()
        else:
            self._worker.send(
                Committed(
                    delta=delta_of(commit),
                    derived_changes=derived_changes if self._infers else UNCHANGED,
                    placed=tuple(map(PlacedEntity.of, commit.changed)) if self._measures else (),
                    removed=tuple(departed.name for departed in commit.removed) if self._measures else (),
                )
            )

    def reload(self) -> None:
        """Send computed facts and shapes to the process again, because they have changed without a commit.

        A query that comes at the same moment may still see the earlier ones.
        """
        if self._infers:
            self._load()

    def _load(self) -> None:
        """Send the present map to the process."""
        if self._worker is None:
            return
        if self._infers or self._large is None or not self._large.is_large:
            self._since_filling = None
            self._load_into_memory(self._worker)
        elif self._since_filling is None:
            kept = self._large.find_store(self._seq)
            if kept is None:
                self._fill()
            else:
                self._use_store(*kept)

    def _fill(self, commit: Commit | None = None) -> None:
        if self._large is None:
            raise errors.InternalError("only a large map has a store of its own")
        since: list[Delta] = []
        self._since_filling = since

        def on_done(done: Future[FilledStore]) -> None:
            if self._since_filling is not since:
                return  # it is not needed any more
            self._since_filling = None
            if (error := done.exception()) is None:
                self._use_store(done.result(), since)
            elif self._worker is not None:
                log.warning("SPARQL keeps its triples in memory: %s", error)
                self._load_into_memory(self._worker)

        self._large.fill(self._seq, lambda: self._seq, commit).add_done_callback(on_done)

    def _load_into_memory(self, worker: _Worker) -> None:
        derived_changes = self._derived_changes() if self._infers else UNCHANGED
        closed = self._closed() if self._infers else None
        asserted = tuple(self._asserted())
        placements = None
        if self._infers and self._placements is not None:
            self._measured = frozenset(map(v.local_name, PairProperties(asserted).sources))
            if self._measures:
                placements = self._placements()
        worker.send(
            Load(
                seq=self._seq,
                asserted=asserted,
                infers=self._infers,
                derived_changes=derived_changes,
                closure=b"" if closed is None else pack(closed),
                placements=placements,
            )
        )
        self._run_deferred()

    def _use_store(self, store: FilledStore, since: Iterable[Delta]) -> None:
        if self._worker is not None:
            self._worker.send(LoadFromDisk(path=str(store.path), seq=store.seq, settled=store.settled))
            for delta in since:
                self._worker.send(Committed(delta=delta))
        self._run_deferred()

    def _run_deferred(self) -> None:
        """Run the commands that waited for the triples, which have been sent."""
        later, self._deferred = self._deferred, []
        for ask in later:
            ask()

    def close(self) -> None:
        """Stop the process."""
        if self._large is not None:
            self._large.close()
        if self._worker is not None:
            self._worker.close()
            self._worker = None


class _Worker:
    """The running process."""

    def __init__(self, publish: Callable[[QueryUpdate], None]) -> None:
        self._publish = publish
        self._numbers = count()
        self._outbox: queue.SimpleQueue[tuple[Connection, Any] | None] = queue.SimpleQueue()
        self._waiting: dict[int, tuple[type[Call], Future[Any]]] = {}
        self._lock = threading.Lock()
        self.is_alive = True
        self._connection, remote = Pipe()
        self._lanes = Lanes(self.send)
        theirs = [remote, *self._lanes.remote_ends]
        fds = [connection.fileno() for connection in theirs]
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "semmap.nodes.kb_node.sparql.worker", *map(str, fds)],
            pass_fds=fds,
            stdin=subprocess.DEVNULL,
        )
        for connection in theirs:
            connection.close()
        self._writer = threading.Thread(target=self._write, name="sparql", daemon=True)
        self._writer.start()
        threading.Thread(target=self._read, name="sparql", daemon=True).start()

    def send(self, message: Any, connection: Connection | None = None) -> None:
        """Queue a message."""
        if self.is_alive:
            self._outbox.put((connection or self._connection, message))

    def ask(self, command: Sparql | Watch | Renew, seq: int, demand: int = 0, asker: str = "") -> Future[Any]:
        """Return the reply as of commit `seq` or later, with the measurements of request `demand`."""
        with self._lock:
            if self.is_alive:
                if isinstance(command, Sparql):
                    return self._lanes.ask(command, seq, demand, asker)
                number, future = next(self._numbers), Future[Any]()
                self._waiting[number] = (type(command), future)
                self.send(StandingCommand(number=number, command=command))
                return future
        future = Future()
        future.set_exception(_ended())
        return future

    def close(self) -> None:
        """Stop the process."""
        self._process.terminate()
        self._process.wait()

    def _write(self) -> None:
        try:
            while (item := self._outbox.get()) is not None:
                connection, message = item
                connection.send_bytes(msgpack.encode(message))
        except OSError:
            pass  # `_read` notices it, too

    def _read(self) -> None:
        try:
            while True:
                match from_worker.decode(self._connection.recv_bytes()):
                    case QueryUpdate() as news:
                        self._publish(news)
                    case ReaderExited() as left:
                        self._lanes.on_reader_exit(left)
                    case answered:
                        self._answer(answered)
        except (EOFError, OSError):
            pass
        finally:
            self._reap()

    def _reap(self) -> None:
        """Fail all waiting requests after the process has ended."""
        with self._lock:
            self.is_alive = False
            left = list(self._waiting.values())
            self._waiting.clear()
        self._outbox.put(None)
        self._process.kill()
        self._process.wait()
        for _, future in left:
            future.set_exception(_ended())
        self._lanes.close(_ended())
        self._writer.join()
        self._connection.close()

    def _answer(self, message: CommandReply) -> None:
        with self._lock:
            kind, future = self._waiting.pop(message.number)
        if message.error is not None:
            future.set_exception(errors.from_message(message.error))
        else:
            future.set_result(codec.decode(bytes(message.reply), reply_type(kind)))


def _ended() -> errors.Refused:
    return errors.Refused("the SPARQL process has ended; repeat the query to start a new one")
