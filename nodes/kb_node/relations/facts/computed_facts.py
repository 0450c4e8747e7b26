"""Where things are, as triples: what their poses tell, and what these deny of what is asserted."""

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
"""Facts that are worth being turned into triples together."""
Known = Callable[[str], Entity | None]
"""The entity of a name."""


class Step(NamedTuple):
    """What a change of the map does: computed facts come and go, asserted ones are denied or no longer."""

    come: Collection[Triple]
    gone: Collection[Triple]
    denied: set[Triple]
    undenied: set[Triple]


class ComputedFacts:
    """Follows poses and what is said of places. Of properties that the TBox does not have nothing is told."""

    def __init__(self, properties: Set[Term], limits: Thresholds | None = None) -> None:
        """`properties` are those that the TBox has."""
        self._properties: Final = {COMPUTED[p]: p for p in properties if p in COMPUTED}
        self.facts = Facts(limits)
        self._said: dict[str, dict[Triple, None]] = {}
        """By the names that a triple is about."""
        self.denied: set[Triple] = set()
        self._was_flat = True
        """Of a plan geometry denies less."""

    @property
    def is_idle(self) -> bool:
        """Whether the TBox has no property that could be computed."""
        return not self._properties

    def placed(self) -> None:
        """All solids are where they are, though not all facts have been worked out."""
        self._was_flat = self.facts.space.is_flat

    def of(self, names: Iterable[str], known: Known) -> set[Triple]:
        """The triples about some names as subjects."""
        facts = self.facts
        return set(self._triples([(name, *about) for name in names for about in facts.of(name)], known))

    def begin(self, known: Known, said: Iterable[Triple]) -> Step:
        """All facts are new, and so is all that is said of places."""
        self._was_flat = self.facts.space.is_flat
        denied = {t for t in self._take_up((), _of_places(said)) if self._is_so_no_more(t, known)}
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
        """Entities are otherwise now or went, and triples are no longer asserted or are now.

        `before` knows the entities as they were.
        """
        now = {entity.name: entity for entity in changed}
        reborn: list[str] = []
        moved: list[Entity] = []
        for entity in now.values():
            was = before(entity.name)
            if was is None or not _stays(was, entity):
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
        retracted, inserted = _of_places(retracted), _of_places(inserted)
        if still := [triple for triple in retracted if self._still_holds(triple, as_it_is)]:
            came = {*came, *still}
        if went:
            came, went = set(came) - set(went), set(went) - set(came)
        touched = {*removed, *now, *shifted}
        newly, no_longer = self._judge(touched, gone | come, retracted, inserted, as_it_is)
        return Step(came, went, newly, no_longer)

    def _triples(self, facts: Collection[Fact], known: Known) -> Collection[Triple]:
        """Those about entities, by properties that the TBox has. Each fact is there once."""
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
        """Whether what is no longer asserted is computed."""
        s, p, o = triple
        relation = COMPUTED.get(p)
        if relation not in self._properties:
            return False
        fact = (v.entity_name(s), relation, v.entity_name(o))
        return self.facts.holds(fact) and _are((known(fact[0]), known(fact[2])), (s, o))

    def _judge(
        self,
        touched: Set[str],
        facts: Set[Fact],
        retracted: Iterable[Triple],
        inserted: Iterable[Triple],
        known: Known,
    ) -> tuple[set[Triple], set[Triple]]:
        """What is newly denied of what is asserted, and what no longer is."""
        looked_at = self._take_up(retracted, inserted)
        if self._was_flat != self.facts.space.is_flat:
            self._was_flat = not self._was_flat
            looked_at.update(triple for said in self._said.values() for triple in said)
        elif self._said:
            for name in self.facts.with_contents({*touched, *(fact[0] for fact in facts)}):
                looked_at.update(self._said.get(name, ()))
        if not looked_at:
            return set(), set()
        denied = {triple for triple in looked_at if self._is_so_no_more(triple, known)}
        newly, no_longer = denied - self.denied, (looked_at & self.denied) - denied
        self.denied |= newly
        self.denied -= no_longer
        return newly, no_longer

    def _take_up(self, retracted: Iterable[Triple], inserted: Iterable[Triple]) -> set[Triple]:
        """Remember what is said of places, and forget what is not any more; all of that."""
        concerned: set[Triple] = set()
        for triple in retracted:
            concerned.add(triple)
            for name in _names(triple):
                said = self._said.get(name, {})
                said.pop(triple, None)
                if not said:
                    self._said.pop(name, None)
        for triple in inserted:
            concerned.add(triple)
            for name in _names(triple):
                self._said.setdefault(name, {})[triple] = None
        return concerned

    def _is_so_no_more(self, triple: Triple, known: Known) -> bool:
        """Whether it is asserted of two entities, and geometry denies it."""
        fact = fact_of(triple)
        if fact is None or triple not in self._said.get(fact[0], ()):
            return False
        ends = (triple[0], triple[2]) if fact[0] == v.entity_name(triple[0]) else (triple[2], triple[0])
        if not _are((known(fact[0]), known(fact[2])), ends):
            return False
        return find_contradiction(self.facts.space, fact) is not None


def _of_places(triples: Iterable[Triple]) -> list[Triple]:
    return [triple for triple in triples if triple[1] in PROPERTIES and fact_of(triple) is not None]


def _are(entities: tuple[Entity | None, Entity | None], iris: tuple[Term, Term]) -> bool:
    """Whether two entities are those with these IRIs."""
    return all(e is not None and v.iri(e.iri) == iri for e, iri in zip(entities, iris, strict=True))


def _names(triple: Triple) -> tuple[str, str]:
    return v.entity_name(triple[0]), v.entity_name(triple[2])


def _stays(was: Entity, now: Entity) -> bool:
    """Whether nothing that relations depend on is otherwise: a reference changed, or a property."""
    return was.pose == now.pose and PlacedEntity.of(was) == PlacedEntity.of(now)
