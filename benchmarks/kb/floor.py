"""The lower bound for a command over Zenoh: the same chain of processes without our code.

A client asks one process, which asks another, which writes as many pages as a commit takes and waits for the
disk; both replies come back. Questions, replies and pages have the sizes of those of an `add` or a `move`.
Nothing is decoded, checked or remembered, so what is left is Zenoh, Python's callbacks, waking up and
`fdatasync`.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import NamedTuple

import psutil
import zenoh

from semmap.nodes import bus
from semmap.nodes.supervisor.ports import free_endpoint

_PAGE_BYTES = 4096 + 24
"""The size of a page in SQLite's log, with its header."""
_LOG_PAGES = 1000


class Sizes(NamedTuple):
    """Measured sizes [bytes]; pages are those of the log."""

    command: int
    transaction: int
    effects: int
    changed: int
    pages: int


class Found(NamedTuple):
    """Durations, and the CPU time per request in all three processes [ms]."""

    took_ms: list[float]
    cpu_ms: float


SIZES = {"add": Sizes(144, 339, 974, 121, 5), "move": Sizes(94, 141, 976, 155, 4)}
_RELAYED, _WRITTEN = "floor/relayed", "floor/written"


def asked(session: zenoh.Session, key: str, size: int) -> bytes:
    """Send a request of the given size and wait for the reply, like a client."""
    for reply in session.get(key, payload=bytes(size), consolidation=zenoh.ConsolidationMode.NONE):
        if reply.ok is not None:
            return reply.ok.payload.to_bytes()
    raise RuntimeError(f"no reply on {key}")


def relay(where: str, beyond: str) -> None:
    """Run the process in the place of the coordinator, until stdin is closed."""
    with bus.open_session(bus.Network(connect=(beyond,), listen=(where,), mode="peer")) as session:

        def on_query(query: zenoh.Query) -> None:
            with query:
                sizes = SIZES[_word(query)]
                asked(session, f"{_WRITTEN}/{_word(query)}", sizes.transaction)
                query.reply(query.key_expr, bytes(sizes.changed))

        session.declare_queryable(f"{_RELAYED}/*", on_query)
        _until_told()


def write(where: str, folder: str) -> None:
    """Run the process in the place of the knowledge base, until stdin is closed."""
    path = Path(folder) / "log"
    path.write_bytes(bytes(_LOG_PAGES * _PAGE_BYTES))
    log, at = os.open(path, os.O_RDWR), 0
    os.fsync(log)
    with bus.open_session(bus.Network(connect=(), listen=(where,), mode="peer")) as session:

        def on_query(query: zenoh.Query) -> None:
            nonlocal at
            with query:
                sizes = SIZES[_word(query)]
                for _ in range(sizes.pages):
                    os.pwrite(log, os.urandom(_PAGE_BYTES), at * _PAGE_BYTES)
                    at = (at + 1) % _LOG_PAGES
                os.fdatasync(log)
                query.reply(query.key_expr, bytes(sizes.effects))

        session.declare_queryable(f"{_WRITTEN}/*", on_query)
        _until_told()


def _word(query: zenoh.Query) -> str:
    return str(query.key_expr).rpartition("/")[2]


def _until_told() -> None:
    print("ready", flush=True)
    sys.stdin.read()


@contextmanager
def chain(folder: str) -> Iterator[Callable[[str, int], Found]]:
    """Yield `do(word, count)`, which queries the chain of processes; their file is in `folder`."""
    first, last = free_endpoint(), free_endpoint()
    with ExitStack() as stack:
        processes = [
            stack.enter_context(_process("write", last, folder)),
            stack.enter_context(_process("relay", first, last)),
        ]
        session = stack.enter_context(bus.open_session(bus.Network(connect=(first,), mode="peer")))
        while not session.info.peers_zid():
            time.sleep(0.01)
        counted = [psutil.Process(), *(psutil.Process(process.pid) for process in processes)]

        def do(word: str, count: int) -> Found:
            before_s, found = _cpu_s(counted), []
            for _ in range(count):
                began_s = time.perf_counter()
                asked(session, f"{_RELAYED}/{word}", SIZES[word].command)
                found.append((time.perf_counter() - began_s) * 1e3)
            return Found(found, (_cpu_s(counted) - before_s) * 1e3 / count)

        yield do


@contextmanager
def _process(*words: str) -> Iterator[subprocess.Popen[str]]:
    """Start this file as another process and wait until it is ready; its stdin is closed after the block."""
    command = [sys.executable, "-P", __file__, *words]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdin is not None
        if process.stdout.readline() != "ready\n":
            raise RuntimeError(f"{words[0]} did not start")
        try:
            yield process
        finally:
            process.stdin.close()


def _cpu_s(processes: Sequence[psutil.Process]) -> float:
    times = [process.cpu_times() for process in processes]
    return float(sum(t.user + t.system for t in times))


def main() -> None:
    """Run one of the processes."""
    bus.set_reader_threads()
    match sys.argv[1:]:
        case ["relay", where, beyond]:
            relay(where, beyond)
        case ["write", where, folder]:
            write(where, folder)


if __name__ == "__main__":
    main()
