"""The frames that others publish, newest wins. Knows no wire and no clock."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterator
from typing import NamedTuple

from semmap.nodes.coordinator.frames.tree import Link, describe_cycle
from semmap.schemas import errors, keys, wording
from semmap.schemas.entities import Pose
from semmap.schemas.frames import LONGEST_NAME, MAP, FramePose

_LATE_NS = 10_000_000_000
"""A pose that is older than the one before by less came late; by more, somebody's clock was set."""
_TOLD_S = 60.0
"""How long it is told that something was ignored, or that a frame is stale."""
_FORGOTTEN_S = 600.0
"""What has been silent for so long is no frame any more."""
MOST = 10_000
_MOST_IGNORED = 50


class _Received(NamedTuple):
    said: FramePose
    pose: Pose
    stamp_ns: int
    received_s: float


class _Ignored(NamedTuple):
    reason: str
    times: int
    at_s: float


class PublishedFrames:
    """Owned by the coordinator's thread. Times (`now_s`) are of one monotonic clock [s]."""

    def __init__(self, stale_s: float) -> None:
        """What has not been said again for `stale_s` is stale, unless it is fixed."""
        self._stale_s = stale_s
        self._received: dict[str, _Received] = {}
        self._ignored: dict[str, _Ignored] = {}

    def __iter__(self) -> Iterator[str]:
        """The names of the frames."""
        return iter(self._received)

    def take(
        self,
        name: str,
        read: Callable[[], tuple[FramePose, int] | None],
        taken: Container[str],
        now_s: float,
    ) -> None:
        """A frame was published; `read()` gives it with its stamp [ns], or None where it was taken away.

        It is ignored, and `problems` says why, if `read` raises BadRequest, if the map's frame or an entity
        (one of `taken`) is called so, and if it would be in itself.
        """
        try:
            said = read()
            if said is None:
                self._received.pop(name, None)
                return
            self._require_possible(name, said[0].parent, taken)
            pose, stamp_ns = said[0].require_pose(), said[1]
        except (errors.Refused, errors.BadRequest) as error:
            self._ignore(name, error.text, now_s)
            return
        known = self._received.get(name)
        if known is not None and 0 < known.stamp_ns - stamp_ns < _LATE_NS:
            return
        self._received[name] = _Received(said[0], pose, stamp_ns, now_s)

    def _require_possible(self, name: str, parent: str, taken: Container[str]) -> None:
        if name == MAP:
            raise errors.Refused("'map' is the map's own frame")
        if not name or len(name) > LONGEST_NAME:
            raise errors.Refused(f"a frame's name has 1 to {LONGEST_NAME} characters")
        if name in taken:
            raise errors.Refused(
                f"an entity is called so; to publish where that is: semmap track {name}, and its poses on"
                f" semmap/live/{name}"
            )
        if name not in self._received and len(self._received) >= MOST:
            raise errors.Refused(f"there are {MOST:,} frames already")
        passed, above = [name], parent
        while above in self._received and above != name:
            passed.append(above)
            above = self._received[above].said.parent
        if above == name:
            raise errors.Refused(describe_cycle([*passed, name]))

    def _ignore(self, name: str, reason: str, now_s: float) -> None:
        count = self._ignored.pop(name, _Ignored("", 0, 0.0)).times + 1
        if len(self._ignored) >= _MOST_IGNORED:
            self._ignored.pop(next(iter(self._ignored)))
        self._ignored[name] = _Ignored(reason, count, now_s)

    def forget(self, now_s: float) -> None:
        """What has been silent for long is gone."""
        gone = [
            n for n, h in self._received.items() if not h.said.fixed and now_s - h.received_s > _FORGOTTEN_S
        ]
        for name in gone:
            del self._received[name]

    def link(self, name: str, now_s: float) -> Link | None:
        """Where a frame is in its parent; None for one that nobody publishes."""
        known = self._received.get(name)
        if known is None:
            return None
        age_s = max(0.0, now_s - known.received_s)
        if known.said.fixed:
            return Link(known.said.parent, known.pose, "stream")
        if age_s <= self._stale_s:
            return Link(known.said.parent, known.pose, "stream", age_s)
        return Link(known.said.parent, known.pose, "stream", age_s, stale=True, problem=_stale(name, age_s))

    def problems(self, now_s: float) -> Iterator[str]:
        """What is amiss, one sentence each."""
        for name in sorted(self._received):
            link = self.link(name, now_s)
            if link is not None and link.stale and (link.age_s or 0.0) - self._stale_s < _TOLD_S:
                yield link.problem
        for name, (reason, count, at_s) in sorted(self._ignored.items()):
            if now_s - at_s < _TOLD_S:
                times = f" ({count:,} times)" if count > 1 else ""
                yield f"{keys.frame_key(name)}: ignored{times}: {reason}"


def _stale(name: str, age_s: float) -> str:
    return (
        f"the frame {name} is stale: nothing has come on {keys.frame_key(name)} for {wording.duration(age_s)}"
    )
