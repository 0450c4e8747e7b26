"""The newest pose of each tracked entity, and what of that is to be committed. Knows no clock and no wire.

Level-triggered like the keeper: it looks at where a thing is and at what the map says of it, never at how it
came there, so what was missed is made up for.
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
"""A pose that is older than the one before by less came late; by more, somebody's clock was set."""
_JUMP_M = 0.5
_JUMP_M_S = 5.0
"""What comes further than half a metre, and faster than this, has jumped."""
_LEAST_S = 0.1
_TOLD_S = 60.0
"""How long a jump, and what was refused, is told."""
_MOST_REFUSED = 50
_AGAIN_S = 5.0
"""A commit that was refused is tried again after that."""


class Due(NamedTuple):
    """A live pose that is to be committed, and why."""

    name: str
    pose: Pose
    reason: str


class _Received:
    """What was heard of one entity."""

    __slots__ = ("journalled_s", "jump", "pose", "received_s", "rest", "source", "stamp_ns", "tried_s")

    def __init__(self, pose: Pose, stamp_ns: int, now_s: float, source: Tracking) -> None:
        self.pose, self.stamp_ns, self.received_s, self.source = pose, stamp_ns, now_s, source
        self.rest = Rest(pose, now_s)
        self.jump: tuple[str, float] | None = None
        """In words, and when."""
        self.journalled_s = now_s
        self.tried_s: float | None = None
        """When a commit of where it rests was refused."""


class _Ignored(NamedTuple):
    reason: str
    times: int
    at_s: float


class LivePoses:
    """Owned by the coordinator's thread. Times (`now_s`) are of one monotonic clock [s]."""

    def __init__(self, rules: LiveRules, thresholds: Thresholds) -> None:
        """Nothing was heard yet."""
        self._rules, self._thresholds = rules, thresholds
        self._received: dict[str, _Received] = {}
        self._ignored: dict[str, _Ignored] = {}

    # what is heard

    def read(
        self,
        name: str,
        read: Callable[[], tuple[Pose, int]],
        entities: Mapping[str, Entity],
        now_s: float,
    ) -> None:
        """A pose was published of `name`; `read()` gives it with its stamp [ns], or raises BadRequest."""
        entity = entities.get(name)
        try:
            if entity is None:
                raise errors.UnknownName(f"no entity is named '{name}'{errors.did_you_mean(name, entities)}")
            if entity.tracked != "stream":
                how = "is tracked from the simulator" if entity.tracked else "is not tracked"
                raise errors.Refused(f"{name} {how}; to have it follow this stream: semmap track {name}")
            pose, stamp_ns = read()
        except (errors.Refused, errors.BadRequest) as error:
            self._ignore(name, error.text, now_s)
        else:
            self.take(name, pose, stamp_ns, now_s, "stream")

    def take(self, name: str, pose: Pose, stamp_ns: int, now_s: float, source: Tracking) -> None:
        """A tracked entity was seen at `pose` at `stamp_ns`, which is heard now; the newest counts."""
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
        """Only these are tracked now, each from where the map says."""
        for name, known in list(self._received.items()):
            if name not in tracked or tracked[name].tracked != known.source:
                del self._received[name]

    def _ignore(self, name: str, reason: str, now_s: float) -> None:
        count = self._ignored.pop(name, _Ignored("", 0, 0.0)).times + 1
        if len(self._ignored) >= _MOST_REFUSED:
            self._ignored.pop(next(iter(self._ignored)))
        self._ignored[name] = _Ignored(reason, count, now_s)

    # what is told

    def live(self, name: str, now_s: float) -> Live | None:
        """Where an entity is just now; None if nothing was heard of it."""
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
        """Where all are that were heard of lately: what is stale is where it was committed last."""
        found = ((name, self.live(name, now_s)) for name in self._received)
        return {name: live for name, live in found if live is not None and not live.stale}

    def _is_stale(self, known: _Received, now_s: float) -> bool:
        return now_s - known.received_s > self._rules.stale_s

    def problems(self, tracked: Mapping[str, Entity], now_s: float) -> Iterator[str]:
        """What is amiss, one sentence each."""
        for name, entity in sorted(tracked.items()):
            known = self._received.get(name)
            if known is None:
                yield f"{name}: tracked, but {_nothing_yet(name, entity)}"
                continue
            if self._is_stale(known, now_s):
                age = wording.duration(now_s - known.received_s)
                yield f"{name}: its live pose is stale: nothing has come for {age}"
            if known.jump is not None and now_s - known.jump[1] < _TOLD_S:
                yield f"{name}: {known.jump[0]}, {now_s - known.jump[1]:.0f} s ago"
        for name, (reason, count, at_s) in sorted(self._ignored.items()):
            if now_s - at_s < _TOLD_S:
                times = f" ({count:,} times)" if count > 1 else ""
                yield f"{keys.live_pose_key(name)}: ignored{times}: {reason}"

    def displaced(self, tracked: Mapping[str, Entity], now_s: float) -> Iterator[str]:
        """Yield which entities a stream has away from their committed pose, one sentence each.

        Of those that are tracked from the simulator, the bodies are compared with the map.
        """
        for name, entity in sorted(tracked.items()):
            known = self._received.get(name)
            if known is None or entity.tracked != "stream" or self._is_stale(known, now_s):
                continue
            if entity.pose is not None and self._is_elsewhere(entity, known.pose):
                moving = not known.rest.holds(now_s)
                yield describe_distance(name, entity.pose, known.pose, self._thresholds, moving=moving)

    # what is committed

    def due(self, tracked: Mapping[str, Entity], now_s: float) -> Iterator[Due]:
        """What is to be committed now: where a thing stopped, fell silent, or, if so wanted, passes by."""
        for name, entity in tracked.items():
            known = self._received.get(name)
            if known is None or not self._is_elsewhere(entity, known.pose):
                continue
            if known.tried_s is not None and now_s - known.tried_s < _AGAIN_S:
                continue
            is_stale = self._is_stale(known, now_s)
            is_due = 0.0 < self._rules.journal_every_s <= now_s - known.journalled_s
            if entity.tracked == "stream" and is_stale:
                yield Due(name, rounded(known.pose), f"{name}: its live poses stopped coming")
            elif entity.tracked == "stream" and known.rest.holds(now_s):
                yield Due(name, rounded(known.pose), f"{name} stopped")
            elif is_due and not is_stale:
                yield Due(name, rounded(known.pose), f"{name} is on its way")

    def note_commit(self, name: str, now_s: float, *, refused: bool) -> None:
        """A pose of it was committed, or was refused."""
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


def _nothing_yet(name: str, entity: Entity) -> str:
    if entity.tracked == "sim":
        return "the simulator has no body of it"
    return f"no live pose has come yet; publish them on semmap/live/{name}"
