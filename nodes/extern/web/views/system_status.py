"""State and load of the nodes: commits, poses, memory and CPU time over the last ten minutes."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping
from typing import Final, NamedTuple

from semmap.schemas import keys, wording
from semmap.schemas.health import Health
from semmap.schemas.replies import SystemStatus

KEPT_S: Final = 600.0
EVERY_S: Final = 2.0
"""Minimum time between two samples."""
_LATE_S: Final = 4.0


class Load(NamedTuple):
    """The load of a process: CPU time since its start [s], and memory [bytes]."""

    cpu_s: float
    memory: int


class Sample(NamedTuple):
    """Rates in the interval from the previous sample to `at_s` (seconds since 1970)."""

    at_s: float
    commits_hz: float
    poses_hz: float
    memory_mb: float
    """Sum over the processes of this machine."""
    cpu_percent: float
    """In percent of one core."""


class RateHistory:
    """The samples of the last ten minutes, and the totals at the last one."""

    def __init__(self) -> None:
        self.samples: deque[Sample] = deque()
        self._before: tuple[float, int, int, dict[int, float]] | None = None

    def is_due(self, now_s: float) -> bool:
        """Return whether the next sample is due. It is when the clock was set back, too."""
        return self._before is None or not 0.0 <= now_s - self._before[0] < EVERY_S

    def add_sample(self, now_s: float, commit: int, poses: int, loads: Mapping[int, Load]) -> None:
        """Add a sample from the last commit, the number of received poses, and the loads by process id.

        A new process, or a map with fewer commits, starts at 0. After the clock was set back, the samples
        start again.
        """
        if self._before is not None and now_s < self._before[0]:
            self.samples.clear()
            self._before = None
        cpu = {pid: load.cpu_s for pid, load in loads.items()}
        if self._before is not None:
            was_s, last_commit, last_poses, last_cpu = self._before
            passed = max(now_s - was_s, 1e-3)
            used = sum(max(0.0, cpu[pid] - last_cpu[pid]) for pid in cpu if pid in last_cpu)
            self.samples.append(
                Sample(
                    at_s=now_s,
                    commits_hz=max(0, commit - last_commit) / passed,
                    poses_hz=max(0, poses - last_poses) / passed,
                    memory_mb=sum(load.memory for load in loads.values()) / (1 << 20),
                    cpu_percent=100.0 * used / passed,
                )
            )
        self._before = (now_s, commit, poses, cpu)
        while self.samples and self.samples[0].at_s < now_s - KEPT_S:
            self.samples.popleft()


def list_problems(health: Mapping[str, Health], offline_reason: str, now_ns: int) -> tuple[str, ...]:
    """Return the current problems of the system, the most severe first."""
    found = [offline_reason] if offline_reason else []
    health = {node: beat for node, beat in health.items() if not _has_ended(beat, now_ns)}
    for node, beat in sorted(health.items()):
        age_s = (now_ns - beat.stamp_ns) / 1e9
        if age_s > _LATE_S:
            found.append(f"{node}: no heartbeat for {wording.duration(age_s)}")
        elif beat.state != "ready":
            found.append(f"{node}: starting" + (f" ({beat.detail})" if beat.detail else ""))
    found.extend(f"{node}: {beat.last_error}" for node, beat in sorted(health.items()) if beat.last_error)
    return tuple(dict.fromkeys(found))


def _has_ended(beat: Health, now_ns: int) -> bool:
    """Return whether it is the last heartbeat of a client, which may end at any time."""
    return beat.node in keys.CLIENTS and (now_ns - beat.stamp_ns) / 1e9 > _LATE_S


def format_headline(status: SystemStatus) -> str:
    """Return the state of the map and of the scene in one sentence."""
    agree = {True: "map and scene agree", False: "map and scene do not agree yet", None: "no scene"}
    counts = f"{wording.entities(status.entities)}, {wording.bodies(status.bodies)}, commit {status.commit}"
    return f"{counts}; {agree[status.in_agreement]}"


def node_rows(health: Iterable[Health], loads: Mapping[int, Load], now_ns: int) -> list[dict[str, str]]:
    """Return one row per node, with its state, process, uptime, last heartbeat and detail."""
    rows = []
    for beat in sorted((h for h in health if not _has_ended(h, now_ns)), key=lambda h: h.node):
        age_s = (now_ns - beat.stamp_ns) / 1e9
        load = loads.get(beat.pid)
        rows.append(
            {
                "node": beat.node,
                "state": "silent" if age_s > _LATE_S else beat.state,
                "host": beat.host,
                "pid": str(beat.pid),
                "up": wording.duration(max(0.0, (now_ns - beat.started_ns) / 1e9)),
                "beat": f"{max(0.0, age_s):.1f} s ago",
                "memory": "" if load is None else f"{load.memory / (1 << 20):.0f} MB",
                "detail": beat.detail,
            }
        )
    return rows
