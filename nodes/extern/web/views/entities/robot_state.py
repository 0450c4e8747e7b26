"""The state of a robot or of another tracked entity: its drive, its speed, and the age of its live pose."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping, Sequence
from typing import Final

from semmap.schemas import wording
from semmap.schemas.entities import Entity, Live, Pose, Vector
from semmap.schemas.scenes import Body, Point

_WINDOW_S: Final = 1.0
"""The speed is the mean over this time."""
_ARRIVED_M: Final = 0.1
_SILENT_S: Final = 3.0
"""The coordinator publishes the live poses at least once a second."""


def is_shown(entity: Entity, body: Body | None) -> bool:
    """Return whether the entity is tracked, or the base of a robot of the simulator."""
    return bool(entity.tracked) or can_drive(body)


def can_drive(body: Body | None) -> bool:
    """Return whether a body is the base of a robot of the simulator."""
    return body is not None and body.robot and not body.part_of


class Speed:
    """The speed of one entity over the last second of its positions."""

    def __init__(self) -> None:
        self._samples: deque[tuple[float, Vector]] = deque()

    def add(self, at_s: float, position_m: Vector) -> None:
        """Add a position at a time; earlier times than before start again."""
        if self._samples and at_s < self._samples[-1][0]:
            self._samples.clear()
        self._samples.append((at_s, position_m))

    def mean_m_s(self, now_s: float) -> float:
        """Return the mean speed over the last second [m/s]; 0 if there were no positions in it."""
        while self._samples and self._samples[0][0] < now_s - _WINDOW_S:
            self._samples.popleft()
        if len(self._samples) < 2 or self._samples[-1][0] == self._samples[0][0]:
            return 0.0
        positions = [position for _, position in self._samples]
        way_m = sum(map(math.dist, positions, positions[1:]))
        return way_m / (self._samples[-1][0] - self._samples[0][0])


def left_m(path: Sequence[Point], pose: Pose | None) -> float:
    """Return the length of the rest of a path from a pose [m]."""
    start = [] if pose is None else [pose.position_m[:2]]
    points = [*start, *path]
    return sum(map(math.dist, points, points[1:]))


def describe_drive(path: Sequence[Point], pose: Pose | None) -> str:
    """Return where a robot drives by a path with at least one point."""
    via = f" through {wording.counted(len(path) - 1, 'point')}" if len(path) > 1 else ""
    return f"Drives to {_point(path[-1])}{via}: {left_m(path, pose):.1f} m left"


def describe_end(goal: Point, pose: Pose | None) -> str:
    """Return how a drive ended, by the pose at its end."""
    if pose is None:
        return f"No longer drives to {_point(goal)}"
    short_m = math.dist(goal, pose.position_m[:2])
    if short_m < _ARRIVED_M:
        return f"Arrived at {_point(goal)}"
    return f"Stopped {short_m:.1f} m before its goal {_point(goal)}"


class LiveAge:
    """The age of the live pose of one entity, by the monotonic clock."""

    def __init__(self) -> None:
        self._received_s: float | None = None
        """When the coordinator received the last pose; None before the first one."""
        self._heard_s = 0.0
        self._is_stale = False

    def add(self, live: Live | None, now_s: float) -> None:
        """Add the live pose of a message; None if it has none, because the pose is stale."""
        self._heard_s, self._is_stale = now_s, live is None or live.stale
        if live is not None:
            self._received_s = now_s - live.age_s

    def describe(self, entity: Entity, now_s: float) -> str:
        """Return the source and the age of the pose, or that it is stale."""
        if not entity.tracked:
            return "Not tracked: the committed pose is shown"
        source = {"sim": "the simulator", "stream": "a stream"}[entity.tracked]
        if self._received_s is None:
            return f"No live pose received from {source}"
        age_s = now_s - self._received_s
        if self._is_stale or now_s - self._heard_s > _SILENT_S:
            age = wording.duration(age_s)
            return f"Stale: last live pose from {source} {age} ago; the committed pose is used"
        return f"Live pose from {source}, {age_s:.1f} s ago"


def ended_goals(
    before: Mapping[str, Sequence[Point]], now: Mapping[str, Sequence[Point]]
) -> dict[str, Point]:
    """Return the goals of the drives that have ended, by robot."""
    return {name: path[-1] for name, path in before.items() if path and name not in now}


def _point(point: Point) -> str:
    return f"({point[0]:.2f}, {point[1]:.2f})"
