"""The registry of systems that run on this machine for this user, a file written by `semmap up`.

The file is replaced atomically under a lock. An entry is valid while its supervisord runs: a process with the
same id and start time.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
from collections.abc import Callable, Iterator
from pathlib import Path

import msgspec

from semmap.schemas import codec
from semmap.schemas.errors import Refused

_FILE = "systems.json"
_LOCK = "systems.lock"


class System(msgspec.Struct, frozen=True, kw_only=True):
    """A running system: its folder, its endpoints, and its supervisord."""

    data: str
    listen: str
    reachable: str
    pid: int
    namespace: str = ""
    """The name of its robot, if it has one."""
    started: str
    """Start time of the process as reported by the system: process ids are reused."""


class _Registry(msgspec.Struct, frozen=True):
    systems: tuple[System, ...] = ()


@contextlib.contextmanager
def entered(*, data: Path, listen: str, reachable: str, pid: int, namespace: str = "") -> Iterator[None]:
    """Register the system while the context is open. Raises Refused if that fails."""
    system = System(
        data=str(data.resolve()),
        listen=listen,
        reachable=reachable,
        pid=pid,
        started=_started(pid) or "",
        namespace=namespace,
    )
    _change(lambda others: (*(other for other in others if other.data != system.data), system))
    try:
        yield
    finally:
        with contextlib.suppress(Refused):
            _change(lambda others: tuple(other for other in others if other != system))


def systems() -> tuple[System, ...]:
    """Return the running systems in the order of their start."""
    return tuple(system for system in _read() if _runs(system))


def _folder() -> Path:
    import tempfile

    return Path(tempfile.gettempdir(), f"semmap-{os.getuid()}")


def _read() -> tuple[System, ...]:
    """Return the content of the file, if this user wrote it and it is valid."""
    path = _folder() / _FILE
    try:
        if path.stat().st_uid != os.getuid():
            return ()
        return msgspec.json.decode(path.read_bytes(), type=codec.prepared(_Registry)).systems
    except (OSError, msgspec.MsgspecError):
        return ()


def _change(change: Callable[[tuple[System, ...]], tuple[System, ...]]) -> None:
    folder = _folder()
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        if folder.stat().st_uid != os.getuid():
            raise Refused(f"{folder} belongs to another user; remove it or set TMPDIR")
        with (folder / _LOCK).open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            content = msgspec.json.encode(_Registry(change(systems())))
            new = folder / f"{_FILE}.new"
            new.write_bytes(content)
            new.replace(folder / _FILE)
    except OSError as error:
        raise Refused(f"cannot write the list of running systems in {folder}: {error.strerror}") from None


def _runs(system: System) -> bool:
    return _started(system.pid) == system.started


def _started(pid: int) -> str | None:
    """Return the start time of a process; None if there is none with this id or it has ended."""
    try:
        state, *fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
        return fields[18] if state not in "ZX" else None
    except FileNotFoundError:
        if Path("/proc/self/stat").exists():
            return None
    except OSError:
        return None
    import subprocess  # slow to import, and needed only without /proc

    output = subprocess.run(["ps", "-o", "lstart=", "-p", str(pid)], capture_output=True, text=True)
    return output.stdout.strip() or None
