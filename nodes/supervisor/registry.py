"""The systems that run on this machine for this user: a file that `semmap up` enters them in.

It is replaced as a whole, under a lock, so whoever reads it sees all of one state. An entry counts as long as
its supervisord runs: a process with its number that started at the same time.
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
    """A running system: its folder, the endpoints it listens on and is reached at, and its supervisord."""

    data: str
    listen: str
    reachable: str
    pid: int
    namespace: str = ""
    """Its robot's name, if it has one."""
    started: str
    """When the process started, as the system tells it: another process may get the same number later."""


class _Registry(msgspec.Struct, frozen=True):
    systems: tuple[System, ...] = ()


@contextlib.contextmanager
def entered(*, data: Path, listen: str, reachable: str, pid: int, namespace: str = "") -> Iterator[None]:
    """While this is open the system is in the registry. Raises Refused when that cannot be written."""
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
    """Those that run, in the order in which they were started."""
    return tuple(system for system in _read() if _runs(system))


def _folder() -> Path:
    import tempfile

    return Path(tempfile.gettempdir(), f"semmap-{os.getuid()}")


def _read() -> tuple[System, ...]:
    """What the file says, if there is one that this user wrote and that can be understood."""
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
            raise Refused(f"{folder} belongs to another user; remove it, or set TMPDIR")
        with (folder / _LOCK).open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            content = msgspec.json.encode(_Registry(change(systems())))
            new = folder / f"{_FILE}.new"
            new.write_bytes(content)
            new.replace(folder / _FILE)
    except OSError as error:
        raise Refused(f"the running systems cannot be listed in {folder}: {error.strerror}") from None


def _runs(system: System) -> bool:
    return _started(system.pid) == system.started


def _started(pid: int) -> str | None:
    """When a process started; None when there is none of that number, or it has ended already."""
    try:
        state, *fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
        return fields[18] if state not in "ZX" else None
    except FileNotFoundError:
        if Path("/proc/self/stat").exists():
            return None
    except OSError:
        return None
    import subprocess  # takes a while, and is needed where there is no /proc only

    told = subprocess.run(["ps", "-o", "lstart=", "-p", str(pid)], capture_output=True, text=True)
    return told.stdout.strip() or None
