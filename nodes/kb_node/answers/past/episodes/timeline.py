"""Events and intervals of the past of a map, from its journal and the trail of live poses."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from functools import cached_property
from typing import Final, NamedTuple

from semmap.nodes.kb_node.answers.past import states
from semmap.nodes.kb_node.answers.past.fact_intervals import PoseChanges, find_intervals
from semmap.nodes.kb_node.answers.past.renames import Renames
from semmap.nodes.kb_node.answers.past.span_texts import stamp_of
from semmap.nodes.kb_node.answers.past.trails import Trails
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.storage.changelog import Changelog
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.kb_node.storage.trail_file import TrailLine
from semmap.schemas import errors
from semmap.schemas.changes import Change
from semmap.schemas.commands import WasWhen
from semmap.schemas.commits import Commit
from semmap.schemas.entities import Entity, Pose, distance_m
from semmap.schemas.episodes import Episode
from semmap.schemas.map_history import TimedRelation

_LONGEST_S: Final = 20.0
"""The longest time for all questions of a text, because a thread of the pool answers them [s]."""
_MOVED_M: Final = 0.01
"""Smaller changes of a position are not a move."""


class State(NamedTuple):
    """The map after a commit."""

    seq: int
    entities: dict[str, Entity]
    space: Space


class Timeline:
    """The past of one map. For any thread."""

    def __init__(
        self,
        journal: Journal,
        past: HistoryReader,
        limits: Thresholds,
        trail: Callable[[], Iterable[TrailLine]],
        now_ns: int,
        longest_s: float = _LONGEST_S,
    ) -> None:
        """`trail()` returns the lines of the stored trail of live poses.

        Methods that read the journal raise Refused `longest_s` after the first one is called.
        """
        self.journal, self.past, self.now_ns = journal, past, now_ns
        self.limits, self._trail = limits, trail
        self._longest_s, self._begun_s = longest_s, 0.0
        self._trails: dict[str, Trails] = {}

    @property
    def first_ns(self) -> int:
        """Return when the history begins [ns]."""
        return stamp_of(self.journal, self.journal.first)

    def check_time(self) -> None:
        """Raise Refused if reading the journal takes too long."""
        self._begun_s = self._begun_s or time.monotonic()
        if time.monotonic() - self._begun_s >= self._longest_s:
            raise errors.Refused(
                f"the history is too long to answer this within {self._longest_s:.0f} s;"
                " ask about one thing or a shorter time"
            )

    def pose_changes(self) -> Iterator[PoseChanges]:
        """Yield what the commits changed of poses, in order."""
        for moves in self.journal.decode_partially(PoseChanges):
            self.check_time()
            yield moves

    @cached_property
    def present(self) -> State:
        """Return the map after the last commit."""
        return self.state(self.journal.last)

    def state(self, seq: int) -> State:
        """Return the map after a commit of the history."""
        self.check_time()
        entities = {entity.name: entity for entity in self.past.entities(seq)}
        return State(seq, entities, Space(list(entities.values()), self.limits))

    def last_state_of(self, name: str) -> Entity | None:
        """Return an entity as it was when it was last changed."""
        for seq in reversed(self.journal.touching(name)):
            for entity in self.journal.commit(seq).changed:
                if entity.name == name:
                    return entity
        return self.past.initial_entities().get(name)

    def seq_at(self, ns: int) -> int:
        """Return the last commit up to a time, at least the one that the history begins with."""
        return max(self.journal.stamps.seq_at(ns), self.journal.first - 1, 1)

    def stamp(self, seq: int) -> int:
        """Return the time of a commit [ns]."""
        return stamp_of(self.journal, seq)

    def places_by_trail(self, name: str, ns: int) -> tuple[str, ...] | None:
        """Return the places of an entity at a time by its live poses, or None if none are stored."""
        trails = self.trails(name)
        points = [p for p in trails.points.get(name, ()) if p.ns <= ns]
        if not points or (points[-1].until_ns is not None and points[-1].until_ns < ns):
            return None
        return points[-1].places

    def trails(self, name: str) -> Trails:
        """Return the trail of an entity."""
        if name not in self._trails:
            renames = Renames.of(self.past, (name,)).in_time(self.journal)
            self._trails[name] = Trails(renames.in_trail(self._trail()), self.now_ns, {name})
        return self._trails[name]

    def intervals(
        self, subjects: Iterable[str], relations: Iterable[TimedRelation], other: str, what: str
    ) -> dict[str, list[Episode]]:
        """Return when each subject was related to another entity, by commits and, in places, by live poses.

        Several relations count as one: on or inside a fridge.
        """
        names, kinds = [name for name in subjects if name != other], list(relations)
        facts = [(name, relation, other) for name in names for relation in kinds]
        found = find_intervals(
            self.pose_changes(),
            self.past.initial_entities().values(),
            facts,
            self.limits,
            Renames.of(self.past, (*names, other)),
            in_any_place=True,
        )
        episodes: dict[str, list[Episode]] = {}
        for name in names:
            spans = [span for relation in kinds for span in found[name, relation, other]]
            episodes[name] = [self._episode(name, what, *span) for span in join_spans(spans)]
            if "isLocatedIn" in kinds and self.is_live(name):
                episodes[name] = self._with_visits(name, other, what, episodes[name])
        return episodes

    def is_live(self, name: str) -> bool:
        """Return whether live poses of an entity are stored."""
        return name in self._trail_names and bool(self.trails(name).points.get(name))

    @property
    def live_names(self) -> list[str]:
        """Return the entities of which live poses are stored."""
        return sorted(name for name in self._trail_names if self.is_live(name))

    @cached_property
    def _trail_names(self) -> frozenset[str]:
        return frozenset(line.name for line in self._trail() if line.name)

    def _with_visits(self, name: str, place: str, what: str, committed: list[Episode]) -> list[Episode]:
        """Return the visits to a place by live poses, after what commits contain of the time before them."""
        trails = self.trails(name)
        begun_ns = trails.points[name][0].ns
        before = [e for e in committed if e.until_ns is not None and e.until_ns <= begun_ns]
        visits = trails.select_visits({name}, {place})
        return before + [
            Episode(subject=name, what=what, since_ns=v.since_ns, until_ns=v.until_ns) for v in visits
        ]

    def state_intervals(self, subject: str, property_name: str, value: bool, what: str) -> list[Episode]:
        """Return when a property had a value. Raises BadRequest if the entity never had the property."""
        query = WasWhen(name=subject, relation=property_name, other=value)
        found = states.find_state_spells(self.journal, self.past, query).spells
        return [self._episode(subject, what, spell.since, spell.until) for spell in found]

    def _episode(self, subject: str, what: str, since: int, until: int | None) -> Episode:
        return Episode(
            subject=subject,
            what=what,
            since=since,
            since_ns=self.stamp(since) if since else self.first_ns,
            until=until,
            until_ns=None if until is None else self.stamp(until),
        )

    def author(self, seq: int) -> str:
        """Return the agent of a commit or, without one, its source."""
        commit = self.journal.commit(seq)
        return commit.agent or commit.source

    def changes(self, subject: str) -> list[tuple[Commit, tuple[Change, ...]]]:
        """Return the commits that touched an entity, with what they changed of it."""
        changelog = Changelog(self.journal, self.past.initial_entities)
        found = []
        for seq, had in self.past.touching(subject):
            self.check_time()
            commit = self.journal.commit(seq)
            found.append((commit, tuple(c for c in changelog.of(commit, had) if c.name in (had, subject))))
        return found

    def events(self, subject: str, kind: str, what: str) -> list[Episode]:
        """Return when an entity was moved, added, removed or changed."""
        return [
            Episode(
                subject=subject,
                what=what,
                since=commit.seq,
                since_ns=commit.stamp_ns,
                by=commit.agent or commit.source,
            )
            for commit, changes in self.changes(subject)
            if any(is_event(change, kind) for change in changes)
        ]


def is_event(change: Change, kind: str) -> bool:
    """Return whether a change is a move, an addition, a removal, or any change."""
    if kind == "move":
        was, now = change.was, change.now
        if change.kind != "pose" or not isinstance(was, Pose) or not isinstance(now, Pose):
            return False
        return distance_m(was, now) >= _MOVED_M
    if kind == "add":
        return change.kind == "added"
    if kind == "remove":
        return change.kind == "removed"
    return True


def join_spans(spans: list[tuple[int, int | None]]) -> list[tuple[int, int | None]]:
    """Return intervals in order, those that overlap or follow each other as one."""
    joined: list[tuple[int, int | None]] = []
    for since, until in sorted(spans, key=lambda span: span[0]):
        if joined and (joined[-1][1] is None or since <= joined[-1][1]):
            last = joined[-1][1]
            joined[-1] = (joined[-1][0], None if last is None or until is None else max(last, until))
        else:
            joined.append((since, until))
    return joined
