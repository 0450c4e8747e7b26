"""A private system for tests of programs that use semmap."""

from __future__ import annotations

import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from semmap.nodes.extern.client import Client, connect
from semmap.nodes.supervisor.ports import free_endpoint
from semmap.schemas import errors

_READY = "stop "
"""The beginning of the last line that `semmap up` prints at its start."""
_END_S = 60.0
"""Timeout of the stop [s]; then the supervisor is killed, and its nodes end after it."""


@contextmanager
def own_system(
    data: Path, *words: str, endpoint: str | None = None, identity: str | None = None
) -> Iterator[Client]:
    """Start `semmap up --data DATA WORDS...`, yield a client, and stop the system at the end.

    The system listens at `endpoint`, or on a free port of this machine. With `--secure` in `words`,
    `identity` is that of the client. Raises RuntimeError, with the output of the system, if it does not
    start.
    """
    endpoint = endpoint or free_endpoint()
    up = [str(Path(sys.executable).with_name("semmap")), "up", "--data", str(data), "--listen", endpoint]
    with subprocess.Popen(
        [*up, *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as process:
        try:
            if process.stdout is None:
                raise errors.InternalError("the output of the system is not a pipe")
            printed = []
            for line in process.stdout:
                printed.append(line)
                if line.startswith(_READY):
                    break
            else:
                raise RuntimeError("the system did not start:\n" + "".join(printed))
            threading.Thread(target=process.stdout.read, daemon=True).start()  # a full pipe would block it
            with connect(endpoint, identity=identity) as client:
                yield client
        finally:
            process.terminate()
            try:
                process.wait(_END_S)
            except subprocess.TimeoutExpired:
                process.kill()
