"""The process that answers SPARQL, beside the node: `python -m nodes.kb_node.sparql.worker`.

A query cannot be interrupted while Oxigraph evaluates it, nor can its memory be bounded: only a process can
be ended. Were that the one with the triples, a hanging query would cost loading them again. So this process
only keeps the triples and follows the commits, and never evaluates; its readers do, which are forked from it:
that takes some milliseconds at 10 000 entities, shares the memory, and a copy of the triples at one commit is
what a query wants. A reader that is still alive is brought up to date and asked again, so that a look-up
forks nothing. What follows is kept by a reasoner here, so that the node's thread only hands on its commits.

Standing queries have one reader to themselves, which goes through the commits that may touch them one by one.
When it falls too far behind, or has died, what is left to do is done in one step.
"""

from __future__ import annotations

import sys
import time
import uuid
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import islice
from multiprocessing.connection import Connection, wait
from typing import Any, Final

from msgspec import Raw, msgpack

from nodes.kb_node.sparql import text
from nodes.kb_node.sparql.consequences import Consequences
from nodes.kb_node.sparql.dataset import Dataset, Delta
from nodes.kb_node.sparql.protocol import (
    Answered,
    Asked,
    Committed,
    FromWorker,
    Load,
    News,
    ToWorker,
    to_worker,
)
from nodes.kb_node.sparql.readers import Reader
from nodes.kb_node.sparql.standing import Standing
from schemas import errors
from schemas.commands import Done, Renew, Sparql, Watch
from schemas.sparql import RowsChanged, SparqlResult, Watching

READERS: Final = 4
"""How many queries are evaluated at once."""
BACKLOG: Final = 50_000
"""How many changed triples a reader may be behind."""
STANDING: Final = 64
"""How many standing queries there may be."""
STANDING_ROWS: Final = 10_000
STANDING_TIMEOUT_S: Final = 2.0

_results = msgpack.Decoder(SparqlResult)


@dataclass
class Look:
    """A look at the rows of a standing query after commit `seq`; those after `since` are known."""

    standing: Standing
    since: int
    seq: int
    number: int | None = None
    """The command that waits for its first rows."""


class Worker:
    """Follows the commits, and hands queries to readers."""

    def __init__(self, send: Callable[[FromWorker], None]) -> None:
        self._send = send
        self._dataset = Dataset(0, ())
        self._consequences: Consequences | None = None
        self._log: deque[Delta] = deque()
        self._log_size = 0
        self._idle: list[Reader] = []
        self._busy: dict[Connection, tuple[Reader, int]] = {}
        self._outdated: set[Reader] = set()
        self._waiting: deque[tuple[int, Sparql]] = deque()
        self._standing: dict[str, Standing] = {}
        self._looks: deque[Look] = deque()
        self._looker: Reader | None = None
        self._looking: Look | None = None

    # What comes in

    @property
    def connections(self) -> Iterator[Connection]:
        """Those of the readers that are at work: readable means done."""
        yield from self._busy
        if self._looker is not None and self._looking is not None:
            yield self._looker.connection

    @property
    def patience_s(self) -> float | None:
        """How long nothing needs to be done without being told."""
        ends = [standing.ends for standing in self._standing.values()]
        return max(0.0, min(ends) - time.monotonic()) if ends else None

    def take(self, message: ToWorker) -> None:
        """The triples, a commit, or a command."""
        match message:
            case Load():
                self._load(message)
            case Committed():
                self._follow(message.delta)
            case Asked():
                try:
                    self._handle(message.number, message.command)
                except errors.SemmapError as error:
                    self._send(Answered(number=message.number, error=errors.to_message(error)))

    def done(self, connection: Connection) -> None:
        """A reader is."""
        if connection in self._busy:
            self._finish(*self._busy.pop(connection))
        elif self._looker is not None and connection is self._looker.connection:
            self._finish_look(self._looker)

    def go_on(self) -> None:
        """Give work to whoever has none; let leases end."""
        for standing in [s for s in self._standing.values() if s.ends <= time.monotonic()]:
            self._drop(standing)
        while self._waiting and len(self._busy) < READERS:
            number, command = self._waiting.popleft()
            reader = self._idle.pop() if self._idle else Reader(self._dataset)
            self._busy[reader.connection] = (reader, number)
            reader.begin(
                self._since(reader.seq, self._dataset.seq),
                command.query,
                inferred=command.inferred,
                limit=command.limit,
                timeout_s=command.timeout,
            )
        if self._looks and self._looking is None:
            self._look()

    def end(self) -> None:
        """Leave nobody behind."""
        for reader, _ in self._busy.values():
            reader.end()
        for idle in (*self._idle, *filter(None, (self._looker,))):
            idle.end()

    # Commands

    def _handle(self, number: int, command: Sparql | Watch | Renew) -> None:
        match command:
            case Sparql():
                text.require_reading(command.query)
                self._waiting.append((number, command))
            case Watch():
                text.require_select(command.query)
                standing = self._admit(command)
                now = self._dataset.seq
                self._looks.append(Look(standing, since=now, seq=now, number=number))
            case Renew():
                if command.watch not in self._standing:
                    raise errors.UnknownName(f"there is no standing query '{command.watch}' (any more)")
                standing = self._standing[command.watch]
                if command.end:
                    self._drop(standing)
                standing.ends = time.monotonic() + standing.lease_s
                said = "has ended" if command.end else f"goes on for {standing.lease_s:g} s"
                self._send(Answered(number=number, reply=_encoded(Done(text=f"{command.watch} {said}"))))

    def _admit(self, command: Watch) -> Standing:
        name = command.watch or f"q{uuid.uuid4().hex[:12]}"
        if name in self._standing:
            raise errors.NameTaken(f"there is a standing query '{name}' already")
        if len(self._standing) >= STANDING:
            raise errors.Refused(f"there are {STANDING} standing queries already; end one first")
        self._standing[name] = Standing.of(command, name, time.monotonic())
        return self._standing[name]

    def _drop(self, standing: Standing, error: errors.SemmapError | None = None) -> None:
        """It is over; with an error, its followers are told why."""
        self._standing.pop(standing.watch, None)
        self._looks = deque(look for look in self._looks if look.standing is not standing)
        last = error and RowsChanged(
            watch=standing.watch, seq=self._dataset.seq, since=self._dataset.seq, error=error.text
        )
        self._send(News(watch=standing.watch, rows=last or None, ended=True))

    # Commits

    def _load(self, load: Load) -> None:
        """Begin anew; the standing queries go on, with a look at what has changed for them."""
        self._dataset = Dataset(load.seq, load.asserted)
        self._consequences = Consequences(load.asserted, self._dataset) if load.infers else None
        self._outdate_readers()
        for standing in self._standing.values():
            self._looks.append(Look(standing, since=load.seq - 1, seq=load.seq))

    def _follow(self, delta: Delta) -> None:
        if self._consequences is not None:
            delta = self._consequences.after(delta)
        self._dataset.apply(delta)
        self._log.append(delta)
        for standing in self._standing.values():
            if standing.is_touched(delta):
                self._looks.append(Look(standing, since=delta.seq - 1, seq=delta.seq))
        self._log_size += len(delta.everything)
        if self._log_size > BACKLOG:
            self._outdate_readers()

    def _since(self, seq: int, until: int) -> Iterator[Delta]:
        """The commits after `seq`, up to `until`."""
        first = self._log[0].seq if self._log else self._dataset.seq + 1
        return islice(self._log, seq + 1 - first, until + 1 - first)

    # Readers

    def _outdate_readers(self) -> None:
        """Those that there are cannot catch up any more: they end as soon as they have answered."""
        while self._idle:
            self._idle.pop().end()
        self._outdated.update(reader for reader, _ in self._busy.values())
        if self._looker is not None:
            self._outdated.add(self._looker)
        self._log.clear()
        self._log_size = 0

    def _finish(self, reader: Reader, number: int) -> None:
        try:
            reply = Answered(number=number, reply=reader.finish())
        except errors.SemmapError as error:
            reply = Answered(number=number, error=errors.to_message(error))
        if self._is_usable(reader):
            self._idle.append(reader)
        self._send(reply)

    def _is_usable(self, reader: Reader) -> bool:
        """May it be asked again? If not, it ends here."""
        if reader in self._outdated:
            self._outdated.discard(reader)
            reader.end()
        return reader.is_alive

    def _look(self) -> None:
        """The next look at a standing query, by the reader that they share."""
        if self._looker is not None and not self._is_usable(self._looker):
            self._looker = None
        if self._looker is None:
            self._looker = Reader(self._dataset)
            self._looks = deque(_in_one_step(self._looks, self._dataset.seq))
        look = self._looking = self._looks.popleft()
        self._looker.begin(
            self._since(self._looker.seq, look.seq),
            look.standing.query,
            inferred=look.standing.inferred,
            limit=STANDING_ROWS,
            timeout_s=STANDING_TIMEOUT_S,
        )

    def _finish_look(self, reader: Reader) -> None:
        look, self._looking = self._looking, None
        assert look is not None
        try:
            result = _results.decode(reader.finish())
        except errors.SemmapError as error:
            if look.number is not None:
                self._send(Answered(number=look.number, error=errors.to_message(error)))
            if look.standing.watch in self._standing:
                self._drop(look.standing, error)
            return
        news = look.standing.take(result.rows, look.since, look.seq)
        if look.number is not None:
            self._send(Answered(number=look.number, reply=_encoded(_watching(look.standing, result))))
        elif news is not None and look.standing.watch in self._standing:
            self._send(News(watch=news.watch, rows=news))


def _encoded(message: Any) -> Raw:
    return Raw(msgpack.encode(message))


def _in_one_step(looks: deque[Look], seq: int) -> Iterator[Look]:
    """One look a standing query, at the present, instead of several at the past."""
    last: dict[str, Look] = {}
    for look in looks:
        earlier = last.setdefault(look.standing.watch, look)
        earlier.seq = seq
    yield from last.values()


def _watching(standing: Standing, result: SparqlResult) -> Watching:
    return Watching(
        watch=standing.watch,
        variables=result.variables,
        rows=result.rows,
        seq=result.seq,
        lease_s=standing.lease_s,
    )


def main(node: Connection) -> None:
    """Serve until the node closes the pipe."""

    def send(message: Any) -> None:
        node.send_bytes(msgpack.encode(message))

    worker = Worker(send)
    try:
        while True:
            for ready in wait([node, *worker.connections], worker.patience_s):
                if ready is node:
                    worker.take(to_worker.decode(node.recv_bytes()))
                else:
                    assert isinstance(ready, Connection)
                    worker.done(ready)
            worker.go_on()
    except (EOFError, ConnectionError, KeyboardInterrupt):
        pass
    finally:
        worker.end()


if __name__ == "__main__":
    main(Connection(int(sys.argv[1])))
