"""Since when a computed relation holds: read off the history of poses, so that a restart changes nothing.

One pass through the journal. Relations are measured again only at commits that change something near the
thing that they are about.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from itertools import groupby
from typing import NamedTuple

from msgspec import Struct

from semmap.nodes.kb_node.relations.facts.place_facts import Fact
from semmap.nodes.kb_node.relations.facts.rules import RULES
from semmap.nodes.kb_node.relations.geometry.opening import positions_of
from semmap.nodes.kb_node.relations.geometry.placed import Placed
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring import measures
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.storage.history import Past
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.ontology.model_shapes import own_size_m
from semmap.schemas.attachments import IS_GRASPED_BY
from semmap.schemas.entities import Entity, Pose, Size, Stated
from semmap.schemas.polygons import EXTENT

_MARGIN_M = 1.5
"""Beyond what can touch the thing: so all of the cells of the spatial index that it is in are complete."""


class _Stood(Struct, frozen=True):
    """An entity as far as relations need it."""

    name: str
    iri: str
    pose: Pose | None = None
    size_m: Size | None = None
    place: bool = False
    model: str = ""
    properties: dict[str, Stated] = {}

    @property
    def placed(self) -> Placed:
        stated = self.properties.get(EXTENT) if self.place else None
        held_by = self.properties.get(IS_GRASPED_BY)
        return Placed(
            name=self.name,
            iri=self.iri,
            pose=self.pose,
            size_m=self.size_m,
            place=self.place,
            model=self.model,
            extent=stated if isinstance(stated, str) else "",
            held_by=held_by if isinstance(held_by, str) else "",
            joints=positions_of(self.model, self.size_m or own_size_m(self.model), self.properties),
        )


class _Left(Struct, frozen=True):
    name: str


class Moves(Struct, frozen=True):
    """The part of a commit that tells who is where after it."""

    seq: int
    changed: tuple[_Stood, ...] = ()
    removed: tuple[_Left, ...] = ()


class Beginnings(NamedTuple):
    """Since when facts have held without a break, as far as the journal goes back."""

    since: Mapping[Fact, int]
    """By commit; 0 is before the first one that the journal has."""
    first: int = 1

    def spoken(self, facts: Collection[Fact]) -> str | None:
        """Since when all of these have held at once: "since commit 7". None where one is not known."""
        if not facts or not self.since.keys() >= set(facts):
            return None
        latest = max(self.since[fact] for fact in facts)
        return f"since commit {latest}" if latest else f"since before commit {self.first}"


def looked_up(journal: Journal, past: Past, facts: Collection[Fact], limits: Thresholds) -> Beginnings:
    """Since when each fact has held without a break."""
    found = beginnings(journal.outlines(Moves), past.at_the_beginning().values(), facts, limits)
    return Beginnings(found, journal.first)


def beginnings(
    history: Iterable[Moves], first: Iterable[Entity], facts: Collection[Fact], limits: Thresholds
) -> dict[Fact, int]:
    """The commit since which each fact has held without a break; what does not hold at the end is left out.

    Commits and thresholds are as for `spells`.
    """
    found = spells(history, first, facts, limits)
    return {fact: spans[-1][0] for fact, spans in found.items() if spans and spans[-1][1] is None}


def spells(
    history: Iterable[Moves],
    first: Iterable[Entity],
    facts: Collection[Fact],
    limits: Thresholds,
    *,
    in_any_place: bool = False,
) -> dict[Fact, list[tuple[int, int | None]]]:
    """From which commit until before which each fact held, in order; None for what holds at the end.

    `history` are the commits in order, `first` the entities before them; what held before the first of
    them begins with 0. All is measured with the thresholds given. A thing is located in the smallest place
    that it is in; with `in_any_place` also in all that this is a part of,
    and a place in those that it is within.
    """
    there = {entity.name: Placed.of(entity) for entity in first}
    by_name = groupby(sorted(facts), key=lambda fact: fact[0])
    spots = [_Spot(name, frozenset(about), limits, there, in_any_place) for name, about in by_name]
    found: dict[Fact, list[tuple[int, int | None]]] = {fact: [] for fact in facts}
    since = {fact: 0 for spot in spots for fact in spot.holding()}
    for moves in history:
        before = {name: there.get(name) for name in _names(moves)}
        for left in moves.removed:
            there.pop(left.name, None)
        there.update((stood.name, stood.placed) for stood in moves.changed)
        shifted = {name: (was, there.get(name)) for name, was in before.items() if was != there.get(name)}
        for spot in spots:
            if spot.follow(shifted, there):
                holding = spot.holding()
                for fact in spot.facts:
                    if fact in holding:
                        since.setdefault(fact, moves.seq)
                    elif fact in since:
                        found[fact].append((since.pop(fact), moves.seq))
    for fact, seq in since.items():
        found[fact].append((seq, None))
    return found


def _names(moves: Moves) -> list[str]:
    return [*(stood.name for stood in moves.changed), *(left.name for left in moves.removed)]


class _Spot:
    """A thing and what is near it."""

    def __init__(
        self,
        name: str,
        facts: frozenset[Fact],
        limits: Thresholds,
        there: dict[str, Placed],
        in_any_place: bool,
    ) -> None:
        """`facts` are about the thing; `there` is everybody, as they are at first."""
        self._in_any_place = in_any_place
        self.facts = facts
        self._name = name
        self._limits = limits
        self._begin(there)

    def _begin(self, there: dict[str, Placed]) -> None:
        self._own = there.get(self._name)
        near = [placed for placed in there.values() if self._is_near(placed)]
        self._space = Space(near, self._limits)

    def follow(
        self, shifted: dict[str, tuple[Placed | None, Placed | None]], there: dict[str, Placed]
    ) -> bool:
        """Take over who is somewhere else now; whether that matters here."""
        if self._name in shifted:
            self._begin(there)
            return True
        matters = False
        for name, (was, now) in shifted.items():
            if self._is_near(was) or self._is_near(now):
                matters = True
                if now is None:
                    self._space.take(name)
                else:
                    self._space.put(now)
        return matters

    def holding(self) -> frozenset[Fact]:
        """Which of the facts hold."""
        solid = self._space.solids.get(self._name)
        if solid is None:
            return frozenset()
        found: set[Fact] = set()
        if not solid.is_place:
            found = {(self._name, *about) for rule in RULES for about in rule.facts(self._space, solid)}
        if self._in_any_place:
            found.update(fact for fact in self.facts if self._is_within(solid, fact))
        return self.facts & found

    def _is_within(self, solid: Solid, fact: Fact) -> bool:
        """Whether the fact says that the thing is in a place, and it is."""
        _, relation, other = fact
        place = self._space.solids.get(other) if relation == "isLocatedIn" else None
        if place is None or not place.is_place or place is solid:
            return False
        made = measures.within(solid, place, self._space.limits, also_places=True)
        return made is not None and made.holds

    def _is_near(self, placed: Placed | None) -> bool:
        own = self._own
        if placed is None or placed.pose is None or own is None or own.pose is None:
            return False
        apart = math.dist(placed.pose.position_m[:2], own.pose.position_m[:2])
        return apart <= _reach(placed) + _reach(own) + _MARGIN_M


def _reach(placed: Placed) -> float:
    """How far from its position a thing may extend, however it is turned [m]."""
    size = placed.size_m or own_size_m(placed.model)
    return 0.0 if size is None else math.hypot(*size)
