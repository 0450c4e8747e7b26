"""Announces to programs on this machine that a system runs at an endpoint, even while nothing listens there.

`semmap up` holds a lock from before it seeds until everything has stopped. A connection that is refused
meanwhile is worth trying again: the coordinator is about to listen, at first or after a restart. Where
nobody holds the lock, the refusal is the answer. The kernel releases it however the process ends.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import re
from collections.abc import Iterator
from pathlib import Path

_READ = os.O_RDONLY | os.O_NOFOLLOW
_LOOPBACK = re.compile(r"(?:tcp|tls)/(?:127\.\d+\.\d+\.\d+|localhost|\[::1\]):(\d+)")


@contextlib.contextmanager
def announced(endpoint: str) -> Iterator[None]:
    """While this is open, `is_announced` holds of `endpoint`, if that is a port of loopback."""
    if (lock := _lock_of(endpoint)) is None:
        yield
        return
    try:
        held = os.open(lock, _READ | os.O_CREAT, 0o644)
    except PermissionError:  # another user's, left behind
        held = os.open(lock, _READ)
    try:
        fcntl.flock(held, fcntl.LOCK_SH)
        yield
    finally:
        with contextlib.suppress(OSError):  # others hold it too, or it is another user's
            fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
            lock.unlink()
        os.close(held)


def is_announced(endpoint: str) -> bool:
    """Is a system run at `endpoint`, as far as this machine knows?"""
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
    """Is it a port of loopback? Then a system that is run there is announced."""
    return _LOOPBACK.fullmatch(endpoint) is not None


def is_listening(endpoint: str) -> bool:
    """Does anybody listen at this port of loopback just now?"""
    if (match := _LOOPBACK.fullmatch(endpoint)) is None:
        return False
    import socket

    host = endpoint.partition("/")[2].rpartition(":")[0].strip("[]")
    with contextlib.suppress(OSError), socket.create_connection((host, int(match[1])), timeout=1.0):
        return True
    return False


def _lock_of(endpoint: str) -> Path | None:
    """The file of the lock: one for a port, whoever uses it."""
    import tempfile

    match = _LOOPBACK.fullmatch(endpoint)
    return Path(tempfile.gettempdir(), f"semmap-{match[1]}.lock") if match else None
