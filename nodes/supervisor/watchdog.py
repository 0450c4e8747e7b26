"""Which nodes hang: those that are silent and do nothing, or that are silent for far too long."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final

import psutil  # type: ignore[import-untyped]

SILENT_S: Final = 30.0
"""A node that has not been heard of for so long hangs, unless it is at work."""
ENDLESS_S: Final = 900.0
"""Nothing that a node does without a word takes this long."""
_AT_WORK: Final = 0.05
"""The share of a core that a process at work uses at least, however busy the machine is."""


@dataclass
class _Watched:
    """Times are by the monotonic clock."""

    pid: int
    heard_s: float
    looked: tuple[float, float] | None = None
    """While it is silent: when it was looked at, and the CPU time that it had used by then."""


def cpu_seconds(pid: int) -> float:
    """CPU time that a process has used; 0 for one that is gone."""
    try:
        times = psutil.Process(pid).cpu_times()
    except psutil.Error:
        return 0.0
    return float(times.user + times.system)


class Watchdog:
    """Heartbeats go in; nodes that hang come out. Long work may stop the heart, and is no hang."""

    def __init__(
        self,
        *,
        clock: Callable[[], float] = time.monotonic,
        cpu_of: Callable[[int], float] = cpu_seconds,
    ) -> None:
        self._clock = clock
        self._cpu_of = cpu_of
        self._watched: dict[str, _Watched] = {}

    def heard(self, node: str, pid: int) -> None:
        """A heartbeat came."""
        now_s = self._clock()
        self._watched[node] = _Watched(pid, now_s)

    def hanging(self) -> Iterator[tuple[str, str]]:
        """Each node that hangs, with the reason; then it is given as much time again."""
        now_s = self._clock()
        for node, watched in list(self._watched.items()):
            silent_s = now_s - watched.heard_s
            if silent_s <= SILENT_S / 2:
                continue
            if watched.looked is None:
                watched.looked = now_s, self._cpu_of(watched.pid)
                continue
            since_s, used_before_s = watched.looked
            if silent_s <= SILENT_S or now_s - since_s < SILENT_S / 2:
                continue
            watched.looked = now_s, self._cpu_of(watched.pid)
            is_at_work = watched.looked[1] - used_before_s >= _AT_WORK * (now_s - since_s)
            if not is_at_work or silent_s > ENDLESS_S:
                self._watched[node] = _Watched(watched.pid, now_s)
                yield node, f"silent for {silent_s:.0f} s{', though at work' if is_at_work else ''}"
