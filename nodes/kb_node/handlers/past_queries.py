"""Handlers for queries about the past: changes, times of relations, trails, and last sightings."""

from __future__ import annotations

import time
from collections.abc import Iterator
from concurrent.futures import Future

from msgspec import structs

from semmap.nodes.kb_node.answers.live_poses import LiveEntities
from semmap.nodes.kb_node.answers.past import (
    commit_selection,
    differences,
    individual_history,
    live_sightings,
    trails,
)
from semmap.nodes.kb_node.answers.past.episodes.timeline import Timeline
from semmap.nodes.kb_node.answers.past.renames import Renames
from semmap.nodes.kb_node.answers.past.trail_recording import TrailRecorder
from semmap.nodes.kb_node.answers.sightings import Sightings, describe_closed, find_closed_container
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.relations.selection import is_in
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage import history, trail_file
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.kb_node.storage.trail_file import TrailLine
from semmap.nodes.runtime.fair_queue import FairPool
from semmap.schemas import errors
from semmap.schemas.calls import Handler, by_verb
from semmap.schemas.commands import Diff, FindTrail, History, LastSeen, WasWhen
from semmap.schemas.entities import Entity
from semmap.schemas.map_history import Difference, Spells, Trail
from semmap.schemas.replies import LoggedCommit, Sighting


class PastQueryHandlers:
    """Answers queries from the journal and the stored trail of live poses. Changes nothing."""

    def __init__(
        self,
        semantic_map: SemanticMap,
        journal: Journal,
        past: history.HistoryReader,
        live: LiveEntities,
        trail: TrailRecorder,
        sightings: Sightings,
        aside: FairPool,
    ) -> None:
        """Create the handlers. `aside` executes what takes long."""
        self._map = semantic_map
        self._journal = journal
        self._past = past
        self._live = live
        self._trail = trail
        self._sightings = sightings
        self._aside = aside

    def handlers(self) -> dict[str, Handler]:
        """Return the handlers by command."""
        return by_verb(
            Diff.answered_by(self.on_diff),
            WasWhen.answered_by(self.on_when),
            FindTrail.answered_by(self.on_trail),
            History.answered_by(self.on_history),
            LastSeen.answered_by(self.on_last_seen),
        )

    def on_diff(self, query: Diff) -> Future[Difference]:
        """Return what changed between two commits or times."""
        limits = self._map.classes.limits
        return self._aside.submit(differences.compute_difference, self._journal, self._past, query, limits)

    def on_when(self, query: WasWhen) -> Future[Spells]:
        """Return when one object was on, in or at another."""
        limits = self._map.classes.limits
        self._trail.write()
        return self._aside.submit(self._find_spells, query, limits)

    def _find_spells(self, query: WasWhen, limits: Thresholds) -> Spells:
        found = differences.find_spells(self._journal, self._past, query, limits)
        if query.relation != "isLocatedIn":
            return found
        now_ns = time.time_ns()
        renames = Renames.of(self._past, (found.subject, found.object)).in_time(self._journal)
        lines = renames.in_trail(self._trail_lines())
        return trails.add_visits(found, trails.Trails(lines, now_ns, {found.subject}), now_ns)

    def timeline(self) -> Timeline:
        """Return the past until now, for questions in words."""
        self._trail.write()
        limits = self._map.classes.limits
        return Timeline(self._journal, self._past, limits, self._trail_lines, time.time_ns())

    def _trail_lines(self) -> Iterator[TrailLine]:
        return trail_file.read_lines(self._journal.path.parent)

    def on_trail(self, query: FindTrail) -> Future[Trail]:
        """Return where live entities were, by their stored trail."""
        self._trail.write()
        present = tuple(self._map.entities())
        return self._aside.submit(
            lambda: trails.find_trail(self._trail_lines(), self._past, present, query, time.time_ns())
        )

    def on_history(self, query: History) -> Future[tuple[LoggedCommit, ...]]:
        """Return commits of the history, of an entity, or of an individual that is not in space."""
        limits = self._map.classes.limits
        if (word := query.name) is not None:
            try:
                query = structs.replace(query, name=self._resolve_past(word))
            except errors.UnknownName:
                individuals = self._map.individuals
                term = individuals.find_term(word) or individuals.parse_iri(word)  # also of a removed one
                return self._aside.submit(
                    individual_history.list_commits, self._journal, self._past, query, limits, term
                )
        return self._aside.submit(commit_selection.list_commits, self._journal, self._past, query, limits)

    def on_last_seen(self, query: LastSeen) -> Sighting | Future[Sighting]:
        """Return where an entity was last seen, or where it is."""
        name = self._resolve_past(query.name)
        entity = self._map.find(name)
        if entity is None or self._sightings.is_missing(entity):
            return self._aside.submit(self._sightings.describe_removed, name, entity)
        found, closed = self._sightings.describe_present(entity), self._describe_closed(entity)
        if (live := self._live.find(entity)) is not None:
            places = self._trail.find_places(live.pose.position_m)
            found = live_sightings.set_live_pose(found, live.pose, places, time.time_ns())
        elif entity.tracked:
            self._trail.write()
            return self._aside.submit(self._find_last_pose, found, closed)
        return structs.replace(found, text=f"{found.text}{closed}")

    def _find_last_pose(self, found: Sighting, closed: str) -> Sighting:
        now_ns = time.time_ns()
        last = trails.Trails(self._trail_lines(), now_ns, {found.name})
        seen = live_sightings.set_last_pose(found, last, now_ns)
        # `closed` is about the committed pose.
        return structs.replace(found, text=f"{found.text}{closed}") if seen is found else seen

    def _describe_closed(self, entity: Entity) -> str:
        """Return `; not observable: ...` if an entity is in a closed container, also by its live pose."""
        closed = find_closed_container(self._map, entity)
        if closed is not None and self._live.find(entity) is not None:
            with self._live.applied():
                space = self._map.places.space()
                solid = space.solids.get(entity.name)
                if solid is None or not is_in(space, solid, {closed.entity.name}, frozenset()):
                    return ""
        return "" if closed is None else f"; {describe_closed(closed)}"

    def _resolve_past(self, word: str) -> str:
        """Return the name, present or former, that a word means. Raises UnknownName, BadRequest."""
        if self._map.find(word) is not None:
            return word
        iri = self._map.individuals.parse_iri(word)
        if iri is not None and (entity := self._map.find_by_individual(iri)) is not None:
            return entity.name
        return self._past.resolve(word, tuple(self._map.entities()))
