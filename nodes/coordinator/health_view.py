"""The state of the nodes, from their heartbeats."""

from __future__ import annotations

import time

from semmap.schemas import keys
from semmap.schemas.health import Health
from semmap.schemas.replies import NodeStatus
from semmap.schemas.wording import counted

SILENT_AFTER_S = 3.0
_HEARD_WITHIN_S = 2.0
_NODES = 50
"""More than a system has. Without certificates any program may publish heartbeats."""


class HealthView:
    """The last heartbeat of each node on each host, and when it arrived.

    Clients such as the page or the ROS bridge are optional. They are no longer listed once they have ended.
    """

    def __init__(self) -> None:
        self._last: dict[tuple[str, str, int], tuple[Health, float]] = {}
        self._complete_from = time.monotonic() + _HEARD_WITHIN_S

    def take(self, health: Health) -> None:
        """Store a heartbeat; the number of unknown nodes is limited."""
        self._forget_clients()
        which = health.node, health.host, health.pid if health.node in keys.CLIENTS else 0
        if which not in self._last and len(self._last) >= _NODES:
            return
        self._last[which] = (health, time.monotonic())

    def alive(self, node: str) -> bool:
        """Return whether a heartbeat of the node has arrived recently."""
        now_s = time.monotonic()
        return any(name == node and now_s - at < SILENT_AFTER_S for (name, *_), (_, at) in self._last.items())

    def may_be_alive(self, node: str) -> bool:
        """Return whether the node is alive or may be: a heartbeat is published once a second."""
        return self.alive(node) or time.monotonic() < self._complete_from

    def nodes(self) -> tuple[NodeStatus, ...]:
        """Return the state of each node, sorted by name and host."""
        self._forget_clients()
        return tuple(self._status(health, at) for _, (health, at) in sorted(self._last.items()))

    def _forget_clients(self) -> None:
        """Remove clients without recent heartbeats."""
        now_s = time.monotonic()
        for which, (health, at) in list(self._last.items()):
            if health.node in keys.CLIENTS and now_s - at >= SILENT_AFTER_S:
                del self._last[which]

    def _status(self, health: Health, at: float) -> NodeStatus:
        age_s = time.monotonic() - at
        is_silent = age_s >= SILENT_AFTER_S
        return NodeStatus(
            node=health.node,
            state="silent" if is_silent else health.state,
            host=health.host,
            pid=health.pid,
            uptime_s=round((health.stamp_ns - health.started_ns) / 1e9 + age_s, 1),  # by its own clock
            heartbeat_age_s=round(age_s, 2),
            detail=_next_step(health) if is_silent else _detail(health),
            last_error=health.last_error,
            notes=health.notes,
        )


def _next_step(health: Health) -> str:
    return f"no heartbeat; if semmap up does not restart it, see logs/{health.node}.log in its data folder"


def _detail(health: Health) -> str:
    if not health.ignored:
        return health.detail
    return f"{health.detail}; {counted(health.ignored, 'malformed message')} ignored"
