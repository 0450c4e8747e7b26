"""Hosts of a test: network namespaces in one user namespace, joined by links that can be cut.

`python -m tests.faults.MODULE` must run under `unshare -rn`, which permits namespaces and links.
"""

from __future__ import annotations

import contextlib
import ctypes
import multiprocessing
import os
import shutil
import socket
import subprocess
import tempfile
from collections.abc import Callable
from concurrent.futures import Future, ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal, TypeVar, get_args

_NEW_NETWORK = 0x4000_0000
_NEW_HOST_NAME = 0x0400_0000
_NOBODY = "02:00:00:00:00:99"
"""An unused link-layer address: packets sent to it are lost silently."""

R = TypeVar("R")
How = Literal["silent", "down"]
HOWS: Final[tuple[How, ...]] = get_args(How)


def missing() -> str:
    """Return why hosts cannot be created here; "" if they can."""
    if _ip() is None:
        return "there is no ip (Debian's iproute2)"
    try:
        ended = subprocess.run(["unshare", "-rn", "true"], capture_output=True, text=True)
    except OSError as error:
        return f"unshare: {error.strerror}"
    return ended.stderr.strip()


class Host:
    """A host: its own network, name and temporary folder, and a process on it."""

    def __init__(self, name: str, folder: Path) -> None:
        self.name = name
        self.folder = folder / name
        self.folder.mkdir()
        spawn = multiprocessing.get_context("spawn")
        self._process = ProcessPoolExecutor(1, spawn, _become_host, (name, str(self.folder)))
        self._pid = self.begin(os.getpid)

    @property
    def pid(self) -> int:
        """The id of its process, once that runs."""
        return self._pid.result()

    def do(self, function: Callable[..., R], *arguments: Any) -> R:
        """Run `function` on this host and return its result, or raise its error."""
        return self.begin(function, *arguments).result()

    def begin(self, function: Callable[..., R], *arguments: Any) -> Future[R]:
        """Run `function` on this host without waiting."""
        return self._process.submit(function, *arguments)

    def close(self) -> None:
        """End its process; its child processes must have ended."""
        self._process.shutdown()


@dataclass(frozen=True)
class Link:
    """A link between two hosts, with the address of each end."""

    ends: tuple[Host, Host]
    addresses: tuple[str, str]
    device: str

    def cut(self, how: How) -> None:
        """Cut the link: lose all packets silently, or switch off one end."""
        if how == "down":
            self.ends[0].do(_run_ip, "link", "set", self.device, "down")
            return
        for end, other in zip(self.ends, reversed(self.addresses), strict=True):
            words = ("neigh", "replace", other, "lladdr", _NOBODY, "nud", "permanent", "dev", self.device)
            end.do(_run_ip, *words)

    def mend(self, how: How) -> None:
        """Restore the link."""
        if how == "down":
            self.ends[0].do(_run_ip, "link", "set", self.device, "up")
            return
        for end, other in zip(self.ends, reversed(self.addresses), strict=True):
            end.do(_run_ip, "neigh", "del", other, "dev", self.device)

    def sent(self) -> tuple[int, int]:
        """Return the number of bytes that each end has sent."""
        one, other = (end.do(_sent, self.device) for end in self.ends)
        return one, other


class Network(contextlib.ExitStack):
    """Hosts and links, which exist until it is closed."""

    def __init__(self) -> None:
        super().__init__()
        # Short, because the paths of sockets must be.
        self._folder = Path(self.enter_context(tempfile.TemporaryDirectory(prefix="semmap-hosts-")))
        self._links = 0

    def host(self, name: str) -> Host:
        """Add a host."""
        return self.enter_context(contextlib.closing(Host(name, self._folder)))

    def link(self, one: Host, other: Host) -> Link:
        """Link two hosts."""
        self._links += 1
        device, addresses = f"to{self._links}", (f"10.0.{self._links}.1", f"10.0.{self._links}.2")
        ends = ("name", device, "netns", str(one.pid)), ("name", device, "netns", str(other.pid))
        _run_ip("link", "add", *ends[0], "type", "veth", "peer", *ends[1])
        for end, address in zip((one, other), addresses, strict=True):
            end.do(_run_ip, "addr", "add", f"{address}/24", "dev", device)
            end.do(_run_ip, "link", "set", device, "up")
        return Link((one, other), addresses, device)


def _become_host(name: str, folder: str) -> None:
    """Give this process its own network and host name; it must not have threads yet."""
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.unshare(_NEW_NETWORK | _NEW_HOST_NAME) != 0:
        raise OSError(ctypes.get_errno(), "cannot make a host")
    socket.sethostname(name)
    os.environ["TMPDIR"] = tempfile.tempdir = folder
    _run_ip("link", "set", "lo", "up")


def _ip() -> str | None:
    return shutil.which("ip", path=f"{os.environ.get('PATH', '')}:/usr/sbin:/sbin")


def _run_ip(*words: str) -> None:
    subprocess.run([_ip() or "ip", *words], check=True)


def _sent(device: str) -> int:
    for line in Path("/proc/self/net/dev").read_text().splitlines():
        name, _, counts = line.partition(":")
        if name.strip() == device:
            return int(counts.split()[8])
    raise LookupError(device)
