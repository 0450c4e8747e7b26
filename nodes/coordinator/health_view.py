"""The state of the nodes, from their heartbeats."""

from __future__ import annotations

import time

from schemas.health import Health
from schemas.replies import NodeStatus
from schemas.wording import counted

SILENT_AFTER_S = 3.0
_HEARD_WITHIN_S = 2.0
_NODES = 50
"""More than there are; but anybody may publish heartbeats where there are no certificates."""


class HealthView:
    """The last heartbeat of each node, and when it came."""

    def __init__(self) -> None:
        self._last: dict[str, tuple[Health, float]] = {}
        self._told_from = time.monotonic() + _HEARD_WITHIN_S

    def take(self, health: Health) -> None:
        """Remember a heartbeat; of strange nodes no more than a few."""
        if health.node not in self._last and len(self._last) >= _NODES:
            return
        self._last[health.node] = (health, time.monotonic())

    def alive(self, node: str) -> bool:
        """Was the node heard of lately?"""
        return node in self._last and time.monotonic() - self._last[node][1] < SILENT_AFTER_S

    def may_be_there(self, node: str) -> bool:
        """Is the node alive, or is it too early to tell? A heart beats once a second."""
        return self.alive(node) or time.monotonic() < self._told_from

    def nodes(self) -> tuple[NodeStatus, ...]:
        """One row a node, by name."""
        return tuple(self._status(health, at) for _, (health, at) in sorted(self._last.items()))

    def _status(self, health: Health, at: float) -> NodeStatus:
        age_s = time.monotonic() - at
        return NodeStatus(
            node=health.node,
            state=health.state if age_s < SILENT_AFTER_S else "silent",
            pid=health.pid,
            uptime_s=round((time.time_ns() - health.started_ns) / 1e9, 1),
            heartbeat_age_s=round(age_s, 2),
            detail=_detail(health),
            last_error=health.last_error,
            notes=health.notes,
        )


def _detail(health: Health) -> str:
    if not health.ignored:
        return health.detail
    return f"{health.detail}; {counted(health.ignored, 'malformed message')} ignored"
