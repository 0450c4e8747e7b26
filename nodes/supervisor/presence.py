"""Announces on this machine that a system runs at an endpoint, even before it listens.

`semmap up` holds a lock from before seeding until all processes have stopped. While the lock is held, a
client retries a refused connection, because the coordinator is starting or restarting. The kernel releases
the lock however the process ends.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import re
from collections.abc import Iterator
from pathlib import Path

_READ = os.O_RDONLY | os.O_NOFOLLOW
_LOOPBACK = re.compile(r"(?:tcp|tls)/(127\.\d+\.\d+\.\d+|localhost|\[::1\]):(\d+)")


@contextlib.contextmanager
def announced(endpoint: str) -> Iterator[None]:
    """Announce `endpoint`, if it is a loopback port, while the context is open."""
    if (lock := _lock_of(endpoint)) is None:
        yield
        return
    try:
        held = os.open(lock, _READ | os.O_CREAT, 0o644)
    except PermissionError:  # left behind by another user
        held = os.open(lock, _READ)
    try:
        fcntl.flock(held, fcntl.LOCK_SH)
        yield
    finally:
        with contextlib.suppress(OSError):  # another process holds it, or another user owns it
            fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
            lock.unlink()
        os.close(held)


def is_announced(endpoint: str) -> bool:
    """Return whether a system is announced at `endpoint` on this machine."""
    if (lock := _lock_of(endpoint)) is None:
        return False
    try:
        held = os.open(lock, _READ)
    except OSError:
        return False
    try:
        fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    finally:
        os.close(held)
    return False


def is_loopback(endpoint: str) -> bool:
    """Return whether it is a loopback port, which is announced."""
    return _LOOPBACK.fullmatch(endpoint) is not None


def is_listening(endpoint: str) -> bool:
    """Return whether a process listens at this loopback port."""
    if (match := _LOOPBACK.fullmatch(endpoint)) is None:
        return False
    import socket

    with (
        contextlib.suppress(OSError),
        socket.create_connection((match[1].strip("[]"), int(match[2])), timeout=1.0),
    ):
        return True
    return False


def _lock_of(endpoint: str) -> Path | None:
    """Return the lock file of a loopback address and port, shared by all users."""
    import tempfile

    if (match := _LOOPBACK.fullmatch(endpoint)) is None:
        return None
    host = match[1].strip("[]").replace("localhost", "127.0.0.1")
    return Path(tempfile.gettempdir(), f"semmap-{host}-{match[2]}.lock")
