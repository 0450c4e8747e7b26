"""Standing location queries: which entities are on, in or near something, and which arrive and leave."""

from __future__ import annotations

import time
import uuid
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from semmap.nodes.kb_node.answers import term_resolution
from semmap.nodes.kb_node.relations.facts.place_facts import Fact
from semmap.nodes.kb_node.relations.geometry.solids import solid_of
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.selection import (
    Targets,
    filter_entities,
    require_complete,
    require_possible,
    resolve_words,
)
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.sparql.protocol import QueryUpdate
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import Renew, Watch
from semmap.schemas.entities import Entity
from semmap.schemas.relations import Where
from semmap.schemas.replies import Done
from semmap.schemas.sparql import Row, RowsChanged, Watching

STANDING = 64
"""Largest number of standing location queries."""
VARIABLES = ("entity",)


@dataclass
class _LocationQuery:
    """One query. `ends` is the end of its lease [s, monotonic]."""

    watch: str
    class_name: str | None
    where: Where
    lease_s: float
    ends: float
    meant: Targets
    found: dict[str, Row]
    """The entities in the result, by name."""
    seq: int


class LocationQueries:
    """Keeps the standing location queries up to date with the map. Owned by the node's thread."""

    def __init__(self, semantic_map: SemanticMap, publish: Callable[[QueryUpdate], None]) -> None:
        self._map = semantic_map
        self._publish = publish
        self._queries: dict[str, _LocationQuery] = {}
        self._entities: dict[str, Entity] = {}
        """The entities at the last evaluation, while there is a query."""
        self._touched: set[str] = set()
        self._left_out: frozenset[Fact] = frozenset()
        """The measured facts that were suppressed at the last evaluation."""

    def watch(self, command: Watch) -> Watching:
        """Start a query.

        Raises UnknownName, UnknownClass, NameTaken, BadRequest, Refused if there are too many.
        """
        self.drop_expired()
        name = command.watch or f"q{uuid.uuid4().hex[:12]}"
        if name in self._queries:
            raise errors.NameTaken(f"there is a standing query '{name}' already")
        if len(self._queries) >= STANDING:
            raise errors.Refused(f"there are {STANDING} standing queries already; end one first")
        where = command.where or Where()
        require_complete(where)
        class_name = None
        if command.class_ is not None:
            class_name = v.local_name(term_resolution.resolve_class(self._map, command.class_))
        those = resolve_words(where, tuple(self._map.entities()))
        require_possible(self._map.places.space(), those, where.within)
        if not self._queries:
            self._entities = {entity.name: entity for entity in self._map.entities()}
            self._left_out = self._map.derived_facts.suppressed_measurements
        self._queries[name] = standing = _LocationQuery(
            watch=name,
            class_name=class_name,
            where=where,
            lease_s=command.lease,
            ends=time.monotonic() + command.lease,
            meant=those,
            found={},
            seq=self._map.seq,
        )
        standing.found = self._evaluate(standing, self._map.names)
        return Watching(
            watch=name,
            variables=VARIABLES,
            rows=tuple(standing.found.values()),
            seq=self._map.seq,
            lease_s=command.lease,
        )

    def renew(self, renewal: Renew) -> Done | None:
        """Renew or end a query. Return None if it is not one of these."""
        standing = self._queries.get(renewal.watch)
        if standing is None:
            return None
        if renewal.end:
            self._drop(standing)
            return Done(text=f"{renewal.watch} has ended")
        standing.ends = time.monotonic() + standing.lease_s
        return Done(text=f"{renewal.watch} is renewed for {standing.lease_s:g} s")

    def drop_expired(self) -> None:
        """End the queries whose lease has expired."""
        for standing in [s for s in self._queries.values() if s.ends <= time.monotonic()]:
            self._drop(standing)

    def follow(self, seq: int, names: Iterable[str]) -> None:
        """Update the queries after a commit that touched these entities.

        If the map has later commits already, the changes are published with the last one.
        """
        if not self._queries:
            return
        self._touched.update(names)
        left_out = self._map.derived_facts.suppressed_measurements
        self._touched.update(fact[0] for fact in left_out ^ self._left_out)
        self._left_out = left_out
        if seq < self._map.seq or not self._touched:
            return
        self.drop_expired()
        touched, self._touched = self._touched, set()
        is_renamed = any(
            _designations(self._entities.get(name)) != _designations(self._map.find(name)) for name in touched
        )
        concerned = self._affected(touched)
        for standing in self._queries.values():
            if is_renamed:
                standing.meant = self._meant(standing.where)
            self._update(standing, concerned, touched, seq)
        for name in touched:
            if (entity := self._map.find(name)) is None:
                self._entities.pop(name, None)
            else:
                self._entities[name] = entity

    def _affected(self, touched: Iterable[str]) -> set[str]:
        """Return the entities whose relations may change: those touched, their neighbours and loads."""
        space = self._map.places.space()
        found = set(touched)
        for name in touched:
            before = self._entities.get(name)
            for solid in (None if before is None else solid_of(before), space.solids.get(name)):
                if solid is not None:
                    found.update(other.name for other in space.around(solid))
        loads = self._map.places.loads()
        return found.union(*(loads.find_all(name) for name in found))

    def _update(self, standing: _LocationQuery, concerned: set[str], touched: set[str], seq: int) -> None:
        candidates = concerned | standing.found.keys()
        near = standing.meant.near or frozenset()
        if not near.isdisjoint(touched):
            space = self._map.places.space()
            reach = standing.where.within or space.limits.near_most_m
            for name in near & space.solids.keys():
                candidates.update(other.name for other in space.around(space.solids[name], reach))
        now = self._evaluate(standing, candidates)
        came = [row for name, row in now.items() if name not in standing.found]
        left = [row for name, row in standing.found.items() if name not in now]
        since, standing.found, standing.seq = standing.seq, now, seq
        if came or left:
            news = RowsChanged(
                watch=standing.watch,
                seq=seq,
                since=since,
                appeared=tuple(came),
                disappeared=tuple(left),
            )
            self._publish(QueryUpdate(watch=standing.watch, rows=news))

    def _evaluate(self, standing: _LocationQuery, names: Iterable[str]) -> dict[str, Row]:
        """Return the rows of those of these names that are in the result, in the order of names."""
        found = (self._map.find(name) for name in sorted(names))
        class_name = standing.class_name
        candidates = [e for e in found if e is not None and (class_name is None or class_name in e.types)]
        space: Space = self._map.places.space()
        there = filter_entities(
            space, candidates, standing.where, standing.meant, self._map.derived_facts.suppressed_measurements
        )
        return {entity.name: (v.iri(entity.iri),) for entity in there}

    def _meant(self, where: Where) -> Targets:
        """Return the entities that the words of a query mean now; none for a word that matches nothing."""
        try:
            return resolve_words(where, tuple(self._map.entities()))
        except errors.UnknownName:
            return Targets(*(None if word is None else frozenset() for word in where.words))

    def _drop(self, standing: _LocationQuery) -> None:
        del self._queries[standing.watch]
        if not self._queries:
            self._entities = {}
        self._publish(QueryUpdate(watch=standing.watch, ended=True))


def _designations(entity: Entity | None) -> tuple[object, ...]:
    """Return the class names and labels by which a word may mean an entity."""
    if entity is None:
        return ()
    return (entity.types, entity.preferred_reference, entity.alternative_references)
