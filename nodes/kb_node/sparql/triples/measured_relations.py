"""Relations that are measured because a query needs them, kept up to date commit by commit."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, NamedTuple

from semmap.nodes.kb_node.relations.facts.pair_facts import PairFacts
from semmap.nodes.kb_node.relations.facts.pair_properties import PairProperties
from semmap.nodes.kb_node.relations.facts.place_facts import Changed, Fact
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.relations.measuring.relation_table import PAIR_RELATIONS
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.sparql.protocol import Placements
from semmap.nodes.kb_node.sparql.triples.dataset import Dataset, Delta
from semmap.ontology import vocabulary as v
from semmap.ontology.model_shapes import add_shapes
from semmap.schemas.explanations import Term, Triple
from semmap.schemas.relations import RelationName

if TYPE_CHECKING:
    from semmap.nodes.kb_node.sparql.queries.footprint import Pattern


class Needs(NamedTuple):
    """Relations that are needed for all objects, and objects for which all relations are needed."""

    relations: frozenset[RelationName] = frozenset()
    names: frozenset[str] = frozenset()

    @classmethod
    def merge(cls, several: Iterable[Needs]) -> Needs:
        """Return needs that satisfy several."""
        several = tuple(several)
        return cls(
            frozenset[RelationName]().union(*(needs.relations for needs in several)),
            frozenset[str]().union(*(needs.names for needs in several)),
        )


def needs_of(patterns: frozenset[Pattern] | None, derived: PairProperties) -> Needs:
    """Return the needs of a query with these triple patterns, or everything if they are unknown.

    If one end of a pattern is a known individual, only that one is needed.
    """
    if patterns is None:
        return Needs(frozenset(PAIR_RELATIONS) if derived.sources else frozenset())
    relations, names = set[RelationName](), set[str]()
    for s, p, o in patterns:
        sources = frozenset(PAIR_RELATIONS) if p is None else derived.sources.get(p, frozenset())
        end = s if s is not None else o
        if sources and end is None:
            relations |= sources
        elif sources and end is not None and end.startswith("<"):
            names.add(v.entity_name(end))
    return Needs(frozenset(relations), frozenset(names))


class MeasuredRelations:
    """Tracks poses and measures the needed relations. It does not write into the dataset."""

    def __init__(self, derived: PairProperties, dataset: Dataset, placements: Placements) -> None:
        self._derived = derived
        self._dataset = dataset
        add_shapes(placements.shapes)
        self._pairs = PairFacts(Space(placements.placed, placements.limits))
        self._iris: dict[str, Term] = {}
        self._names: dict[Term, str] = {}
        self._register(placements.placed)

    def update_needs(self, needs: Needs) -> tuple[tuple[Triple, ...], tuple[Triple, ...]]:
        """Set the needs. Return the triples to remove from the dataset and those to add."""
        return self._differing(self._triples(self._pairs.set_scope(*needs), self._iris))

    def after(
        self, delta: Delta, placed: Iterable[PlacedEntity], removed: Iterable[str]
    ) -> tuple[tuple[Triple, ...], tuple[Triple, ...]]:
        """Do the same for a commit that the dataset has already, with changed and removed entities."""
        placed = tuple(placed)
        reborn = [e.name for e in placed if self._iris.get(e.name, v.iri(e.iri)) != v.iri(e.iri)]
        removed = (*removed, *reborn)
        removed_triples = self._pairs.update((), removed)
        candidates = self._triples(removed_triples, self._iris)
        for name in removed:
            if (iri := self._iris.pop(name, None)) is not None:
                del self._names[iri]
        self._register(placed)
        candidates |= self._triples(self._pairs.update(placed), self._iris)
        candidates.update(triple for triple in delta.everything if triple[1] in self._derived.sources)
        return self._differing(candidates)

    def _register(self, placed: Iterable[PlacedEntity]) -> None:
        for entity in placed:
            self._iris[entity.name] = v.iri(entity.iri)
            self._names[v.iri(entity.iri)] = entity.name
            v.give_name(v.iri(entity.iri), entity.name)

    def _triples(self, changed: Changed, iris: dict[str, Term]) -> set[Triple]:
        facts: set[Fact] = changed.gone | changed.come
        return {triple for fact in facts for triple in self._derived.triples(fact, iris)}

    def _differing(self, candidates: Iterable[Triple]) -> tuple[tuple[Triple, ...], tuple[Triple, ...]]:
        """Return those of the triples that the dataset has wrongly, and those that it lacks."""
        removed_triples, added_triples = list[Triple](), list[Triple]()
        dataset = self._dataset
        for triple in candidates:
            is_there = dataset.is_measured(triple)
            holds = self._derived.holds(triple, self._pairs, self._names)
            belongs = holds and not dataset.holds_unmeasured(triple)
            if is_there != belongs:
                (added_triples if belongs else removed_triples).append(triple)
        return tuple(removed_triples), tuple(added_triples)
