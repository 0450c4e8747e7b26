"""SPARQL as the knowledge base's node sees it: commits go in, futures and news come out.

The process is started by the first question and follows from then on. Two threads mind its pipe, so that the
node's own never waits for it.
"""

from __future__ import annotations

import queue
import subprocess
import sys
import threading
from collections.abc import Callable, Iterable
from concurrent.futures import Future
from itertools import count
from multiprocessing.connection import Connection, Pipe
from typing import Any

from msgspec import msgpack

from nodes.kb_node.sparql.dataset import Delta
from nodes.kb_node.sparql.protocol import Answered, Asked, Committed, Load, News, from_worker
from schemas import codec, errors
from schemas.bridge import BRIDGE
from schemas.commands import Renew, Sparql, Watch
from schemas.commits import Commit
from schemas.explanations import Triple


class SparqlService:
    """Owned by the node's thread. `asserted()` is what the map says now, `publish` gets the news."""

    def __init__(self, asserted: Callable[[], Iterable[Triple]], publish: Callable[[News], None]) -> None:
        self._asserted = asserted
        self._publish = publish
        self._worker: _Worker | None = None
        self._infers = False

    def ask(self, command: Sparql | Watch | Renew, seq: int) -> Future[Any]:
        """The reply to a command about the map as it is now, after commit `seq`."""
        if self._worker is None or not self._worker.is_alive:
            if isinstance(command, Renew):
                raise errors.UnknownName(f"there is no standing query '{command.watch}' (any more)")
            self._worker = _Worker(self._publish)
            self._infers = command.inferred
            self._load(self._worker, seq)
        elif not isinstance(command, Renew) and command.inferred and not self._infers:
            self._infers = True
            self._load(self._worker, seq)
        return self._worker.ask(command)

    def follow(self, commit: Commit) -> None:
        """Every commit, in order."""
        if self._worker is None:
            return
        if commit.tbox:
            self._load(self._worker, commit.seq)
        else:
            delta = Delta(seq=commit.seq, retracted=commit.retracted, inserted=commit.inserted)
            self._worker.send(Committed(delta=delta))

    def _load(self, worker: _Worker, seq: int) -> None:
        worker.send(Load(seq=seq, asserted=tuple(self._asserted()), infers=self._infers))

    def close(self) -> None:
        """End the process."""
        if self._worker is not None:
            self._worker.close()
            self._worker = None


class _Worker:
    """The process, while it lives."""

    def __init__(self, publish: Callable[[News], None]) -> None:
        self._publish = publish
        self._numbers = count()
        self._outbox: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._waiting: dict[int, tuple[str, Future[Any]]] = {}
        self._lock = threading.Lock()
        self.is_alive = True
        self._connection, there = Pipe()
        module = "nodes.kb_node.sparql.worker"
        self._process = subprocess.Popen(
            [sys.executable, "-m", module, str(there.fileno())],
            pass_fds=[there.fileno()],
            stdin=subprocess.DEVNULL,
        )
        there.close()
        for target in (self._write, self._read):
            threading.Thread(target=target, args=(self._connection,), name="sparql", daemon=True).start()

    def send(self, message: Any) -> None:
        """Queue a message."""
        if self.is_alive:
            self._outbox.put(message)

    def ask(self, command: Sparql | Watch | Renew) -> Future[Any]:
        """Queue a command."""
        number, future = next(self._numbers), Future[Any]()
        with self._lock:
            if self.is_alive:
                self._waiting[number] = (str(command.__struct_config__.tag), future)
                self._outbox.put(Asked(number=number, command=command))
                return future
        future.set_exception(_ended())
        return future

    def close(self) -> None:
        """End it."""
        self._process.terminate()
        self._process.wait()

    def _write(self, connection: Connection) -> None:
        try:
            while (message := self._outbox.get()) is not None:
                connection.send_bytes(msgpack.encode(message))
        except OSError:
            pass  # `_read` sees the end, too

    def _read(self, connection: Connection) -> None:
        try:
            while True:
                message = from_worker.decode(connection.recv_bytes())
                if isinstance(message, News):
                    self._publish(message)
                else:
                    self._answer(message)
        except (EOFError, OSError):
            pass
        finally:
            self._bury(connection)

    def _bury(self, connection: Connection) -> None:
        """Nobody waits for it any more."""
        with self._lock:
            self.is_alive = False
            left = list(self._waiting.values())
            self._waiting.clear()
        self._outbox.put(None)
        self._process.kill()
        self._process.wait()
        connection.close()
        for _, future in left:
            future.set_exception(_ended())

    def _answer(self, message: Answered) -> None:
        with self._lock:
            verb, future = self._waiting.pop(message.number)
        if message.error is not None:
            future.set_exception(errors.from_message(message.error))
        else:
            future.set_result(codec.decode(bytes(message.reply), BRIDGE[verb][1]))


def _ended() -> errors.Refused:
    return errors.Refused("the process that answers SPARQL has ended; ask again, and a new one starts")
