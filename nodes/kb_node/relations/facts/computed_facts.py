"""Computed facts as triples, and asserted facts that contradict the geometry."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Set
from typing import Final, NamedTuple

from semmap.nodes.kb_node.relations.facts.contradictions import PROPERTIES, fact_of, find_contradiction
from semmap.nodes.kb_node.relations.facts.place_facts import Fact, Facts
from semmap.nodes.kb_node.relations.facts.rules import COMPUTED
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.ontology import vocabulary as v
from semmap.schemas.entities import Entity
from semmap.schemas.explanations import Term, Triple

_MANY: Final = 32
"""From this number on, facts are converted to triples together."""
Known = Callable[[str], Entity | None]
"""A function that returns the entity with a name."""


class Step(NamedTuple):
    """The effect of a change: computed triples that come and go, asserted ones newly or no longer denied."""

    come: Collection[Triple]
    gone: Collection[Triple]
    denied: set[Triple]
    undenied: set[Triple]


class ComputedFacts:
    """Computed triples, updated with poses and asserted locations.

    Only properties that the TBox declares are used.
    """

    def __init__(self, properties: Set[Term], limits: Thresholds | None = None) -> None:
        """`properties` are those of the TBox."""
        self._properties: Final = {COMPUTED[p]: p for p in properties if p in COMPUTED}
        self.facts = Facts(limits)
        self._asserted: dict[str, dict[Triple, None]] = {}
        """Asserted location triples by the names in them."""
        self.denied: set[Triple] = set()
        self._was_flat = True
        """On a flat map geometry denies less."""

    @property
    def is_idle(self) -> bool:
        """Return whether the TBox has no property that could be computed."""
        return not self._properties

    def placed(self) -> None:
        """Record that all solids are in place, although not all facts have been computed."""
        self._was_flat = self.facts.space.is_flat

    def of(self, names: Iterable[str], known: Known) -> set[Triple]:
        """Return the triples with these names as subjects."""
        facts = self.facts
        return set(self._triples([(name, *about) for name in names for about in facts.of(name)], known))

    def begin(self, known: Known, asserted: Iterable[Triple]) -> Step:
        """Return the step from an empty map to all facts and asserted triples."""
        self._was_flat = self.facts.space.is_flat
        denied = {
            t for t in self._index_asserted((), _filter_locations(asserted)) if self._is_denied(t, known)
        }
        self.denied |= denied
        return Step(self._triples(list(self.facts), known), (), denied, set())

    def after(
        self,
        changed: Collection[Entity],
        removed: Collection[str],
        before: Known,
        retracted: Iterable[Triple],
        inserted: Iterable[Triple],
    ) -> Step:
        """Apply changed and removed entities, and retracted and inserted triples.

        `before` returns the entities as they were.
        """
        now = {entity.name: entity for entity in changed}
        reborn: list[str] = []
        moved: list[Entity] = []
        for entity in now.values():
            was = before(entity.name)
            if was is None or not _is_unchanged(was, entity):
                moved.append(entity)
            if was is not None and was.iri != entity.iri:
                reborn.append(entity.name)
        old = self.facts.update((), reborn) if reborn else None
        shifted = self.facts.shifted if reborn else frozenset()
        gone, come = self.facts.update(moved, removed)
        if old is not None:
            gone, come = gone | old.gone, come | old.come
        shifted |= self.facts.shifted

        left = frozenset(removed)

        def as_it_is(name: str) -> Entity | None:
            return now.get(name) or (None if name in left else before(name))

        went = self._triples(gone, before)
        came = self._triples(come, as_it_is)
        retracted, inserted = _filter_locations(retracted), _filter_locations(inserted)
        if still := [triple for triple in retracted if self._still_holds(triple, as_it_is)]:
            came = {*came, *still}
        if went:
            came, went = set(came) - set(went), set(went) - set(came)
        touched = {*removed, *now, *shifted}
        newly, no_longer = self._find_denied(touched, gone | come, retracted, inserted, as_it_is)
        return Step(came, went, newly, no_longer)

    def _triples(self, facts: Collection[Fact], known: Known) -> Collection[Triple]:
        """Return triples about entities with properties of the TBox. Facts must be distinct."""
        if len(facts) < _MANY:
            return [t for fact in facts if (t := self._triple(fact, known)) is not None]
        names, relations, others = zip(*facts, strict=True)
        found = {name: known(name) for name in {*names, *others}}
        terms = {name: v.iri(entity.iri) for name, entity in found.items() if entity is not None}
        properties = self._properties
        if len(terms) < len(found) or not properties.keys() >= set(relations):
            facts = [
                fact for fact in facts if fact[0] in terms and fact[1] in properties and fact[2] in terms
            ]
            return self._triples(facts, known)
        return list(
            zip(
                map(terms.__getitem__, names),
                map(properties.__getitem__, relations),
                map(terms.__getitem__, others),
                strict=True,
            )
        )

    def _triple(self, fact: Fact, known: Known) -> Triple | None:
        name, relation, other = fact
        entity, its, property_ = known(name), known(other), self._properties.get(relation)
        if entity is None or its is None or property_ is None:
            return None
        return v.iri(entity.iri), property_, v.iri(its.iri)

    def _still_holds(self, triple: Triple, known: Known) -> bool:
        """Return whether a retracted triple is still computed."""
        s, p, o = triple
        relation = COMPUTED.get(p)
        if relation not in self._properties:
            return False
        fact = (v.entity_name(s), relation, v.entity_name(o))
        return self.facts.holds(fact) and _match_iris((known(fact[0]), known(fact[2])), (s, o))

    def _find_denied(
        self,
        touched: Set[str],
        facts: Set[Fact],
        retracted: Iterable[Triple],
        inserted: Iterable[Triple],
        known: Known,
    ) -> tuple[set[Triple], set[Triple]]:
        """Return the asserted triples that are newly denied, and those that no longer are."""
        looked_at = self._index_asserted(retracted, inserted)
        if self._was_flat != self.facts.space.is_flat:
            self._was_flat = not self._was_flat
            looked_at.update(triple for asserted in self._asserted.values() for triple in asserted)
        elif self._asserted:
            for name in self.facts.with_contents({*touched, *(fact[0] for fact in facts)}):
                looked_at.update(self._asserted.get(name, ()))
        if not looked_at:
            return set(), set()
        denied = {triple for triple in looked_at if self._is_denied(triple, known)}
        newly, no_longer = denied - self.denied, (looked_at & self.denied) - denied
        self.denied |= newly
        self.denied -= no_longer
        return newly, no_longer

    def _index_asserted(self, retracted: Iterable[Triple], inserted: Iterable[Triple]) -> set[Triple]:
        """Update the index of asserted locations, and return the affected triples."""
        concerned: set[Triple] = set()
        for triple in retracted:
            concerned.add(triple)
            for name in _names(triple):
                asserted = self._asserted.get(name, {})
                asserted.pop(triple, None)
                if not asserted:
                    self._asserted.pop(name, None)
        for triple in inserted:
            concerned.add(triple)
            for name in _names(triple):
                self._asserted.setdefault(name, {})[triple] = None
        return concerned

    def _is_denied(self, triple: Triple, known: Known) -> bool:
        """Return whether a triple is asserted of two entities and denied by geometry."""
        fact = fact_of(triple)
        if fact is None or triple not in self._asserted.get(fact[0], ()):
            return False
        ends = (triple[0], triple[2]) if fact[0] == v.entity_name(triple[0]) else (triple[2], triple[0])
        if not _match_iris((known(fact[0]), known(fact[2])), ends):
            return False
        return find_contradiction(self.facts.space, fact) is not None


def _filter_locations(triples: Iterable[Triple]) -> list[Triple]:
    return [triple for triple in triples if triple[1] in PROPERTIES and fact_of(triple) is not None]


def _match_iris(entities: tuple[Entity | None, Entity | None], iris: tuple[Term, Term]) -> bool:
    """Return whether two entities have these IRIs."""
    return all(e is not None and v.iri(e.iri) == iri for e, iri in zip(entities, iris, strict=True))


def _names(triple: Triple) -> tuple[str, str]:
    return v.entity_name(triple[0]), v.entity_name(triple[2])


def _is_unchanged(was: Entity, now: Entity) -> bool:
    """Return whether nothing changed on which relations depend, only a label or a property."""
    return PlacedEntity.of(was) == PlacedEntity.of(now)
