"""A request costs its process at most, and is then rejected in one line."""

import os
import signal
import sys

import pytest

from semmap.nodes.runtime import isolated_process
from semmap.nodes.runtime.isolated_process import IsolatedProcess, limited, limited_memory
from semmap.schemas import errors

RECEIVE = """
import os, signal, sys
from multiprocessing.connection import Connection
connection = Connection(int(sys.argv[1]))
connection.recv_bytes()
"""
SERVE = """
from semmap.nodes.runtime.isolated_process import serve
def answer(request):
    {}
    return request
serve(answer, memory_bytes=1 << 30)
"""


def running(program):
    return IsolatedProcess([sys.executable, "-P", "-c", program], cpu_s=1.0)


@pytest.mark.process
@pytest.mark.parametrize(
    ("end", "text"),
    [
        ("os.kill(os.getpid(), signal.SIGSEGV)", "^x cannot be read: it ended the parser .status -11.; save"),
        ("os.kill(os.getpid(), signal.SIGABRT)", r"^x needs more than \d+ MB of memory to read; use"),
        ("os.kill(os.getpid(), signal.SIGKILL)", "^x was not read: its process was killed.*; try it again"),
        ("os.kill(os.getpid(), signal.SIGXCPU)", "^x takes longer than 1 s to read; use"),
    ],
)
def test_a_request_that_ends_its_process_is_rejected(end, text):
    with running(RECEIVE + end) as process, pytest.raises(errors.BadFile, match=text):
        process.exchange(b"", "x")


@pytest.mark.process
def test_a_request_that_hangs_is_rejected():
    rejected = pytest.raises(errors.BadFile, match=r"^x takes longer than 1 s to read; use")
    with running(RECEIVE + "signal.pause()") as process, rejected:
        process.exchange(b"", "x", wall_s=1.0)


@pytest.mark.process
@pytest.mark.parametrize(
    ("work", "text"), [("bytearray(2 << 30)", "memory"), ("while True: pass", "takes longer")]
)
def test_a_request_that_needs_more_than_the_limits_is_rejected(work, text):
    with running(SERVE.format(work)) as process, pytest.raises(errors.BadFile, match=text):
        process.exchange(b"", "x")


@pytest.mark.process
def test_a_process_answers_again_and_is_replaced_after_a_crash_and_a_large_message(monkeypatch):
    monkeypatch.setattr(isolated_process, "_LARGE", 10)
    with running(SERVE.format("pass")) as process:
        assert process.exchange(b"one", "x") == b"one"
        first = process._process
        assert process.exchange(b"two", "x") == b"two"
        assert process._process is first
        os.kill(first.pid, signal.SIGSEGV)
        first.wait()
        assert process.exchange(b"more than 10", "x") == b"more than 10"
        assert process._process is None


def test_the_limits_of_a_context_end_with_it():
    before = isolated_process.resource.getrlimit(isolated_process.resource.RLIMIT_AS)
    with pytest.raises(MemoryError), limited():
        bytearray(4 * isolated_process.MEMORY_BYTES)
    assert isolated_process.resource.getrlimit(isolated_process.resource.RLIMIT_AS) == before


def test_memory_beyond_the_limit_of_a_context_is_an_error():
    with pytest.raises(MemoryError), limited_memory(1 << 20):
        bytes(1 << 30)


def test_a_limit_is_at_most_that_of_the_shell(monkeypatch):
    """The kernel rejects more, and a node that runs under `ulimit` must start."""
    limits = []
    monkeypatch.setattr(isolated_process.resource, "getrlimit", lambda kind: (1 << 20, 1 << 20))
    monkeypatch.setattr(isolated_process.resource, "setrlimit", lambda kind, pair: limits.append(pair))
    with limited(cpu_s=1 << 30):
        assert limits == [(1 << 20, 1 << 20)] * 2
