"""How busy the system has been over the last ten minutes: commits, poses, memory and processor time."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping
from typing import Final, NamedTuple

from semmap.schemas import keys, wording
from semmap.schemas.health import Health
from semmap.schemas.replies import SystemStatus

KEPT_S: Final = 600.0
EVERY_S: Final = 2.0
"""Samples are this far apart, at least."""
_LATE_S: Final = 4.0


class Load(NamedTuple):
    """What a process has used: processor time since its start [s], and memory now [bytes]."""

    cpu_s: float
    memory: int


class Sample(NamedTuple):
    """The rates until `at_s` (seconds since 1970), since the sample before."""

    at_s: float
    commits_hz: float
    poses_hz: float
    memory_mb: float
    """Of all processes that could be looked at."""
    cpu_percent: float
    """Of one core."""


class Rates:
    """The samples of the last ten minutes, and the totals that the next one is the difference to."""

    def __init__(self) -> None:
        self.samples: deque[Sample] = deque()
        self._before: tuple[float, int, int, dict[int, float]] | None = None

    def is_due(self, now_s: float) -> bool:
        """Is it time for another sample?"""
        return self._before is None or now_s - self._before[0] >= EVERY_S

    def take(self, now_s: float, commit: int, poses: int, loads: Mapping[int, Load]) -> None:
        """Take a sample: the number of the last commit, poses heard so far, and the loads by process id.

        What is another process, or a map with fewer commits, begins at nothing.
        """
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


def degraded(health: Mapping[str, Health], why_not: str, now_ns: int) -> tuple[str, ...]:
    """What does not work as it should, a sentence each, the gravest first."""
    said = [why_not] if why_not else []
    health = {node: beat for node, beat in health.items() if not _has_ended(beat, now_ns)}
    for node, beat in sorted(health.items()):
        age_s = (now_ns - beat.stamp_ns) / 1e9
        if age_s > _LATE_S:
            said.append(f"{node} has been silent for {wording.duration(age_s)}")
        elif beat.state != "ready":
            said.append(f"{node} is starting" + (f": {beat.detail}" if beat.detail else ""))
    said.extend(f"{node}: {beat.last_error}" for node, beat in sorted(health.items()) if beat.last_error)
    return tuple(dict.fromkeys(said))


def _has_ended(beat: Health, now_ns: int) -> bool:
    """Is it the last of a client that nobody misses?"""
    return beat.node in keys.CLIENTS and (now_ns - beat.stamp_ns) / 1e9 > _LATE_S


def headline(status: SystemStatus) -> str:
    """The map and the scene in one sentence."""
    agree = {True: "map and scene agree", False: "map and scene do not agree yet", None: "no scene is kept"}
    counts = f"{wording.entities(status.entities)}, {wording.bodies(status.bodies)}, commit {status.commit}"
    return f"{counts}; {agree[status.in_agreement]}"


def node_rows(health: Iterable[Health], loads: Mapping[int, Load], now_ns: int) -> list[dict[str, str]]:
    """One row a node: its state, host, process, age, how long ago its heart beat, and what it says."""
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
