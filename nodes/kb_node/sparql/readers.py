"""A reader: a forked process with a copy of the triples; it evaluates a query at a time and may die of it.

It takes its questions from a *lane*, one end of a pair of sockets, and gives the answers there. The one who
holds the other end need not be the one who forked it: that one has the *control*, on which it learns of the
reader's end, and lets it go when its triples are too old.
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
"""What a query may use beyond the triples."""

ANSWER_BYTES: Final = 32 << 20
"""How long an answer may be."""

_A_MOMENT_S: Final = 0.0005

_FILES_OF_A_STORE: Final = 1000


class Reader:
    """A child process with the triples of `dataset` as they are now; `log` tells it what comes later."""

    def __init__(self, lane: Connection, dataset: Dataset, log: Log, *, infers: bool) -> None:
        """`infers`: what follows is in the dataset, too."""
        self.log = log
        self._store_path = dataset.path if isinstance(dataset, DiskDataset) else None
        self.control, there = Pipe()
        self._pid = os.fork()
        if self._pid == 0:
            _serve(lane, there, dataset, log, infers)
        there.close()

    def retire(self) -> None:
        """Let it go as soon as it has answered."""
        with suppress(OSError):  # it has gone
            self.control.send_bytes(b"")

    def end(self) -> int:
        """Kill it if it still lives; the signal that it died of, or 0."""
        with suppress(ProcessLookupError):
            os.kill(self._pid, signal.SIGKILL)
        return self.reap()

    def reap(self) -> int:
        """Wait for its end; the signal that it died of, or 0."""
        _, status = os.waitpid(self._pid, 0)
        if self._store_path is not None:
            remove_clone(self._store_path, self._pid)
        self.control.close()
        return max(0, -os.waitstatus_to_exitcode(status))


def error_for_signal(number: int, timeout_s: float) -> errors.Refused:
    """What a query did that made its reader die of a signal."""
    if number == signal.SIGALRM:
        return errors.Refused(f"the query was cancelled after {timeout_s:g} s, its time limit; narrow it")
    if number == signal.SIGABRT:
        return errors.Refused(
            f"the query was cancelled: it needs more than {MEMORY_BYTES >> 20} MB of memory; narrow it"
        )
    return errors.Refused(f"the query was cancelled: its process was ended by signal {number}")


def _serve(lane: Connection, control: Connection, dataset: Dataset, log: Log, infers: bool) -> NoReturn:
    """The child's life: it ends with its parent's or its asker's, when it is let go, or with a signal."""
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
    """The triples, with nothing else left open that a query could reach."""
    _close_all_but(fds)
    opened = dataset.open_in_reader()
    if opened is not dataset:
        for delta in log.read_all():
            opened.apply(delta)
    _confine(0 if opened is dataset else _FILES_OF_A_STORE)
    return opened


def _is_ready(question: QueryRequest, dataset: Dataset, log: Log, infers: bool) -> bool:
    """Whether the dataset is what is asked about, after the commits that have come."""
    wanted = max(question.seq, dataset.settled)
    if dataset.seq < wanted or dataset.demand < question.demand:
        for delta in log.read_new():
            dataset.apply(delta)
            if dataset.seq >= wanted and dataset.demand >= question.demand:
                break
    is_there = dataset.seq >= wanted and dataset.demand >= question.demand
    return is_there and (infers or not question.inferred)


def _answer(question: QueryRequest, dataset: Dataset) -> bytes:
    """The outcome, encoded, if it comes in time: else the process ends."""
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
    """No files and no sockets but these."""
    gc.disable()  # a collection would touch, and so copy, all pages that are shared with the parent
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    most = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    nowhere = os.open(os.devnull, os.O_RDWR)
    for standard in range(3):  # to the last Oxigraph would complain of having no memory
        os.dup2(nowhere, standard)
    kept = [2, *sorted(fds), min(most, 1 << 16)]
    for before, after in pairwise(kept):
        os.closerange(before + 1, after)


def _confine(files: int) -> None:
    """No more files than a store needs, and not all of the machine's memory."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    most = 3 + files  # the first three are taken; none would forbid to poll
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
    with suppress(ValueError, OSError):  # not every system bounds memory so
        resource.setrlimit(resource.RLIMIT_DATA, (_data_bytes() + MEMORY_BYTES,) * 2)


def _data_bytes() -> int:
    """The most that this process can hold by now, in any case."""
    return 2 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
