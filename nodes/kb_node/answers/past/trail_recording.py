"""Records where live entities are, between commits: a downsampled track, and the places they enter and leave.

Lines are collected and written once a second without waiting for the disk. The loss at an abrupt end of the
process is therefore at most a second, and at an end of the machine what it had not written yet. Intervals are
measured by the monotonic clock, and lines are stamped by the wall clock, which can be set.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable
from typing import Final

from msgspec import Struct

from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.relations.geometry.solids import Solid, solid_of
from semmap.nodes.kb_node.relations.measuring.places import within
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.storage.trail_file import ON_PERIOD_NS, TrailFile, TrailLine
from semmap.schemas.entities import Pose, Vector
from semmap.schemas.live import LivePoses

WRITE_PERIOD_S: Final = 1.0
_TIMEOUT_NS: Final = 3_000_000_000
"""Live poses are published at least once a second. After this time without one they have ended."""
_STEP_M: Final = 0.25
"""The least distance between two positions of a track."""
_STEP_NS: Final = 1_000_000_000
"""The least time between two positions of a track, unless the places change."""
_REST_STEP_M: Final = 0.02
"""The least distance of a position at rest to the last one of the track."""
_PLACE_STEP_M: Final = 0.05
"""The places of an entity are determined again after this distance."""
_RETRY_NS: Final = 60_000_000_000
"""The time until the file is tried again that could not be written."""


_CLOCK_STEP_NS = 1_000_000_000
"""A wall clock that goes back by more begins a new period of the trail."""


class _Known(Struct):
    """The last recorded state of an entity, its last position, and where its places were last determined.

    `ns` is of the monotonic clock.
    """

    ns: int
    at: Vector
    places: tuple[str, ...]
    last: Vector
    placed_at: Vector
    place_version: int


class TrailRecorder:
    """Owned by the node's thread."""

    def __init__(
        self,
        file: TrailFile,
        places: Callable[[], tuple[int, Iterable[Solid], Thresholds]],
        report: Callable[[str], None],
        clock_ns: Callable[[], int] = time.monotonic_ns,
        wall_ns: Callable[[], int] = time.time_ns,
    ) -> None:
        """`places()` returns the version of the map, its solids and the thresholds of relations."""
        self._file, self._places, self._report = file, places, report
        self._clock_ns, self._wall_ns = clock_ns, wall_ns
        self._known: dict[str, _Known] = {}
        self._waiting: list[TrailLine] = []
        self._has_started = False
        self._received_ns = 0
        self._stamp_ns = 0
        """The time of the last message by the wall clock, at least that of the message before."""
        self._written_ns = 0
        self._retry_ns = 0
        self._version = -1
        self._all_places: tuple[Solid, ...] = ()
        self._limits = Thresholds()

    def update(self, message: LivePoses) -> None:
        """Take the live poses of all tracked and attached entities."""
        if not message.entities and not self._known:
            return
        now_ns = self._clock_ns()
        wall_ns = self._wall_ns()
        if wall_ns < self._stamp_ns - _CLOCK_STEP_NS:  # the wall clock was set back
            self.close()
            self._has_started, self._stamp_ns = False, wall_ns
        self._received_ns, self._stamp_ns = now_ns, max(self._stamp_ns, wall_ns)
        for name in self._known.keys() - message.entities.keys():
            self._end(name)
        self._fetch_places()
        for name, live in message.entities.items():
            self._take(name, live.pose.position_m, now_ns)

    def _fetch_places(self) -> None:
        version, solids, limits = self._places()
        if version != self._version:
            self._version, self._limits = version, limits
            self._all_places = tuple(solid for solid in solids if solid.is_place and solid.is_measured)

    def _take(self, name: str, at: Vector, now_ns: int) -> None:
        known = self._known.get(name)
        if known is not None:
            known.last = at
            is_near = math.dist(known.at, at) < _STEP_M or now_ns - known.ns < _STEP_NS
            is_current = known.place_version == self._version
            if is_near and is_current and math.dist(known.placed_at, at) < _PLACE_STEP_M:
                return
            places = self._find_places(at)
            if is_near and places == known.places:
                known.placed_at, known.place_version = at, self._version
                return
        else:
            places = self._find_places(at)
        self._known[name] = _Known(now_ns, at, places, at, at, self._version)
        self._record(name)

    def find_places(self, at: Vector) -> tuple[str, ...]:
        """Return the places of the map that a position is in, the smallest first."""
        self._fetch_places()
        return self._find_places(at)

    def _find_places(self, at: Vector) -> tuple[str, ...]:
        point = solid_of(
            PlacedEntity(name="", iri="", pose=Pose(position_m=at), size_m=None, place=False, model="")
        )
        if point is None:
            return ()
        found = [
            place
            for place in self._all_places
            if (made := within(point, place, self._limits)) is not None and made.holds
        ]
        return tuple(place.name for place in sorted(found, key=lambda place: place.footprint))

    def _record(self, name: str) -> None:
        known = self._known[name]
        self._waiting.append(_line(self._stamp_ns, name, known.at, known.places))

    def _record_rest(self, name: str) -> None:
        """Record the last position of an entity that stopped less than a step after the recorded one."""
        known = self._known[name]
        if math.dist(known.at, known.last) >= _REST_STEP_M:
            known.at, known.ns = known.last, self._received_ns
            self._record(name)

    def _end(self, name: str) -> None:
        self._record_rest(name)
        del self._known[name]
        self._waiting.append(TrailLine(self._stamp_ns, "end", name))

    def close(self) -> None:
        """Record that all live poses end, and write what waits."""
        for name in list(self._known):
            self._end(name)
        self.write()

    def write(self) -> None:
        """Write what waits; called once a second. An error is reported, and the lines are dropped."""
        now_ns = self._clock_ns()
        if now_ns - self._received_ns > _TIMEOUT_NS:
            for name in list(self._known):
                self._end(name)
        if self._known and now_ns - self._written_ns >= ON_PERIOD_NS:
            for name in self._known:
                self._record_rest(name)
            self._waiting.append(TrailLine(self._stamp_ns, "on"))
            self._written_ns = now_ns
        if not self._waiting or now_ns < self._retry_ns:
            self._waiting.clear()
            if now_ns < self._retry_ns:
                self._known.clear()
            return
        if not self._has_started:
            self._waiting.insert(0, TrailLine(self._waiting[0].ns, "start"))
        waiting, self._waiting = self._waiting, []
        try:
            is_full = self._file.append(waiting)
            self._has_started = True
            if is_full:
                self._file.begin_segment()
                for name in self._known:
                    self._record(name)
        except OSError as error:
            self._retry_ns = now_ns + _RETRY_NS
            self._has_started = False  # what was not written is a gap
            self._known.clear()
            self._report(f"the trail of live poses cannot be written: {error.strerror}; free space")


def _line(ns: int, name: str, at: Vector, places: tuple[str, ...]) -> TrailLine:
    x, y, z = (round(value, 2) for value in at)
    return TrailLine(ns, "at", name, (x, y, z), places)
