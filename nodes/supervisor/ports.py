"""The ports of this machine that a system listens on."""

from __future__ import annotations

import contextlib
import fcntl
import os
import random
import re
import shlex
import socket
import tempfile
from functools import cache
from pathlib import Path
from typing import Final

from semmap.nodes.supervisor import registry
from semmap.schemas import errors

_LIVE_PORT: Final = 9876
_FIRST_PORT, _AFTER_PORTS = 20_000, 32_000
_dice = random.SystemRandom()
_drawn: set[int] = set()


def require_free(endpoint: str) -> None:
    """Raise Refused for an endpoint on which another program of this machine listens."""
    match = re.fullmatch(r"(?:tcp|tls)/(.+):(\d+)", endpoint)
    if match is None:
        return
    host, port = match[1].strip("[]"), int(match[2])
    with socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            cause, stop = error.strerror, ""
            for system in registry.systems():
                if endpoint in (system.listen, system.reachable):
                    cause = f"the system of {system.data} listens there"
                    stop = f"stop it (semmap down --data {shlex.quote(system.data)}), or "
            raise errors.Refused(
                f"cannot listen on {endpoint}: {cause}; {stop}use another endpoint, for example"
                f" --listen tcp/{match[1]}:{port + 1}"
            ) from None


def find_web_port(port: int) -> int:
    """Return the port of the page: `port` if it is free, or for 0 any free one. Raises Refused."""
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("127.0.0.1", port))
        except OSError as error:
            raise errors.Refused(
                f"the page cannot listen on 127.0.0.1:{port}: {error.strerror}; use another port with"
                " --web-port, or --web-port 0 for any free one"
            ) from None
        return int(probe.getsockname()[1])


def find_live_view() -> str:
    """Return the default address of Rerun's live view, or one with a free port if that is taken."""
    for port in (_LIVE_PORT, 0):
        with socket.socket() as probe, contextlib.suppress(OSError):
            probe.bind(("127.0.0.1", port))
            return f"127.0.0.1:{probe.getsockname()[1]}"
    raise AssertionError("port 0 can always be bound")


def free_endpoint() -> str:
    """Return an endpoint with a free port of this machine, which no other process draws meanwhile.

    The port is outside the range of outgoing connections, so that none of them takes it before a system
    listens there. It is locked until this process ends.
    """
    while True:
        port = _dice.randrange(_FIRST_PORT, _AFTER_PORTS)
        with socket.socket() as probe, contextlib.suppress(OSError):
            probe.bind(("127.0.0.1", port))
            if port not in _drawn:
                fcntl.lockf(_locks(), fcntl.LOCK_EX | fcntl.LOCK_NB, 1, port)
                _drawn.add(port)
                return f"tcp/127.0.0.1:{port}"


@cache
def _locks() -> int:
    """Open a file that the processes of this user share, in which each port has a byte to lock."""
    path = Path(tempfile.gettempdir()) / f"semmap-ports-{os.getuid()}"
    return os.open(path, os.O_WRONLY | os.O_CREAT, 0o600)
