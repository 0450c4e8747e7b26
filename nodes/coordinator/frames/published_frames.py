"""The newest pose of each frame that clients publish. Independent of Zenoh and clocks."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterator
from typing import NamedTuple

from semmap.nodes.coordinator.frames.tree import Link, describe_cycle
from semmap.schemas import errors, keys, wording
from semmap.schemas.entities import Pose
from semmap.schemas.frames import LONGEST_NAME, MAP, FramePose

_LATE_NS = 10_000_000_000
"""An older stamp is a late message if it is within this time; otherwise the sender's clock was set."""
_TOLD_S = 60.0
"""How long a problem is reported."""
_FORGOTTEN_S = 600.0
"""A frame without messages for this time is removed."""
MOST = 10_000
_MOST_IGNORED = 50


class _Received(NamedTuple):
    message: FramePose
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
        """A frame is stale after `stale_s` without a message, unless it is fixed."""
        self._stale_s = stale_s
        self._received: dict[str, _Received] = {}
        self._ignored: dict[str, _Ignored] = {}

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names of the frames."""
        return iter(self._received)

    def take(
        self,
        name: str,
        read: Callable[[], tuple[FramePose, int] | None],
        taken: Container[str],
        now_s: float,
    ) -> None:
        """Store a published frame; `read()` returns it with its stamp [ns], or None if it was deleted.

        The frame is ignored, and `problems` reports the reason, in three cases: `read` raises BadRequest, the
        name is that of the map frame or an entity (one of `taken`), or the frame would be in a cycle.
        """
        try:
            message = read()
            if message is None:
                self._received.pop(name, None)
                return
            self._require_possible(name, message[0].parent, taken)
            pose, stamp_ns = message[0].require_pose(), message[1]
        except (errors.Refused, errors.BadRequest) as error:
            self._ignore(name, error.text, now_s)
            return
        known = self._received.get(name)
        if known is not None and 0 < known.stamp_ns - stamp_ns < _LATE_NS:
            return
        self._received[name] = _Received(message[0], pose, stamp_ns, now_s)

    def _require_possible(self, name: str, parent: str, taken: Container[str]) -> None:
        if name == MAP:
            raise errors.Refused("'map' is the map's own frame")
        if not name or len(name) > LONGEST_NAME:
            raise errors.Refused(f"a frame's name has 1 to {LONGEST_NAME} characters")
        if name in taken:
            raise errors.Refused(
                f"the name belongs to an entity; to publish its pose: semmap track {name}, then publish on"
                f" semmap/live/{name}"
            )
        if name not in self._received and len(self._received) >= MOST:
            raise errors.Refused(f"limit of {MOST:,} frames reached")
        visited, above = [name], parent
        while above in self._received and above != name:
            visited.append(above)
            above = self._received[above].message.parent
        if above == name:
            raise errors.Refused(describe_cycle([*visited, name]))

    def _ignore(self, name: str, reason: str, now_s: float) -> None:
        count = self._ignored.pop(name, _Ignored("", 0, 0.0)).times + 1
        if len(self._ignored) >= _MOST_IGNORED:
            self._ignored.pop(next(iter(self._ignored)))
        self._ignored[name] = _Ignored(reason, count, now_s)

    def forget(self, now_s: float) -> None:
        """Remove the frames that have been silent for long."""
        gone = [
            n
            for n, h in self._received.items()
            if not h.message.fixed and now_s - h.received_s > _FORGOTTEN_S
        ]
        for name in gone:
            del self._received[name]

    def link(self, name: str, now_s: float) -> Link | None:
        """Return the link of a frame to its parent; None for an unknown frame."""
        known = self._received.get(name)
        if known is None:
            return None
        age_s = max(0.0, now_s - known.received_s)
        if known.message.fixed:
            return Link(known.message.parent, known.pose, "stream")
        if age_s <= self._stale_s:
            return Link(known.message.parent, known.pose, "stream", age_s)
        return Link(
            known.message.parent, known.pose, "stream", age_s, stale=True, problem=_stale(name, age_s)
        )

    def problems(self, now_s: float) -> Iterator[str]:
        """Yield the problems, one sentence each."""
        for name in sorted(self._received):
            link = self.link(name, now_s)
            if link is not None and link.stale and (link.age_s or 0.0) - self._stale_s < _TOLD_S:
                yield link.problem
        for name, (reason, count, at_s) in sorted(self._ignored.items()):
            if now_s - at_s < _TOLD_S:
                times = f" ({count:,} times)" if count > 1 else ""
                yield f"{keys.frame_key(name)}: ignored{times}: {reason}"


def _stale(name: str, age_s: float) -> str:
    return f"the frame {name} is stale: no message on {keys.frame_key(name)} for {wording.duration(age_s)}"
