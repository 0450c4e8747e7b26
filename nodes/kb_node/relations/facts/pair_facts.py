"""Relations between neighbouring objects, measured only on request.

There are too many to store all of them at each commit: fifty objects in a room are near most of the others.
In a crowd only counted objects are compared (`measuring.crowds`), so that the work is bounded.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Set
from typing import Final

from semmap.nodes.kb_node.relations.facts.place_facts import Changed, Fact
from semmap.nodes.kb_node.relations.geometry.forms import Bounds
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring import measures, proximity
from semmap.nodes.kb_node.relations.measuring.arrangement import stands_on_ground
from semmap.nodes.kb_node.relations.measuring.measures import Measure
from semmap.nodes.kb_node.relations.measuring.relation_table import (
    MIRRORED,
    ONE_WAY,
    PAIR_RELATIONS,
)
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.schemas.entities import Entity
from semmap.schemas.relations import RelationName

_ALL: Final = frozenset(PAIR_RELATIONS)
_OF_THREE: Final[frozenset[RelationName]] = frozenset(("isNextTo", "isLeaningAgainst"))
"""The relations of a pair that a third object can end, if it is between the two."""
_SupportState = tuple[Solid | None, frozenset[Solid], bool]
"""What an object is inside, what it is on, and whether it stands on the ground."""


def measure_pair(
    space: Space, solid: Solid, other: Solid, wanted: Set[RelationName] = _ALL
) -> Iterator[tuple[RelationName, Measure]]:
    """Yield the measured relations of the first object to the second.

    Of an object and what it is on or inside, only `touches` is measured, unless the object is the larger one:
    a board on a post is above it.
    """
    names: Iterable[RelationName] = PAIR_RELATIONS if is_separate(space, solid, other) else ("touches",)
    for name in names:
        made = PAIR_RELATIONS[name].measure(space, solid, other) if name in wanted else None
        if made is not None:
            yield name, made


def is_separate(space: Space, one: Solid, other: Solid) -> bool:
    """Return whether neither of two objects is on or inside the other, or only the larger one is."""
    smaller, larger = (one, other) if one.footprint < other.footprint else (other, one)
    if smaller.footprint == larger.footprint and _is_on_or_in(space, larger, smaller):
        return False
    return not _is_on_or_in(space, smaller, larger)


def _is_on_or_in(space: Space, solid: Solid, other: Solid) -> bool:
    return other in space.spatial_relations(solid).supporters


def are_near(space: Space, one: Solid, other: Solid) -> bool:
    """Return whether `isNear` is a fact, with the same meaning as in `list --near` and SPARQL."""
    made = proximity.near(one, other, space.limits)
    if made is None or not made.holds or not (space.counts(one) and space.counts(other)):
        return False
    return is_separate(space, one, other)


class PairFacts:
    """The requested facts of pairs, updated with the map.

    A fact with an inverse is reported once for a pair, with the alphabetically first name as its subject.
    """

    def __init__(self, space: Space) -> None:
        """`space` must not be changed by anything else."""
        self.space = space
        space.pop_shifted()
        self._whole: frozenset[RelationName] = frozenset()
        self._some: frozenset[str] = frozenset()
        self._pairs: dict[str, dict[str, tuple[Fact, ...]]] = {}
        """By both names, in either order."""
        self._support_states: dict[str, _SupportState] = {}

    def set_scope(self, whole: Iterable[RelationName], some: Iterable[str]) -> Changed:
        """Keep the relations `whole` of all objects, and all relations of the objects `some`, from now on."""
        whole, some = frozenset(whole), frozenset(some)
        whole |= {MIRRORED[relation] for relation in whole if relation in MIRRORED}
        more, others = whole - self._whole, some - self._some
        is_less = not (whole >= self._whole and some >= self._some)
        self._whole, self._some = whole, some
        if not (whole or some):
            self._support_states.clear()
        gone, come = self._compute(others)
        if is_less:
            for name, there in list(self._pairs.items()):
                for other, known in list(there.items()):
                    if name < other and not (name in some or other in some):
                        now = tuple(fact for fact in known if fact[1] in whole)
                        self._replace((name, other), now, gone, come)
        if more:
            come |= self._compute(self.space.solids, more=more).come
        return Changed(gone, come)

    def holds(self, name: str, relation: RelationName, other: str) -> bool:
        """Return whether a fact holds for a pair, in either order."""
        return _orient((name, relation, other)) in self._pairs.get(name, {}).get(other, ())

    def update(self, changed: Iterable[Entity | PlacedEntity], removed: Iterable[str] = ()) -> Changed:
        """Apply added, changed and removed entities."""
        space, moved = self.space, list[Solid]()
        if not self._support_states and (self._whole or self._some):
            with space.caching():
                self._support_states = {
                    n: self._get_support_state(s) for n, s in space.solids.items() if self._is_included(s)
                }
        names: dict[str, None] = {}
        for name in removed:
            names[name] = None
            moved += filter(None, (space.solids.get(name),))
            space.remove(name)
        for entity in changed:
            names[entity.name] = None
            moved += filter(None, (space.solids.get(entity.name),))
            moved += filter(None, (space.put(entity),))
        shifted = space.pop_shifted()
        names.update((solid.name, None) for solid in shifted)
        moved += shifted
        if not (self._whole or self._some):
            return Changed(set(), set())
        with space.caching():
            for solid in moved:
                for other in space.counted_around(solid):
                    if self._is_included(other) and self._support_states.get(
                        other.name
                    ) != self._get_support_state(other):
                        names[other.name] = None
            for name in names:
                now = space.solids.get(name)
                if now is None or not self._is_included(now):
                    self._support_states.pop(name, None)
                else:
                    self._support_states[name] = self._get_support_state(now)
        return self._compute(names, moved)

    def _is_included(self, solid: Solid) -> bool:
        """Return whether an object is in any pair."""
        return not solid.is_place and self.space.counts(solid)

    def _get_support_state(self, solid: Solid) -> _SupportState:
        container, supports, _ = self.space.spatial_relations(solid)
        on_ground = stands_on_ground(self.space, solid)
        return container and container[0], frozenset(support for support, _ in supports), on_ground

    def _compute(
        self, names: Iterable[str], moved: Iterable[Solid] = (), more: Set[RelationName] = frozenset()
    ) -> Changed:
        """Compute all pairs of these objects, and the pairs that moved objects were or are between.

        With `more`, only these relations are measured, and known ones are kept.
        """
        gone, come = set[Fact](), set[Fact]()
        done = set[tuple[str, str]]()
        space = self.space
        with space.caching():
            for name in tuple(names):
                solid = space.solids.get(name)
                others = dict.fromkeys(self._pairs.get(name, ()))
                if solid is not None and self._is_included(solid):
                    for near in space.counted_around(solid, space.limits.near_most_m):
                        if self._is_included(near):
                            others[near.name] = None
                for other in others:
                    pair = (name, other) if name < other else (other, name)
                    if pair not in done:
                        done.add(pair)
                        now = self._measure(*pair, more)
                        if more:
                            known = self._pairs.get(pair[0], {}).get(pair[1], ())
                            now = tuple(dict.fromkeys((*known, *now)))
                        self._replace(pair, now, gone, come)
            for pair in self._pairs_across(moved):
                if pair not in done:
                    done.add(pair)
                    self._replace(pair, self._measure(*pair), gone, come)
        return Changed(gone, come)

    def _pairs_across(self, moved: Iterable[Solid]) -> Iterator[tuple[str, str]]:
        """Yield the pairs that these solids may be or have been between."""
        space = self.space
        if self._whole.isdisjoint(_OF_THREE) and not self._some:
            return
        for solid in moved:
            if solid.is_place:
                continue
            around = space.counted_around(solid, space.limits.near_most_m)
            ends = [end for end in around if self._is_included(end)]
            for at, one in enumerate(ends):
                for other in ends[at + 1 :]:
                    if not _may_be_beside(space, one, other):
                        continue
                    if measures.overlap(solid.bounds, _unite(one.bounds, other.bounds)):
                        yield (one.name, other.name) if one.name < other.name else (other.name, one.name)

    def _measure(self, name: str, other_name: str, more: Set[RelationName] = frozenset()) -> tuple[Fact, ...]:
        solid, other = self.space.solids.get(name), self.space.solids.get(other_name)
        if solid is None or other is None or not _may_be_beside(self.space, solid, other):
            return ()
        if not (self._is_included(solid) and self._is_included(other)):
            return ()
        wanted = _ALL if name in self._some or other_name in self._some else more or self._whole
        if not wanted:
            return ()
        found = list(self._list_facts(solid, other, wanted))
        if reverse := wanted & ONE_WAY:
            found += self._list_facts(other, solid, reverse)
        return tuple(found)

    def _list_facts(self, one: Solid, two: Solid, wanted: Set[RelationName]) -> Iterator[Fact]:
        for relation, made in measure_pair(self.space, one, two, wanted):
            if made.holds:
                yield _orient((one.name, relation, two.name))

    def _replace(
        self,
        pair: tuple[str, str],
        now: tuple[Fact, ...],
        gone: set[Fact],
        come: set[Fact],
    ) -> None:
        name, other = pair
        before = self._pairs.get(name, {}).get(other, ())
        if now == before:
            return
        gone.update(fact for fact in before if fact not in now)
        come.update(fact for fact in now if fact not in before)
        for one, two in (pair, (other, name)):
            there = self._pairs.setdefault(one, {})
            if now:
                there[two] = now
            else:
                there.pop(two, None)
                if not there:
                    del self._pairs[one]


def _orient(fact: Fact) -> Fact:
    """Return a fact with the alphabetically first name as its subject, unless it has no inverse."""
    name, relation, other = fact
    return (other, MIRRORED[relation], name) if other < name and relation in MIRRORED else fact


def _may_be_beside(space: Space, one: Solid, other: Solid) -> bool:
    """Return whether two objects are close enough for any of the relations, by their bounds."""
    limits = space.limits
    reach = max(proximity.near_limit(one, other, limits), limits.contact_m, limits.lean_gap_m)
    return measures.overlap(one.bounds, other.bounds, reach)


def _unite(one: Bounds, other: Bounds) -> Bounds:
    return (
        min(one[0], other[0]), min(one[1], other[1]), max(one[2], other[2]), max(one[3], other[3]),
    )  # fmt: skip
