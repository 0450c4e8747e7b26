"""Records where live entities are, between commits: a downsampled track, and the places they enter and leave.

Lines are collected and written once a second without waiting for the disk. The loss at an abrupt end of the
process is therefore at most a second, and at an end of the machine what it had not written yet.
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
from semmap.nodes.kb_node.storage.trail_file import TrailFile, TrailLine
from semmap.schemas.entities import Pose, Vector
from semmap.schemas.live import LivePoses

WRITE_PERIOD_S: Final = 1.0
_ON_PERIOD_NS: Final = 5_000_000_000
"""Resting entities are confirmed together at this interval."""
_TIMEOUT_NS: Final = 3_000_000_000
"""Live poses are published at least once a second. After this time without one they have ended."""
_STEP_M: Final = 0.25
"""The least distance between two positions of a track."""
_STEP_NS: Final = 1_000_000_000
"""The least time between two positions of a track, unless the places change."""
_PLACE_STEP_M: Final = 0.05
"""The places of an entity are determined again after this distance."""
_RETRY_NS: Final = 60_000_000_000
"""The time until the file is tried again that could not be written."""


class _Known(Struct):
    """The last recorded state of an entity, and where its places were last determined."""

    ns: int
    at: Vector
    places: tuple[str, ...]
    placed_at: Vector
    place_version: int


class TrailRecorder:
    """Owned by the node's thread."""

    def __init__(
        self,
        file: TrailFile,
        places: Callable[[], tuple[int, Iterable[Solid], Thresholds]],
        report: Callable[[str], None],
        clock_ns: Callable[[], int] = time.time_ns,
    ) -> None:
        """`places()` returns the version of the map, its solids and the thresholds of relations."""
        self._file, self._places, self._report, self._clock_ns = file, places, report, clock_ns
        self._known: dict[str, _Known] = {}
        self._waiting: list[TrailLine] = []
        self._has_started = False
        self._received_ns = 0
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
        self._received_ns = now_ns
        self._fetch_places()
        for name in self._known.keys() - message.entities.keys():
            self._end(name, now_ns)
        for name, live in message.entities.items():
            self._take(name, live.pose.position_m, now_ns)

    def _fetch_places(self) -> None:
        version, solids, limits = self._places()
        if version != self._version:
            self._version, self._limits = version, limits
            self._all_places = tuple(solid for solid in solids if solid.is_place and solid.is_measured)

    def _take(self, name: str, at: Vector, now_ns: int) -> None:
        known = self._known.get(name)
        if known is not None and known.place_version == self._version:
            if math.dist(known.placed_at, at) < _PLACE_STEP_M:
                return
            places = self._find_places(at)
            known.placed_at = at
            is_near = math.dist(known.at, at) < _STEP_M or now_ns - known.ns < _STEP_NS
            if is_near and places == known.places:
                return
        else:
            places = self._find_places(at)
            if known is not None and places == known.places and math.dist(known.at, at) < _STEP_M:
                known.place_version = self._version
                return
        self._known[name] = _Known(now_ns, at, places, at, self._version)
        self._waiting.append(_line(now_ns, name, at, places))

    def _find_places(self, at: Vector) -> tuple[str, ...]:
        """Return the places that a position is in, the smallest first."""
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

    def _end(self, name: str, now_ns: int) -> None:
        del self._known[name]
        self._waiting.append(TrailLine(now_ns, "end", name))

    def write(self) -> None:
        """Write what waits; called once a second. An error is reported, and the lines are dropped."""
        now_ns = self._clock_ns()
        if self._known and now_ns - self._received_ns > _TIMEOUT_NS:
            for name in list(self._known):
                self._end(name, max(self._received_ns, self._known[name].ns))
        if self._known and now_ns - self._written_ns >= _ON_PERIOD_NS:
            self._waiting.append(TrailLine(max(self._received_ns, self._written_ns), "on"))
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
                self._waiting = [
                    _line(now_ns, name, known.at, known.places) for name, known in self._known.items()
                ]
        except OSError as error:
            self._retry_ns = now_ns + _RETRY_NS
            self._has_started = False  # what was not written is a gap
            self._known.clear()
            self._report(f"the trail of live poses cannot be written: {error.strerror}; free space")


def _line(ns: int, name: str, at: Vector, places: tuple[str, ...]) -> TrailLine:
    x, y, z = (round(value, 2) for value in at)
    return TrailLine(ns, "at", name, (x, y, z), places)
