"""Where live entities were between commits, from their stored trail: the command `trail`. For any thread."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence, Set
from typing import Final

from msgspec import structs

from semmap.nodes.kb_node.relations.selection import resolve_word
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.trail_file import ON_PERIOD_NS, TrailLine
from semmap.schemas import errors, wording
from semmap.schemas.commands import FindTrail
from semmap.schemas.entities import Entity
from semmap.schemas.map_history import Spells, Trail, TrailPoint, Visit
from semmap.schemas.moments import When

_BRIDGED_NS: Final = 30_000_000_000
"""A visit continues after a gap in the live poses of at most this length."""
_FEW: Final = 5
_MOST_VISITS: Final = 1000
_NO_END: Final = 1 << 63


class Trails:
    """The visits and positions of the entities in a trail, in order of time, as known at `now_ns`."""

    def __init__(self, lines: Iterable[TrailLine], now_ns: int, names: Set[str] | None = None) -> None:
        """Read the lines, or only those about some entities."""
        self.visits: list[Visit] = []
        self.points: dict[str, list[TrailPoint]] = {}
        self.kept_since_ns = 0
        self._open: dict[tuple[str, str], int] = {}
        """The visits that have not ended, by entity and place."""
        self._interrupted: dict[tuple[str, str], int] = {}
        """The visits that ended with the live poses of the entity."""
        last_ns = 0
        for line in lines:
            self.kept_since_ns = self.kept_since_ns or line.ns
            if names is not None and line.name and line.name not in names:
                pass
            elif line.kind == "at":
                self._place(line)
            elif line.kind == "end":
                self._interrupt(line.name, line.ns)
            elif line.kind == "start":
                self._interrupt_all(last_ns)
            last_ns = line.ns
        if now_ns - last_ns > 2 * ON_PERIOD_NS:  # recording stopped, perhaps without an end
            self._interrupt_all(last_ns)
        self.visits.sort(key=lambda visit: visit.since_ns)

    def _place(self, line: TrailLine) -> None:
        if line.at is None:
            return
        point = TrailPoint(name=line.name, ns=line.ns, at=line.at, places=line.places)
        self.points.setdefault(line.name, []).append(point)
        for key, index in list(self._open.items()):
            if key[0] == line.name and key[1] not in line.places:
                self._close(index, line.ns)
                del self._open[key]
        for place in line.places:
            key = (line.name, place)
            if key in self._open:
                continue
            before = self._interrupted.pop(key, None)
            if before is not None and line.ns - (self.visits[before].until_ns or line.ns) <= _BRIDGED_NS:
                self.visits[before] = structs.replace(self.visits[before], until_ns=None, left=True)
                self._open[key] = before
            else:
                self._open[key] = len(self.visits)
                self.visits.append(Visit(name=line.name, place=place, since_ns=line.ns))
        for key in [key for key in self._interrupted if key[0] == line.name]:
            del self._interrupted[key]

    def _interrupt_all(self, ns: int) -> None:
        for name in self.points:
            self._interrupt(name, ns)

    def _interrupt(self, name: str, ns: int) -> None:
        """End the visits and the last position of an entity whose live poses ended."""
        points = self.points.get(name)
        if points and points[-1].until_ns is None:
            points[-1] = structs.replace(points[-1], until_ns=max(ns, points[-1].ns))
        for key in [key for key in self._open if key[0] == name]:
            self._interrupted[key] = self._open.pop(key)
            self._close(self._interrupted[key], ns, left=False)

    def _close(self, index: int, ns: int, *, left: bool = True) -> None:
        visit = self.visits[index]
        self.visits[index] = structs.replace(visit, until_ns=max(ns, visit.since_ns), left=left)

    def select_visits(
        self, names: Set[str], places: Set[str] | None, first_ns: int = 0, last_ns: int = _NO_END
    ) -> list[Visit]:
        """Return the visits of these entities to these places, or to any, that overlap with a period."""
        return [
            visit
            for visit in self.visits
            if visit.name in names
            and (places is None or visit.place in places)
            and visit.since_ns <= last_ns
            and (visit.until_ns is None or visit.until_ns >= first_ns)
        ]

    def select_points(self, name: str, first_ns: int = 0, last_ns: int = _NO_END) -> list[TrailPoint]:
        """Return where an entity was in a period, with the position that it had at its beginning."""
        points = [point for point in self.points.get(name, ()) if point.ns <= last_ns]
        begun = [i for i, point in enumerate(points) if point.ns <= first_ns]
        found = points[begun[-1] :] if begun else points
        return [point for point in found if point.until_ns is None or point.until_ns >= first_ns]


def find_trail(
    lines: Iterable[TrailLine], past: HistoryReader, present: Sequence[Entity], query: FindTrail, now_ns: int
) -> Trail:
    """Return what a trail contains about a query. Raises UnknownName, Refused, BadRequest."""
    every = list(lines)
    names = _resolve({line.name for line in every if line.name}, present, query.name)
    known_places = {place for line in every for place in line.places}
    trails = Trails(every, now_ns, names)
    places = None if query.in_ is None else _resolve(known_places, present, query.in_, are_places=True)
    first_ns, last_ns = _read_period(past, query, now_ns)
    visits = trails.select_visits(names, places, first_ns, last_ns)
    points = sorted(
        (point for name in names for point in trails.select_points(name, first_ns, last_ns)),
        key=lambda point: point.ns,
    )
    if query.at is not None:
        points = [found[-1] for name in sorted(names) if (found := [p for p in points if p.name == name])]
        text = _describe_moment(sorted(names), points)
    else:
        text = _describe_visits(
            sorted(names), query.in_, visits, max(first_ns, 0), min(last_ns, now_ns), now_ns
        )
        text += f" (live poses are stored for the last {describe_age(trails.kept_since_ns, now_ns)})"
    track = _thin(points, query.points)
    return Trail(
        names=tuple(sorted(names)),
        visits=tuple(visits[-query.limit :]),
        track=track,
        kept_since_ns=trails.kept_since_ns,
        omitted_visits=max(0, len(visits) - query.limit),
        omitted_points=len(points) - len(track),
        text=text,
    )


def add_visits(spells: Spells, trails: Trails, now_ns: int) -> Spells:
    """Return when an entity was in a place, with its visits by live poses, which no commit may have."""
    visits = trails.select_visits({spells.subject}, {spells.object})
    if spells.subject not in trails.points:
        return spells
    stored = f"live poses, stored for {describe_age(trails.kept_since_ns, now_ns)}"
    if not visits:
        return structs.replace(spells, text=f"{spells.text}; its {stored}, show no visit")
    by_poses = describe(visits, 0, now_ns, now_ns)
    if spells.spells:
        text = f"{spells.text}; by its {stored}, {by_poses}"
    else:
        text = f"{by_poses}, by its {stored}; no commit has a position of it there"
    return structs.replace(spells, text=text, visits=tuple(visits[-_MOST_VISITS:]))


def _resolve(
    recorded: Set[str], present: Sequence[Entity], word: str, *, are_places: bool = False
) -> frozenset[str]:
    """Return the entities that a word means, present or only recorded. Raises UnknownName, Refused."""
    if word in recorded:
        return frozenset((word,))
    names = resolve_word(present, word)
    if are_places:
        return names
    if not names & recorded:
        raise errors.Refused(
            f"no live poses of {wording.few(sorted(names), _FEW)} are stored; for committed changes:"
            f" semmap history {min(names)}"
        )
    return names & recorded


def _read_period(past: HistoryReader, query: FindTrail, now_ns: int) -> tuple[int, int]:
    """Return the first and the last time of a query [ns]. Raises BadRequest, Refused."""
    since, until = (query.since, query.until) if query.at is None else (query.at, query.at)
    if query.at is not None and (query.since is not None or query.until is not None):
        raise errors.BadRequest("at (--at) excludes since and until; give either a time or a period")
    first_ns = 0 if since is None else _span(past, since)[0]
    last_ns = _NO_END if until is None else _span(past, until)[1]
    if first_ns > now_ns:
        raise errors.Refused("the time is in the future; live poses are stored until now")
    if first_ns > last_ns:
        raise errors.BadRequest("since (--since) is later than until (--until); give the earlier time first")
    return first_ns, last_ns


def _span(past: HistoryReader, when: When) -> tuple[int, int]:
    moment = past.moment(when)
    return moment.first_ns, moment.last_ns


def _thin(points: Sequence[TrailPoint], most: int) -> tuple[TrailPoint, ...]:
    """Return at most this number of positions, evenly selected, with the last one."""
    if not points or not most:
        return ()
    step = math.ceil(len(points) / most)
    return tuple(points[::-1][::step][::-1])


def _describe_moment(names: Sequence[str], points: Sequence[TrailPoint]) -> str:
    """Return `r1 was at (1.00, 2.00, 0.00) m in kitchen1`."""
    texts = []
    for point in points[:_FEW]:
        x, y, z = point.at
        where = f" in {wording.few(point.places, _FEW)}" if point.places else ", in no place of the map"
        texts.append(f"{point.name} was at ({x:.2f}, {y:.2f}, {z:.2f}) m{where}")
    if len(points) > _FEW:
        texts.append(f"{len(points) - _FEW} more")
    if unknown := sorted({*names} - {point.name for point in points}):
        texts.append(f"the position of {wording.few(unknown, _FEW)} at that time is not stored")
    return "; ".join(texts)


def _describe_visits(
    names: Sequence[str], place: str | None, visits: Sequence[Visit], first_ns: int, last_ns: int, now_ns: int
) -> str:
    """Return `r1 was in kitchen1 3 times, 12 min in all, last until 3 min ago`."""
    by: dict[tuple[str, str], list[Visit]] = {}
    for visit in visits:
        by.setdefault((visit.name, visit.place), []).append(visit)
    if not by:
        where = f"in {place}" if place is not None else "in any place of the map"
        return f"{wording.few(names, _FEW)} {'was' if len(names) == 1 else 'were'} never {where}"
    newest_first = sorted(by, key=lambda key: (by[key][-1].until_ns or _NO_END, by[key][-1].since_ns))[::-1]
    texts = [describe(by[key], first_ns, last_ns, now_ns) for key in newest_first[:_FEW]]
    more = [f"{len(by) - _FEW} more; see the visits"] if len(by) > _FEW else []
    return "; ".join([*texts, *more])


def describe(visits: Sequence[Visit], first_ns: int, last_ns: int, now_ns: int) -> str:
    """Return how often, how long and when last an entity was in a place, in a period [ns]."""
    newest = visits[-1]
    total_s = sum(_lasted_s(visit, first_ns, last_ns) for visit in visits)
    often = "once" if len(visits) == 1 else f"{len(visits)} times"
    if newest.until_ns is None:
        last = f"has been in {newest.place} for {describe_age(newest.since_ns, now_ns)}"
    else:
        how = "until" if newest.left else "when its live poses ended"
        last = f"was in {newest.place} {how} {describe_age(newest.until_ns, now_ns)} ago"
    return f"{newest.name} {last}, {often}, {wording.duration(total_s)} in all"


def describe_age(ns: int, now_ns: int) -> str:
    """Return `12 s`; `0 s` for a time that is in the future because the clock was set back."""
    return wording.duration(max(0, now_ns - ns) / 1e9)


def _lasted_s(visit: Visit, first_ns: int, last_ns: int) -> float:
    end_ns = last_ns if visit.until_ns is None else min(visit.until_ns, last_ns)
    return max(0, end_ns - max(visit.since_ns, first_ns)) / 1e9
