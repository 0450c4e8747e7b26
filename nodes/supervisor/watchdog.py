"""Detects hanging nodes: silent and idle, or silent for far too long; and stopped processes of nodes."""

from __future__ import annotations

import contextlib
import os
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final, NamedTuple

import psutil

SILENT_S: Final = 4.0
"""A node without a heartbeat for this time hangs, unless it is working."""
UNHEARD_S: Final = 30.0
"""The same for a process before its first heartbeat: it may wait for others to start."""
ENDLESS_S: Final = 900.0
"""No work of a node takes this long without a heartbeat."""
_LOOK_AFTER_S: Final = 1.5
"""A heartbeat is published once a second. After this silence, the CPU time of a node is measured."""
_LOOKED_AT_S: Final = 2.0
"""Shortest measurement of the CPU time."""
_HELD_UP_S: Final = 2.0
"""If the checks are this far apart, the watchdog itself was delayed, and silence is not counted."""
_STOPPED_LOOKS: Final = 4
"""A process of a node that is stopped (SIGSTOP) at this many looks in succession is to be ended."""
_BETWEEN_LOOKS_S: Final = 1.0
_AT_WORK: Final = 0.03
"""The CPU share that a working process uses at least, however busy the machine is."""


class Hang(NamedTuple):
    """A node of which a process is to be ended, and the reason."""

    node: str
    pid: int
    reason: str


@dataclass
class _Watched:
    """A monitored process; times are by the monotonic clock."""

    pid: int
    heard_s: float
    has_beaten: bool = False
    looked: tuple[float, float] | None = None
    """While it is silent: the time of the first measurement, and its CPU time then."""


def work_seconds(pid: int) -> float:
    """Return the CPU time of a process, including the time that its main thread waited for a core.

    Infinite while it waits for a disk, 0 for a process that is gone.
    """
    try:
        process = psutil.Process(pid)
        if process.status() == psutil.STATUS_DISK_SLEEP:
            return float("inf")
        times = process.cpu_times()
    except psutil.Error:
        return 0.0
    return float(times.user + times.system) + _starved_s(pid)


def _starved_s(pid: int) -> float:
    """Return how long the main thread of a process was runnable but not running, on Linux."""
    try:
        _, waited_ns, _ = Path(f"/proc/{pid}/schedstat").read_text().split()
        return int(waited_ns) * 1e-9
    except (OSError, ValueError):
        return 0.0


class Stopped(NamedTuple):
    """A stopped process and its CPU time, which grows if it is only slowed down, as `cpulimit` does."""

    pid: int
    worked_s: float


def stopped_processes(nodes: Mapping[str, int]) -> dict[Stopped, str]:
    """Return the stopped processes that nodes started, with their nodes; a node leads a process group."""
    leaders = {pid: node for node, pid in nodes.items()}
    stopped = {}
    for pid in psutil.pids():
        with contextlib.suppress(psutil.Error, OSError):
            node = leaders.get(os.getpgid(pid))
            if node is None or pid in leaders:
                continue
            process = psutil.Process(pid)
            if process.status() == psutil.STATUS_STOPPED:
                times = process.cpu_times()
                stopped[Stopped(pid, times.user + times.system)] = node
    return stopped


class StoppedProcesses:
    """Finds stopped processes that nodes started, such as the one for SPARQL: their nodes are not silent."""

    def __init__(
        self,
        *,
        clock: Callable[[], float] = time.monotonic,
        stopped_among: Callable[[Mapping[str, int]], Mapping[Stopped, str]] = stopped_processes,
    ) -> None:
        self._clock = clock
        self._stopped_among = stopped_among
        self._looks: Counter[Stopped] = Counter()
        self._next_look_s = clock()

    def find(self, nodes: Mapping[str, int]) -> Iterator[Hang]:
        """Yield the processes that have been stopped for about 4 s. Must be called several times a second.

        Looks are counted, not seconds: when the whole system continues after a pause, nothing is ended.
        """
        now_s = self._clock()
        if now_s < self._next_look_s:
            return
        self._next_look_s = now_s + _BETWEEN_LOOKS_S
        stopped = self._stopped_among(nodes)
        self._looks = Counter({process: self._looks[process] + 1 for process in stopped})
        for process, node in stopped.items():
            if self._looks[process] >= _STOPPED_LOOKS:
                yield Hang(node, process.pid, f"its process {process.pid} was stopped (SIGSTOP)")


class Watchdog:
    """Takes processes and heartbeats, and returns hanging nodes. Long work does not count as hanging."""

    def __init__(
        self,
        *,
        clock: Callable[[], float] = time.monotonic,
        work_of: Callable[[int], float] = work_seconds,
    ) -> None:
        self._clock = clock
        self._work_of = work_of
        self._watched: dict[str, _Watched] = {}
        self._looked_s = clock()

    def run_as(self, pids: Mapping[str, int]) -> None:
        """Set the processes of the running nodes, as reported by supervisord."""
        now_s = self._clock()
        for node in self._watched.keys() - pids.keys():
            del self._watched[node]
        for node, pid in pids.items():
            if node not in self._watched or self._watched[node].pid != pid:
                self._watched[node] = _Watched(pid, now_s)

    @property
    def pids(self) -> dict[str, int]:
        """The processes of the running nodes."""
        return {node: watched.pid for node, watched in self._watched.items()}

    def heard(self, node: str, pid: int) -> bool:
        """Note a heartbeat. Returns False, and ignores it, if it is not from the node's process."""
        watched = self._watched.get(node)
        if watched is None or watched.pid != pid:
            return False
        watched.heard_s, watched.has_beaten, watched.looked = self._clock(), True, None
        return True

    def hanging(self) -> Iterator[Hang]:
        """Yield each hanging node, and restart its time-out. Must be called several times a second."""
        now_s = self._clock()
        held_up_s, self._looked_s = now_s - self._looked_s, now_s
        for node, watched in self._watched.items():
            if held_up_s > _HELD_UP_S:
                watched.heard_s, watched.looked = now_s, None
                continue
            silent_s = now_s - watched.heard_s
            if silent_s <= _LOOK_AFTER_S:
                continue
            if watched.looked is None:
                watched.looked = now_s, self._work_of(watched.pid)
                continue
            since_s, worked_before_s = watched.looked
            patience_s = SILENT_S if watched.has_beaten else UNHEARD_S
            if silent_s <= patience_s or now_s - since_s < _LOOKED_AT_S:
                continue
            worked_s = self._work_of(watched.pid)
            is_at_work = max(worked_s, worked_before_s) == float("inf") or (
                worked_s - worked_before_s >= _AT_WORK * (now_s - since_s)
            )
            if not is_at_work or silent_s > ENDLESS_S:
                watched.heard_s, watched.looked = now_s, None
                yield Hang(
                    node,
                    watched.pid,
                    f"silent for {silent_s:.0f} s{', though at work' if is_at_work else ''}",
                )
            elif now_s - since_s > SILENT_S:  # old work does not count
                watched.looked = now_s, worked_s
