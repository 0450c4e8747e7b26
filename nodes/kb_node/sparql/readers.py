"""A reader: a forked process with a copy of the triples; it evaluates a query at a time and may die of it."""

from __future__ import annotations

import gc
import os
import resource
import signal
from collections.abc import Iterable
from contextlib import suppress
from multiprocessing.connection import Connection, Pipe
from typing import Final, NoReturn

from msgspec import Raw, Struct, msgpack

from nodes.kb_node.sparql.dataset import Dataset, Delta
from nodes.kb_node.sparql.evaluation import answer
from nodes.kb_node.sparql.protocol import NOTHING
from schemas import errors
from schemas.errors import ErrorMessage

MEMORY_BYTES: Final = 1 << 30
"""What a query may use beyond the triples."""

ANSWER_BYTES: Final = 32 << 20
"""How long an answer may be."""


class Task(Struct, frozen=True, kw_only=True):
    """A query, and the commits that come before it."""

    deltas: tuple[Delta, ...]
    query: str
    inferred: bool
    limit: int
    timeout_s: float


class Outcome(Struct, frozen=True, kw_only=True):
    """What came of it: a `SparqlResult`, encoded, or the error."""

    result: Raw = NOTHING
    error: ErrorMessage | None = None


_TOO_LONG = msgpack.encode(
    Outcome(error=errors.to_message(errors.Refused(f"the answer is longer than {ANSWER_BYTES >> 20} MB")))
)
_tasks = msgpack.Decoder(Task)
_outcomes = msgpack.Decoder(Outcome)


class Reader:
    """A child process with the triples of `dataset` as they are now. `seq`: the commit it has come to."""

    def __init__(self, dataset: Dataset) -> None:
        self.seq = dataset.seq
        self.connection, there = Pipe()
        self._timeout_s = 0.0
        self._pid = os.fork()
        if self._pid == 0:
            _serve(there, dataset)
        there.close()

    def begin(
        self, deltas: Iterable[Delta], query: str, *, inferred: bool, limit: int, timeout_s: float
    ) -> None:
        """Apply `deltas`, then evaluate; `connection` becomes readable when it is done."""
        task = Task(deltas=tuple(deltas), query=query, inferred=inferred, limit=limit, timeout_s=timeout_s)
        self._timeout_s = timeout_s
        if task.deltas:
            self.seq = task.deltas[-1].seq
        with suppress(OSError):  # if it is dead, `finish` tells
            self.connection.send_bytes(msgpack.encode(task))

    def finish(self) -> Raw:
        """The `SparqlResult`, encoded.

        Raises the query's error; Refused when the process had to die, and then it is gone.
        """
        try:
            outcome = _outcomes.decode(self.connection.recv_bytes())
        except (EOFError, OSError):
            raise self._post_mortem() from None
        if outcome.error is not None:
            raise errors.from_message(outcome.error)
        return outcome.result

    @property
    def is_alive(self) -> bool:
        """Can it be asked again?"""
        return self._pid != 0

    def end(self) -> None:
        """Kill it, whatever it does."""
        if self._pid:
            os.kill(self._pid, signal.SIGKILL)
            self._reap()

    def _reap(self) -> int:
        _, status = os.waitpid(self._pid, 0)
        self._pid = 0
        self.connection.close()
        return os.waitstatus_to_exitcode(status)

    def _post_mortem(self) -> errors.Refused:
        died_of = -self._reap()
        if died_of == signal.SIGALRM:
            return errors.Refused(
                f"the query was cancelled after {self._timeout_s:g} s, its time limit; narrow it"
            )
        if died_of == signal.SIGABRT:
            return errors.Refused(
                f"the query was cancelled: it needs more than {MEMORY_BYTES >> 20} MB of memory; narrow it"
            )
        return errors.Refused(f"the query was cancelled: its process ended by signal {died_of}")


def _serve(connection: Connection, dataset: Dataset) -> NoReturn:
    """The child's life: it ends with its parent's, or with a signal."""
    try:
        _confine(connection.fileno())
        while True:
            task = _tasks.decode(connection.recv_bytes())
            for delta in task.deltas:
                dataset.apply(delta)
            signal.setitimer(signal.ITIMER_REAL, task.timeout_s)
            outcome = msgpack.encode(_evaluate(task, dataset))
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            connection.send_bytes(outcome if len(outcome) <= ANSWER_BYTES else _TOO_LONG)
    finally:
        os._exit(0)


def _confine(fd: int) -> None:
    """Nothing but this pipe: no files, no sockets, and not all of the machine's memory."""
    gc.disable()  # a collection would touch, and so copy, all pages that are shared with the parent
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    most = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # where Oxigraph would complain of having no memory
    os.closerange(0, 2)
    os.closerange(3, fd)
    os.closerange(fd + 1, min(most, 1 << 16))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_NOFILE, (0, 0))
    with suppress(ValueError, OSError):  # not every system bounds memory so
        resource.setrlimit(resource.RLIMIT_DATA, (_data_bytes() + MEMORY_BYTES,) * 2)


def _data_bytes() -> int:
    """The most that this process can hold by now, in any case."""
    return 2 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def _evaluate(task: Task, dataset: Dataset) -> Outcome:
    try:
        result = answer(task.query, dataset, inferred=task.inferred, limit=task.limit)
        return Outcome(result=Raw(msgpack.encode(result)))
    except errors.SemmapError as error:
        return Outcome(error=errors.to_message(error))
    except MemoryError:
        os.abort()
    except Exception as error:
        fault = errors.InternalError(f"a fault in SPARQL: {type(error).__name__}: {error}")
        return Outcome(error=errors.to_message(fault))
