"""A process for files of unknown origin: a file that crashes a parser, or needs too much, does no more harm.

`IsolatedProcess` starts a program that calls `serve`. The program answers one request after another, within
limits of memory and time, and ends when its connection is closed.
"""

from __future__ import annotations

import math
import os
import resource
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection, Pipe
from pathlib import Path
from typing import Final, Self

from semmap.schemas import errors

CPU_S: Final = 300.0
"""Limit of the CPU time for a file."""
MEMORY_BYTES: Final = max(1 << 30, os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") // 2)
"""Limit of the memory of a process."""
_OUT_OF_MEMORY: Final = 77
"""The exit status after a failed allocation that Python noticed."""
_WALL_PER_CPU: Final = 2.0
"""How much longer than its CPU time a request may take on a busy machine."""
_START_S: Final = 30.0
"""Time in which a process starts on a busy machine."""
_END_S: Final = 10.0
"""Time in which a process ends after it closed its connection."""
_LARGE: Final = 1 << 20
"""Size of a message from which its process is not kept for the next one, because its memory grew [bytes]."""


def program(module: str) -> tuple[str, ...]:
    """Return the command that runs a module as a program."""
    return (sys.executable, "-P", "-m", module)


class IsolatedProcess:
    """Answers one request at a time. The process starts with the first request."""

    remedy = "use a smaller file"
    """What to do with a file that exceeds a limit."""
    repair = "save it with another program"
    """What to do with a file that crashes its parser."""

    def __init__(self, command: Sequence[str], *, cpu_s: float = CPU_S) -> None:
        """Create it. The program of `command` calls `serve`, and a request may take `cpu_s` of CPU time."""
        self._command = command
        self._cpu_s = cpu_s
        self._turn = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._connection: Connection | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def exchange(self, request: bytes, subject: str, *, wall_s: float | None = None) -> bytes:
        """Return the reply to a request. Any thread may call this.

        Raises BadFile for a request that ends the process or exceeds a limit; `subject` is the file in its
        text. `wall_s` is another limit of the elapsed time.
        """
        with self._turn:
            reply = self._exchange(request, subject, wall_s or _START_S + _WALL_PER_CPU * self._cpu_s)
            if max(len(request), len(reply)) > _LARGE:
                self._discard()
            return reply

    def _exchange(self, request: bytes, subject: str, wall_s: float) -> bytes:
        process, connection = self._started()
        try:
            connection.send_bytes(request)
            if connection.poll(wall_s):
                return connection.recv_bytes()
            status: int = -signal.SIGXCPU
        except (EOFError, OSError):
            with suppress(subprocess.TimeoutExpired):
                process.wait(_END_S)
            process.kill()
            status = process.wait()
        self._discard()
        raise errors.BadFile(f"{subject} {self._describe(status)}")

    def _started(self) -> tuple[subprocess.Popen[bytes], Connection]:
        if self._process is None or self._connection is None or self._process.poll() is not None:
            self._discard()
            try:
                self._connection, remote = Pipe()
                with remote:
                    self._process = subprocess.Popen(
                        [*self._command, str(remote.fileno()), str(self._cpu_s)],
                        pass_fds=[remote.fileno()],
                        stdin=subprocess.DEVNULL,
                    )
            except OSError as error:
                raise errors.Refused(f"the parser does not start: {error.strerror}; try again") from None
        return self._process, self._connection

    def close(self) -> None:
        """Stop the process. A request in work is rejected."""
        if (process := self._process) is not None:
            process.kill()
        with self._turn:
            self._discard()

    def _discard(self) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.wait()
        if self._connection is not None:
            self._connection.close()
        self._process = self._connection = None

    def _describe(self, status: int) -> str:
        """Return what a file did to its process, and the next step."""
        if status == -signal.SIGXCPU:
            return f"takes longer than {self._cpu_s:g} s to read; {self.remedy}"
        if status == -signal.SIGKILL:  # by the kernel, or by `semmap up` because it was stopped
            return "was not read: its process was killed, as happens when memory is short; try it again"
        if status in (_OUT_OF_MEMORY, -signal.SIGABRT):
            return f"needs more than {MEMORY_BYTES >> 20} MB of memory to read; {self.remedy}"
        return f"cannot be read: it ended the parser (status {status}); {self.repair}"


def serve(answer: Callable[[bytes], bytes], *, memory_bytes: int = MEMORY_BYTES) -> None:
    """Answer the requests of an `IsolatedProcess` within its limits, until it closes the connection."""
    connection, cpu_s = Connection(int(sys.argv[1])), float(sys.argv[2])
    _let_kernel_end_first()
    _limit_memory(memory_bytes)
    try:
        while True:
            request = connection.recv_bytes()
            _limit_cpu(cpu_s)
            connection.send_bytes(answer(request))
    except EOFError:
        pass
    except MemoryError:
        sys.exit(_OUT_OF_MEMORY)


@contextmanager
def limited(cpu_s: float = CPU_S) -> Iterator[None]:
    """Limit the CPU time and the memory of this process within the context.

    Beyond the limits, SIGXCPU ends the process, or MemoryError is raised.
    """
    before = resource.getrlimit(resource.RLIMIT_CPU)
    _limit_cpu(cpu_s)
    try:
        with limited_memory():
            yield
    finally:
        resource.setrlimit(resource.RLIMIT_CPU, before)


@contextmanager
def limited_memory(memory_bytes: int = MEMORY_BYTES) -> Iterator[None]:
    """Limit the memory that this process may allocate within the context; beyond it, raise MemoryError."""
    before = resource.getrlimit(resource.RLIMIT_AS)
    _limit_memory(memory_bytes)
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)


def _limit_cpu(cpu_s: float) -> None:
    """Limit the CPU time of this process from now on. The kernel sends SIGXCPU beyond it."""
    _set_limit(resource.RLIMIT_CPU, math.ceil(time.process_time() + cpu_s))


def _limit_memory(memory_bytes: int) -> None:
    """Limit the memory that this process may allocate from now on."""
    used = 0
    with suppress(OSError):  # only Linux has it
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    _set_limit(resource.RLIMIT_AS, used + memory_bytes)


def _set_limit(kind: int, limit: int) -> None:
    """Set a limit of this process, at most the one that it was started with (`ulimit`)."""
    _, most = resource.getrlimit(kind)
    resource.setrlimit(kind, (limit if most == resource.RLIM_INFINITY else min(limit, most), most))


def _let_kernel_end_first() -> None:
    """Write no core file, and let the kernel end this process before others when memory is short."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with suppress(OSError):  # only Linux has it
        Path("/proc/self/oom_score_adj").write_text("1000")
