"""The newest pose of each tracked entity, and which poses are due to be committed.

Level-triggered like the reconciler: it compares the current pose with the map, so missed messages do not
matter. Independent of Zenoh and clocks.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import NamedTuple

from semmap.nodes.coordinator.config import LiveRules, Thresholds
from semmap.nodes.coordinator.live.rest import Rest
from semmap.nodes.coordinator.reconciler.agreement import describe_distance
from semmap.schemas import errors, keys, wording
from semmap.schemas.entities import Entity, Live, Pose, Tracking, angle_rad, distance_m, rounded

_LATE_NS = 10_000_000_000
"""An older stamp is a late message if it is within this time; otherwise the sender's clock was set."""
_JUMP_M = 0.5
_JUMP_M_S = 5.0
"""A pose that differs by more than half a metre, at more than this speed, is a jump."""
_LEAST_S = 0.1
_REPORTED_S = 60.0
"""How long a jump or a rejected pose is reported."""
_MOST_REFUSED = 50
_AGAIN_S = 5.0
"""A rejected commit is tried again after this time."""


class Due(NamedTuple):
    """A live pose to commit, and the reason."""

    name: str
    pose: Pose
    reason: str


class _Received:
    """What was received of one entity."""

    __slots__ = ("journalled_s", "jump", "pose", "received_s", "rest", "source", "stamp_ns", "tried_s")

    def __init__(self, pose: Pose, stamp_ns: int, now_s: float, source: Tracking) -> None:
        self.pose, self.stamp_ns, self.received_s, self.source = pose, stamp_ns, now_s, source
        self.rest = Rest(pose, now_s)
        self.jump: tuple[str, float] | None = None
        """In words, and its time."""
        self.journalled_s = now_s
        self.tried_s: float | None = None
        """When a commit of its pose at rest was rejected."""


class _Ignored(NamedTuple):
    reason: str
    times: int
    at_s: float


class LivePoses:
    """Owned by the coordinator's thread. Times (`now_s`) are of one monotonic clock [s]."""

    def __init__(self, rules: LiveRules, thresholds: Thresholds) -> None:
        """Start without any pose."""
        self._rules, self._thresholds = rules, thresholds
        self._received: dict[str, _Received] = {}
        self._ignored: dict[str, _Ignored] = {}

    # Received poses

    def read(
        self,
        name: str,
        read: Callable[[], tuple[Pose, int]],
        entities: Mapping[str, Entity],
        now_s: float,
    ) -> None:
        """Take a pose that was published for `name`.

        `read()` returns it with its stamp [ns], or raises BadRequest.
        """
        entity = entities.get(name)
        try:
            if entity is None:
                raise errors.UnknownName(
                    f"no entity is named '{name}'{errors.suggestion(name, entities, 'list')}"
                )
            if entity.tracked != "stream":
                how = "is tracked from the simulator" if entity.tracked else "is not tracked"
                raise errors.Refused(f"{name} {how}; to have it follow this stream: semmap track {name}")
            pose, stamp_ns = read()
        except (errors.Refused, errors.BadRequest) as error:
            self._ignore(name, error.text, now_s)
        else:
            self.take(name, pose, stamp_ns, now_s, "stream")

    def take(self, name: str, pose: Pose, stamp_ns: int, now_s: float, source: Tracking) -> None:
        """Take the pose of a tracked entity at `stamp_ns`; the newest is used."""
        known = self._received.get(name)
        if known is None or known.source != source:
            self._received[name] = _Received(pose, stamp_ns, now_s, source)
            return
        if 0 <= known.stamp_ns - stamp_ns < _LATE_NS and stamp_ns != known.stamp_ns:
            return
        moved_m = distance_m(known.pose, pose)
        if source == "stream" and moved_m > _JUMP_M and not self._is_stale(known, now_s):
            passed_s = max(now_s - known.received_s, _LEAST_S)
            if moved_m > _JUMP_M_S * passed_s:
                known.jump = (f"its live pose jumped {moved_m:.2f} m within {passed_s:.1f} s", now_s)
        known.pose, known.stamp_ns, known.received_s = pose, stamp_ns, now_s
        known.rest.take(pose, now_s)

    def forget(self, tracked: Mapping[str, Entity]) -> None:
        """Keep only the entities that are tracked now."""
        for name, known in list(self._received.items()):
            if name not in tracked or tracked[name].tracked != known.source:
                del self._received[name]

    def _ignore(self, name: str, reason: str, now_s: float) -> None:
        count = self._ignored.pop(name, _Ignored("", 0, 0.0)).times + 1
        if len(self._ignored) >= _MOST_REFUSED:
            self._ignored.pop(next(iter(self._ignored)))
        self._ignored[name] = _Ignored(reason, count, now_s)

    # Current poses and problems

    def live(self, name: str, now_s: float) -> Live | None:
        """Return the live pose of an entity; None if none was received."""
        known = self._received.get(name)
        if known is None:
            return None
        return Live(
            pose=rounded(known.pose),
            stamp_ns=known.stamp_ns,
            age_s=round(max(0.0, now_s - known.received_s), 3),
            source=known.source,
            stale=self._is_stale(known, now_s),
        )

    def current(self, now_s: float) -> dict[str, Live]:
        """Return the live poses that are not stale; a stale entity is at its committed pose."""
        found = ((name, self.live(name, now_s)) for name in self._received)
        return {name: live for name, live in found if live is not None and not live.stale}

    def _is_stale(self, known: _Received, now_s: float) -> bool:
        return now_s - known.received_s > self._rules.stale_s

    def problems(self, tracked: Mapping[str, Entity], now_s: float) -> Iterator[str]:
        """Yield the problems, one sentence each."""
        for name, entity in sorted(tracked.items()):
            known = self._received.get(name)
            if known is None:
                yield f"{name}: tracked, but {_why_no_pose(name, entity)}"
                continue
            if self._is_stale(known, now_s):
                age = wording.duration(now_s - known.received_s)
                yield f"{name}: its live pose is stale: none received for {age}"
            if known.jump is not None and now_s - known.jump[1] < _REPORTED_S:
                yield f"{name}: {known.jump[0]}, {now_s - known.jump[1]:.0f} s ago"
        for name, (reason, count, at_s) in sorted(self._ignored.items()):
            if now_s - at_s < _REPORTED_S:
                times = f" ({count:,} times)" if count > 1 else ""
                yield f"{keys.live_pose_key(name)}: ignored{times}: {reason}"

    def displaced(self, tracked: Mapping[str, Entity], now_s: float) -> Iterator[str]:
        """Yield the entities whose live pose from a stream differs from the committed one, a sentence each.

        Entities that are tracked from the simulator are not listed: their bodies are compared with the map.
        """
        for name, entity in sorted(tracked.items()):
            known = self._received.get(name)
            if known is None or entity.tracked != "stream" or self._is_stale(known, now_s):
                continue
            if entity.pose is not None and self._is_elsewhere(entity, known.pose):
                moving = not known.rest.holds(now_s)
                yield describe_distance(name, entity.pose, known.pose, self._thresholds, moving=moving)

    # Poses to commit

    def due(self, tracked: Mapping[str, Entity], now_s: float) -> Iterator[Due]:
        """Yield the poses to commit: of entities that stopped or fell silent, or periodically."""
        for name, entity in tracked.items():
            known = self._received.get(name)
            if known is None or not self._is_elsewhere(entity, known.pose):
                continue
            if known.tried_s is not None and now_s - known.tried_s < _AGAIN_S:
                continue
            is_stale = self._is_stale(known, now_s)
            is_due = 0.0 < self._rules.journal_every_s <= now_s - known.journalled_s
            if entity.tracked == "stream" and is_stale:
                yield Due(name, rounded(known.pose), f"{name}: no more live poses received")
            elif entity.tracked == "stream" and known.rest.holds(now_s):
                yield Due(name, rounded(known.pose), f"{name} stopped")
            elif is_due and not is_stale:
                yield Due(name, rounded(known.pose), f"{name} is moving")

    def note_commit(self, name: str, now_s: float, *, refused: bool) -> None:
        """Note that a pose of an entity was committed or rejected."""
        known = self._received.get(name)
        if known is not None:
            known.journalled_s, known.tried_s = now_s, now_s if refused else None

    def _is_elsewhere(self, entity: Entity, pose: Pose) -> bool:
        if entity.pose is None:
            return True
        return (
            distance_m(entity.pose, pose) > self._thresholds.distance_m
            or angle_rad(entity.pose, pose) > self._thresholds.angle_rad
        )


def _why_no_pose(name: str, entity: Entity) -> str:
    if entity.tracked == "sim":
        return "it has no body in the simulator"
    return f"no live pose has been received yet; publish poses on semmap/live/{name}"
