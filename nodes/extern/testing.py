"""A private system for the tests of programs that talk to semmap."""

from __future__ import annotations

import random
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from semmap.nodes.extern.client import Client, connect
from semmap.schemas import errors

_READY = "stop "
"""How the last line of the greeting begins."""
_END_S = 60.0
"""Seconds: longer than a system takes to stop; one that has not is killed, and its nodes end after it."""
_FIRST_PORT, _AFTER_PORTS = 20_000, 32_000
_dice = random.SystemRandom()


@contextmanager
def own_system(
    data: Path, *words: str, endpoint: str | None = None, identity: str | None = None
) -> Iterator[Client]:
    """A client of `semmap up --data DATA WORDS...`, which is stopped at the end.

    It listens at `endpoint`, or else on a free port of this machine; with `--secure` among the words,
    `identity` is the client's. Raises RuntimeError, with what it printed, when it does not start.
    """
    endpoint = endpoint or free_endpoint()
    up = [str(Path(sys.executable).with_name("semmap")), "up", "--data", str(data), "--listen", endpoint]
    with subprocess.Popen(
        [*up, *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as process:
        try:
            if process.stdout is None:
                raise errors.InternalError("the output of the system is not a pipe")
            said = []
            for line in process.stdout:
                said.append(line)
                if line.startswith(_READY):
                    break
            else:
                raise RuntimeError("the system did not start:\n" + "".join(said))
            threading.Thread(target=process.stdout.read, daemon=True).start()  # or a full pipe would stop it
            with connect(endpoint, identity=identity) as client:
                yield client
        finally:
            process.terminate()
            try:
                process.wait(_END_S)
            except subprocess.TimeoutExpired:
                process.kill()


def free_endpoint() -> str:
    """A port of this machine that nobody uses just now.

    It is none of those that the operating system gives to outgoing connections, one of which might have it
    before a system listens there.
    """
    while True:
        port = _dice.randrange(_FIRST_PORT, _AFTER_PORTS)
        with socket.socket() as probe, suppress(OSError):
            probe.bind(("127.0.0.1", port))
            return f"tcp/127.0.0.1:{port}"
