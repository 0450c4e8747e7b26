"""Time intervals in which computed relations held, from the poses in the journal.

The journal is read once. Relations are measured again only at commits that change something near the object.
The result is the same after a restart.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from itertools import groupby
from typing import NamedTuple

from msgspec import Struct, structs

from semmap.nodes.kb_node.answers.past.renames import Renames
from semmap.nodes.kb_node.relations.facts.pair_facts import are_near
from semmap.nodes.kb_node.relations.facts.place_facts import Fact
from semmap.nodes.kb_node.relations.facts.rules import RULES
from semmap.nodes.kb_node.relations.geometry.opening import positions_of
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring import places
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.ontology.model_shapes import model_in_world, own_size_m
from semmap.schemas.attachments import IS_GRASPED_BY
from semmap.schemas.entities import Entity, Pose, Size, Stated
from semmap.schemas.polygons import EXTENT

_MARGIN_M = 1.5
"""Margin beyond the reach of the object, so that all cells of the spatial index around it are complete."""


class _PlacedEntity(Struct, frozen=True):
    """The part of an entity that relations need."""

    name: str
    iri: str
    pose: Pose | None = None
    size_m: Size | None = None
    place: bool = False
    model: str = ""
    fixed: bool = False
    properties: dict[str, Stated] = {}

    @property
    def placed(self) -> PlacedEntity:
        stated = self.properties.get(EXTENT) if self.place else None
        model = self.model if self.place else model_in_world(self.name, self.model, self.size_m)
        held_by = self.properties.get(IS_GRASPED_BY)
        return PlacedEntity(
            name=self.name,
            iri=self.iri,
            pose=self.pose,
            size_m=self.size_m,
            place=self.place,
            model=model,
            extent=stated if isinstance(stated, str) else "",
            held_by=held_by if isinstance(held_by, str) else "",
            joints=positions_of(model, self.size_m or own_size_m(model), self.properties),
            fixed=self.fixed,
        )


class _RemovedEntity(Struct, frozen=True):
    name: str


class PoseChanges(Struct, frozen=True):
    """The part of a commit that determines the poses after it."""

    seq: int
    changed: tuple[_PlacedEntity, ...] = ()
    removed: tuple[_RemovedEntity, ...] = ()


class FactStarts(NamedTuple):
    """The commits since which facts have held without interruption, as far as the journal goes back."""

    since: Mapping[Fact, int]
    """By commit. 0 stands for a time before the first commit of the journal."""
    first: int = 1

    def describe(self, facts: Collection[Fact]) -> str | None:
        """Return since when all of these have held together, such as "since commit 7", or None if unknown."""
        if not facts or not self.since.keys() >= set(facts):
            return None
        latest = max(self.since[fact] for fact in facts)
        return f"since commit {latest}" if latest else f"since before commit {self.first}"


def look_up_starts(
    journal: Journal, past: HistoryReader, facts: Collection[Fact], limits: Thresholds
) -> FactStarts:
    """Return since when each fact has held without interruption, also under earlier names."""
    renames = Renames.of(past, {name for s, _, o in facts for name in (s, o)})
    found = find_fact_starts(
        journal.decode_partially(PoseChanges), past.initial_entities().values(), facts, limits, renames
    )
    return FactStarts(found, journal.first)


def find_fact_starts(
    history: Iterable[PoseChanges],
    first: Iterable[Entity],
    facts: Collection[Fact],
    limits: Thresholds,
    renames: Renames | None = None,
) -> dict[Fact, int]:
    """Return the commit since which each fact has held. Facts that do not hold at the end are left out.

    For commits and thresholds see `find_intervals`.
    """
    found = find_intervals(history, first, facts, limits, renames)
    return {fact: spans[-1][0] for fact, spans in found.items() if spans and spans[-1][1] is None}


def find_intervals(
    history: Iterable[PoseChanges],
    first: Iterable[Entity],
    facts: Collection[Fact],
    limits: Thresholds,
    renames: Renames | None = None,
    *,
    in_any_place: bool = False,
) -> dict[Fact, list[tuple[int, int | None]]]:
    """Return for each fact the intervals [first commit, end commit) in order; None is an open end.

    `history` are the commits in order and `first` the entities before them. An interval that began before the
    first commit begins with 0. All measurements use the given thresholds. An object is located in the
    smallest place around it. With `in_any_place` it is also located in all places that this one is part of,
    and a place in those around it. `renames` has the earlier names of the entities of the facts.
    """
    renames = Renames() if renames is None else renames
    at_first = (with_present_names(PlacedEntity.of(entity), 0, renames) for entity in first)
    placed_by_name = {placed.name: placed for placed in at_first}
    by_name = groupby(sorted(facts), key=lambda fact: fact[0])
    spots = [
        _Neighbourhood(name, frozenset(about), limits, placed_by_name, in_any_place)
        for name, about in by_name
    ]
    found: dict[Fact, list[tuple[int, int | None]]] = {fact: [] for fact in facts}
    since = {fact: 0 for spot in spots for fact in spot.holding()}
    for moves in history:
        removed = [renames.present(left.name, moves.seq) for left in moves.removed]
        changed = [with_present_names(stood.placed, moves.seq, renames) for stood in moves.changed]
        names = [*(placed.name for placed in changed), *removed]
        before = {name: placed_by_name.get(name) for name in names}
        for name in removed:
            placed_by_name.pop(name, None)
        placed_by_name.update((placed.name, placed) for placed in changed)
        shifted = {
            name: (was, placed_by_name.get(name))
            for name, was in before.items()
            if was != placed_by_name.get(name)
        }
        for spot in spots:
            if spot.follow(shifted, placed_by_name):
                holding = spot.holding()
                for fact in spot.facts:
                    if fact in holding:
                        since.setdefault(fact, moves.seq)
                    elif fact in since:
                        found[fact].append((since.pop(fact), moves.seq))
    for fact, seq in since.items():
        found[fact].append((seq, None))
    return found


def with_present_names(placed: PlacedEntity, seq: int, renames: Renames) -> PlacedEntity:
    """Return an entity after a commit under its present name, attached to the present name of its holder."""
    name, holder = renames.present(placed.name, seq), renames.present(placed.held_by, seq)
    if (name, holder) == (placed.name, placed.held_by):
        return placed
    return structs.replace(placed, name=name, held_by=holder)


class _Neighbourhood:
    """An object and what is near it."""

    def __init__(
        self,
        name: str,
        facts: frozenset[Fact],
        limits: Thresholds,
        placed_by_name: dict[str, PlacedEntity],
        in_any_place: bool,
    ) -> None:
        """Create the neighbourhood. `facts` are about the object; `placed_by_name` has all entities."""
        self._in_any_place = in_any_place
        self.facts = facts
        self._near = frozenset(fact[2] for fact in facts if fact[1] == "isNear")
        self._margin_m = max(_MARGIN_M, limits.near_most_m + _MARGIN_M) if self._near else _MARGIN_M
        self._name = name
        self._limits = limits
        self._begin(placed_by_name)

    def _begin(self, placed_by_name: dict[str, PlacedEntity]) -> None:
        self._own = placed_by_name.get(self._name)
        near = [placed for placed in placed_by_name.values() if self._is_near(placed)]
        self._space = Space(near, self._limits)

    def follow(
        self,
        shifted: dict[str, tuple[PlacedEntity | None, PlacedEntity | None]],
        placed_by_name: dict[str, PlacedEntity],
    ) -> bool:
        """Apply changed poses. Return whether they matter here."""
        if self._name in shifted:
            self._begin(placed_by_name)
            return True
        matters = False
        for name, (was, now) in shifted.items():
            if self._is_near(was) or self._is_near(now):
                matters = True
                if now is None:
                    self._space.remove(name)
                else:
                    self._space.put(now)
        return matters

    def holding(self) -> frozenset[Fact]:
        """Return those of the facts that hold."""
        solid = self._space.solids.get(self._name)
        if solid is None:
            return frozenset()
        found: set[Fact] = set()
        if not solid.is_place:
            found = {(self._name, *about) for rule in RULES for about in rule.facts(self._space, solid)}
        if self._in_any_place:
            found.update(fact for fact in self.facts if self._is_within(solid, fact))
        for other in map(self._space.solids.get, self._near):
            if other is not None and are_near(self._space, solid, other):
                found.add((self._name, "isNear", other.name))
        return self.facts & found

    def _is_within(self, solid: Solid, fact: Fact) -> bool:
        """Return whether the fact states that the object is in a place, and it is."""
        _, relation, other = fact
        place = self._space.solids.get(other) if relation == "isLocatedIn" else None
        if place is None or not place.is_place or place is solid:
            return False
        made = places.within(solid, place, self._space.limits, also_places=True)
        return made is not None and made.holds

    def _is_near(self, placed: PlacedEntity | None) -> bool:
        own = self._own
        if placed is None or placed.pose is None or own is None or own.pose is None:
            return False
        apart = math.dist(placed.pose.position_m[:2], own.pose.position_m[:2])
        return apart <= _reach(placed) + _reach(own) + self._margin_m


def _reach(placed: PlacedEntity) -> float:
    """Return how far an object may extend from its position in any orientation [m]."""
    size = placed.size_m or own_size_m(placed.model)
    return 0.0 if size is None else math.hypot(*size)
