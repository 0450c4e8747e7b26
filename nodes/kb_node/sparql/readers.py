"""Readers: forked processes with a copy of the triples, which evaluate one query at a time.

A query may kill its reader. A reader receives queries on a *lane*, one end of a pair of sockets, and replies
there. The other end may be held by another process than the parent. The parent has the *control* pipe, on
which it notices the exit of the reader and retires it when its triples are too old.
"""

from __future__ import annotations

import gc
import os
import resource
import select
import signal
from contextlib import suppress
from itertools import pairwise
from multiprocessing.connection import Connection, Pipe
from typing import Final, NoReturn

from msgspec import Raw, msgpack

from semmap.nodes.kb_node.sparql.protocol import QueryOutcome, QueryRequest, questions
from semmap.nodes.kb_node.sparql.queries import text
from semmap.nodes.kb_node.sparql.queries.evaluation import evaluate
from semmap.nodes.kb_node.sparql.triples.dataset import Dataset, DiskDataset
from semmap.nodes.kb_node.sparql.triples.disk_stores import remove_clone
from semmap.nodes.kb_node.sparql.triples.log import Log
from semmap.schemas import errors

MEMORY_BYTES: Final = 1 << 30
"""Memory that a query may use in addition to the triples."""

ANSWER_BYTES: Final = 32 << 20
"""Largest size of a reply."""

_A_MOMENT_S: Final = 0.0005

_FILES_OF_A_STORE: Final = 1000


class Reader:
    """A child process with the present triples of `dataset`. It reads later commits from `log`."""

    def __init__(self, lane: Connection, dataset: Dataset, log: Log, *, infers: bool) -> None:
        """Fork a reader. `infers` means that the dataset contains inferred triples."""
        self.log = log
        self._store_path = dataset.path if isinstance(dataset, DiskDataset) else None
        self.control, remote = Pipe()
        self._pid = os.fork()
        if self._pid == 0:
            _serve(lane, remote, dataset, log, infers)
        remote.close()

    def retire(self) -> None:
        """Let the reader exit after its current query."""
        with suppress(OSError):  # it has exited
            self.control.send_bytes(b"")

    def end(self) -> int:
        """Kill the reader if it is running. Return the signal that ended it, or 0."""
        with suppress(ProcessLookupError):
            os.kill(self._pid, signal.SIGKILL)
        return self.reap()

    def reap(self) -> int:
        """Wait for the reader to exit. Return the signal that ended it, or 0."""
        _, status = os.waitpid(self._pid, 0)
        if self._store_path is not None:
            remove_clone(self._store_path, self._pid)
        self.control.close()
        return max(0, -os.waitstatus_to_exitcode(status))


def error_for_signal(number: int, timeout_s: float) -> errors.Refused:
    """Return the error for a query whose reader was ended by a signal."""
    if number == signal.SIGALRM:
        return errors.Refused(f"the query was cancelled after {timeout_s:g} s, its time limit; narrow it")
    if number == signal.SIGABRT:
        return errors.Refused(
            f"the query was cancelled: it needs more than {MEMORY_BYTES >> 20} MB of memory; narrow it"
        )
    if number == signal.SIGKILL:
        return errors.Refused("the query was cancelled: its process was killed; repeat it")
    return errors.Refused(f"the query was cancelled: it ended its process (signal {number}); simplify it")


def _serve(lane: Connection, control: Connection, dataset: Dataset, log: Log, infers: bool) -> NoReturn:
    """Run the child until its parent or client exits, it is retired, or a signal ends it."""
    try:
        dataset = _open_dataset(dataset, log, {lane.fileno(), control.fileno(), log.fileno()})
        poll = select.poll()
        for connection in (lane, control):
            poll.register(connection, select.POLLIN)
        is_old = False
        while not is_old and control.fileno() not in {fd for fd, _ in poll.poll()}:
            question = questions.decode(lane.recv_bytes())
            while not (is_old or _is_ready(question, dataset, log, infers)):
                is_old = control.poll(_A_MOMENT_S)
            lane.send_bytes(
                msgpack.encode(QueryOutcome(number=question.number, old=True))
                if is_old
                else _answer(question, dataset)
            )
    finally:
        os._exit(0)


def _open_dataset(dataset: Dataset, log: Log, fds: set[int]) -> Dataset:
    """Open the triples, and close every other file that a query could access."""
    _close_all_but(fds)
    opened = dataset.open_in_reader()
    if opened is not dataset:
        for delta in log.read_all():
            opened.apply(delta)
    _confine(0 if opened is dataset else _FILES_OF_A_STORE)
    return opened


def _is_ready(question: QueryRequest, dataset: Dataset, log: Log, infers: bool) -> bool:
    """Return whether the dataset has the requested state, after reading new commits."""
    wanted = max(question.seq, dataset.settled)
    if dataset.seq < wanted or dataset.demand < question.demand:
        for delta in log.read_new():
            dataset.apply(delta)
            if dataset.seq >= wanted and dataset.demand >= question.demand:
                break
    is_there = dataset.seq >= wanted and dataset.demand >= question.demand
    return is_there and (infers or not question.inferred)


def _answer(question: QueryRequest, dataset: Dataset) -> bytes:
    """Return the encoded outcome. The process is killed if it takes longer than the timeout."""
    signal.setitimer(signal.ITIMER_REAL, question.timeout_s)
    outcome = msgpack.encode(_evaluate(question, dataset))
    signal.setitimer(signal.ITIMER_REAL, 0.0)
    if len(outcome) <= ANSWER_BYTES:
        return outcome
    error = errors.Refused(f"the answer is longer than {ANSWER_BYTES >> 20} MB")
    return msgpack.encode(QueryOutcome(number=question.number, error=errors.to_message(error)))


def _evaluate(question: QueryRequest, dataset: Dataset) -> QueryOutcome:
    try:
        text.require_reading(question.query)
        result = evaluate(
            question.query,
            dataset,
            inferred=question.inferred,
            limit=question.limit,
            measured=question.demand > 0,
        )
        return QueryOutcome(number=question.number, result=Raw(msgpack.encode(result)))
    except errors.SemmapError as error:
        return QueryOutcome(number=question.number, error=errors.to_message(error))
    except MemoryError:
        os.abort()
    except Exception as error:
        fault = errors.InternalError(f"SPARQL failed: {type(error).__name__}: {error}")
        return QueryOutcome(number=question.number, error=errors.to_message(fault))


def _close_all_but(fds: set[int]) -> None:
    """Close all files and sockets except these."""
    gc.disable()  # a collection would touch, and so copy, all pages shared with the parent
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    most = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    nowhere = os.open(os.devnull, os.O_RDWR)
    for standard in range(3):  # otherwise Oxigraph would print that it lacks memory
        os.dup2(nowhere, standard)
    kept = [2, *sorted(fds), min(most, 1 << 16)]
    for before, after in pairwise(kept):
        os.closerange(before + 1, after)


def _confine(files: int) -> None:
    """Limit the number of files to what a store needs, and the memory."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    most = 3 + files  # the first three are in use, and poll needs a limit above zero
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
    with suppress(ValueError, OSError):  # not every system supports this limit
        resource.setrlimit(resource.RLIMIT_DATA, (_data_bytes() + MEMORY_BYTES,) * 2)


def _data_bytes() -> int:
    """Return an upper bound for the memory that this process holds now."""
    return 2 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
