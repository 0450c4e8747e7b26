"""Entities and their locations, now and in the past: `list`, `get`, `relations` and `explain`."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from contextlib import suppress
from typing import Final, NamedTuple

from msgspec import structs

from semmap.nodes.kb_node.answers import answers, questions
from semmap.nodes.kb_node.answers.past.fact_intervals import FactStarts
from semmap.nodes.kb_node.entities.equal_individuals import about_entity
from semmap.nodes.kb_node.entities.individual_reading import find_own_classes
from semmap.nodes.kb_node.relations.facts.contradictions import (
    PROPERTIES,
    fact_of,
    find_contradiction,
    find_contradictions,
)
from semmap.nodes.kb_node.relations.facts.place_facts import Fact
from semmap.nodes.kb_node.relations.facts.rules import COMPUTED
from semmap.nodes.kb_node.relations.geometry.placed_entity import name_shape_source
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.relation_reports import explain_relation, list_locations, list_relations
from semmap.nodes.kb_node.relations.selection import find_single, resolve_single, select_entities
from semmap.nodes.kb_node.relations.support import describe_unsupported
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.bridge import Entities
from semmap.schemas.commands import Explain, Get, Relations
from semmap.schemas.entities import SAME_AS, Entity
from semmap.schemas.explanations import Explanation, Term, Triple
from semmap.schemas.moments import When
from semmap.schemas.relations import PHRASES, Described, Relation, RelationName

_MEASURED: Final[dict[Term, tuple[RelationName, bool]]] = {
    **{v.dm(name): (name, False) for name in PHRASES},
    **PROPERTIES,
}
"""The properties that `explain` measures. For inverse ones the object is the located entity."""


class Explained(NamedTuple):
    """An explanation; the times since which its measured facts hold are still to be added."""

    explanation: Explanation
    before: str = ""
    measured: tuple[tuple[Fact, str], ...] = ()

    def with_dates(self, look_up: Callable[[Collection[Fact]], FactStarts]) -> Explanation:
        """Return the explanation with the time since which its measured facts hold."""
        if not self.measured:
            return self.explanation
        facts = [fact for fact, _ in self.measured]
        began = look_up(facts)
        sentences = [
            f"{text} ({since})" if (since := began.describe([f])) else text for f, text in self.measured
        ]
        if len(facts) > 1 and (since := began.describe(facts)) is not None:
            sentences[-1] += f". It holds {since}"
        return structs.replace(self.explanation, text=self.before + "; ".join(sentences))


class CurrentState:
    """Queries about the current map. Owned by the node's thread."""

    def __init__(self, semantic_map: SemanticMap) -> None:
        self._map = semantic_map

    def entities(self, query: Entities) -> tuple[Entity, ...]:
        """Return the entities of a class, or those that match `where`. Raises UnknownClass, UnknownName.

        With `all`, individuals that are not in space follow.
        """
        if query.all:
            return self._with_individuals(query)
        found = self._find_entities(query.class_)
        if query.where is None:
            return found
        return tuple(
            select_entities(
                self._map.places.space(),
                found,
                query.where,
                self._map.entities(),
                self._map.derived_facts.suppressed_measurements,
            )
        )

    def _find_entities(self, class_name: str | None) -> tuple[Entity, ...]:
        """Return the entities of a class of the TBox, or of one that only the map declares."""
        try:
            return answers.find_entities(self._map, class_name)
        except errors.UnknownClass:
            declared = (s for s, _, _ in self._map.reasoner.asserted(None, v.RDF_TYPE, v.OWL_CLASS))
            own = [c for c in declared if class_name in (v.local_name(c), v.bare(c))]
            if not own:
                raise
            found = (
                self._map.find_by_individual(one) for c in own for one in self._map.reasoner.instances(c)
            )
            by_name = {entity.name: entity for entity in found if entity is not None}
            return tuple(by_name[name] for name in sorted(by_name))

    def _with_individuals(self, query: Entities) -> tuple[Entity, ...]:
        """Return the entities of a class (or all), then the individuals of that class not in space."""
        individuals, entities = self._map.individuals.list(), tuple[Entity, ...]()
        if query.class_ is not None:
            individuals = tuple(one for one in individuals if query.class_ in one.types)
        try:
            entities = self._find_entities(query.class_)
        except errors.UnknownClass:  # it may be a class that only the map uses
            if not individuals:
                raise
        return (*entities, *individuals)

    def entity(self, query: Get) -> Described:
        """Return one entity, with its location and wrong assertions about it if `where`.

        Its properties and types include those that the TBox does not declare, and the equal individuals. An
        individual that is not in space is returned with what refers to it. Raises UnknownName; BadRequest for
        an ambiguous word.
        """
        entity = self._resolve(query.name)
        if not entity.in_space:
            referring = self._map.individuals.find_referring(entity)
            return structs.replace(Described.of(entity), referred_by=referring)
        if not query.where:
            return self._with_all_properties(Described.of(entity))
        found = self._with_all_properties(self._with_where(entity))
        return structs.replace(found, on_nothing=_on_nothing(self._map.places.space(), entity))

    def _resolve(self, word: str) -> Entity:
        """Return the entity or individual of this name or IRI, or else the only one of this label or class.

        Labels and classes of entities precede those of individuals that are not in space.
        """
        for find in (self._map.described, self._map.resolve):
            with suppress(errors.UnknownName):
                return find(word)
        everyone = (*self._map.entities(), *self._map.individuals.list())
        return self._map.described(resolve_single(everyone, word))

    def _with_all_properties(self, found: Described) -> Described:
        iri = v.iri(found.iri)
        about = about_entity(self._map.reasoner, iri)
        table = self._map.classes.property_table
        others = {**table.read_nameless(about, iri), **table.read_others(about, iri)}
        others.pop(SAME_AS, None)
        own = find_own_classes(self._map.classes, about(iri).get(v.RDF_TYPE, ()))
        if not others and not own:
            return found
        types = (*found.types, *own)
        return structs.replace(found, types=types, properties={**found.properties, **others})

    def describe(self, name: str) -> Described | None:
        """Return the entity of that name with its location, or None."""
        entity = self._map.find(name)
        return None if entity is None else self._with_where(entity)

    def _with_where(self, entity: Entity) -> Described:
        space = self._map.places.space()
        wrong = find_contradictions(space, answers.asserted_locations(self._map, entity))
        left_out = self._map.derived_facts.suppressed_measurements
        locations = (r for r in list_locations(space, entity.name) if _fact(r) not in left_out)
        withheld = tuple(answers.suppressed_facts(self._map, entity))
        return Described.of(entity, tuple(locations), tuple(wrong), withheld, shape=name_shape_source(entity))

    def find_denied(self) -> tuple[Relation, ...]:
        """Return the asserted locations that contradict the geometry."""
        space = self._map.places.space()
        return tuple(
            find_contradictions(space, filter(None, map(fact_of, sorted(self._map.reasoner.suppressed()))))
        )

    def relations(self, query: Relations) -> tuple[Relation, ...]:
        """Return the relations of an entity. Raises UnknownName; BadRequest for an ambiguous word."""
        named = _named(query, self._map.find, lambda: tuple(self._map.entities()))
        left_out = self._map.derived_facts.suppressed_measurements
        is_fixed = self._map.entity(named.name).fixed
        found = list_relations(self._map.places.space(), named, is_fixed=is_fixed)
        return tuple(_mark_suppressed(r) if left_out and _fact(r) in left_out else r for r in found)

    def explain_measured(self, query: Explain) -> Explanation | None:
        """Return the measurement of a relation without a property in the TBox, or None.

        Raises Refused if it does not hold, UnknownName; BadRequest for an ambiguous word.
        """
        relation = next((name for name in PHRASES if name == query.predicate), None)
        if relation is None or self._map.classes.property_names.find(relation) is not None:
            return None
        if query.negated:
            raise errors.BadRequest(f"the TBox has no property '{relation}', so nothing can exclude it")
        space = self._map.places.space()
        ends = [self._map.resolve(word).name for word in (query.name, query.value)]
        for name in ends:
            if name not in space.solids:
                raise errors.Refused(f"{name} has no position, so it has no spatial relations")
        measured = explain_relation(space, ends[0], relation, ends[1])
        if measured is None:
            raise errors.InternalError(f"the relation '{relation}' is not computed")
        if not measured.holds:
            raise errors.Refused(measured.text)
        return Explanation(conclusion=None, support=(), steps=(), text=measured.text)

    def explain(self, query: Explain, asked: questions.StatementQuestion) -> Explained | None:
        """Return why something holds, with measurements if they are a reason, or None if it is not known yet.

        Raises Refused if a measurement denies it.
        """
        measured = self._measure(asked.triples[0])
        found = questions.why(self._map.reasoner, asked)
        if query.negated:
            if measured is None or measured.holds or found is not None:
                return None
            return Explained(Explanation(conclusion=None, support=(), steps=(), text=measured.text))
        if found is None:
            if (
                withheld := next((t for t in asked.triples if t in self._map.derived_facts.suppressed), None)
            ) is not None:
                raise errors.Refused(f"it does not hold: {self._map.derived_facts.describe(withheld)}")
            if measured is not None and not measured.holds:
                is_said = (
                    self._map.is_asserted(asked.triples[0])
                    and self.describe_conflict(asked.triples[0]) is not None
                )
                note = "; it is asserted, but suppressed while the geometry contradicts it"
                raise errors.Refused(measured.text + (note if is_said else ""))
            return None if measured is None else Explained(self._explain_relation(measured))
        if found.conclusion is not None and self._map.reasoner.is_computed(found.conclusion):
            return Explained(found, measured=(self._describe_fact(found.conclusion),))
        if measured is not None and not measured.holds:
            # An object on another touches it across a small gap, and the locations of places are asserted.
            measured = (
                None if measured.relation == "touches" or self._is_place(measured.subject) else measured
            )
        if measured is not None:
            if not measured.holds:
                text = f"{found.text.rstrip('.')}; but according to the poses, {measured.text}"
                return Explained(structs.replace(found, text=text))
            return Explained(found, f"{found.text.rstrip('.')}; and ", ((_fact(measured), measured.text),))
        sentences = tuple(
            self._describe_fact(fact) for fact in found.support if self._map.reasoner.is_computed(fact)
        )
        return (
            Explained(found, f"{found.text.rstrip('.')}; measured: ", sentences)
            if sentences
            else Explained(found)
        )

    def describe_conflict(self, triple: Triple) -> str | None:
        """Return how the geometry contradicts an asserted location, as a clause, or None."""
        if (fact := fact_of(triple)) is None:
            return None
        found = find_contradiction(self._map.places.space(), fact)
        return None if found is None else found.text.partition("; ")[2]

    def _measure(self, triple: Triple) -> Relation | None:
        """Measure a relation between two entities, or its inverse. Return None for any other triple."""
        s, p, o = triple
        if p not in _MEASURED or o.startswith('"'):
            return None
        relation, is_inverse = _MEASURED[p]
        ends: list[str] = []
        for iri in (s, o):
            if (entity := self._map.find_by_individual(iri)) is None:
                return None
            ends.append(entity.name)
        if is_inverse:
            ends.reverse()
        return explain_relation(self._map.places.space(), ends[0], relation, ends[1])

    def _is_place(self, name: str) -> bool:
        return self._map.entity(name).place

    def _explain_relation(self, measured: Relation) -> Explanation:
        subject, object_ = (v.iri(self._map.entity(name).iri) for name in (measured.subject, measured.object))
        fact = (subject, v.dm(measured.relation), object_)
        return Explanation(conclusion=fact, support=(), steps=(), text=measured.text, computed=(fact,))

    def _describe_fact(self, fact: Triple) -> tuple[Fact, str]:
        """Return a computed fact with its measurement."""
        relation = COMPUTED[fact[1]]
        name, other = v.entity_name(fact[0]), v.entity_name(fact[2])
        measured = explain_relation(self._map.places.space(), name, relation, other)
        return (name, relation, other), v.to_words(fact) if measured is None else measured.text


class PastState:
    """Queries about the map as of `query.as_of`, read from the journal. For any thread."""

    def __init__(self, semantic_map: SemanticMap, past: HistoryReader) -> None:
        self._map = semantic_map
        self._past = past

    def entities(self, query: Entities) -> tuple[Entity, ...]:
        """Return the entities; see `CurrentState.entities`."""
        if query.as_of is None:
            raise errors.InternalError("the query has no time")
        found = self._past.entities(query.as_of, query.class_, tuple(self._map.classes.iris))
        if query.where is None:
            return found
        everyone = self._past.entities(query.as_of, None, ())
        return tuple(select_entities(self._space(everyone), found, query.where, everyone))

    def entity(self, query: Get) -> Described:
        """Return one entity; see `CurrentState.entity`. Wrong assertions are not reported."""
        if query.as_of is None:
            raise errors.InternalError("the query has no time")
        entity = self._entity(query.name, query.as_of)
        if not query.where:
            return Described.of(entity)
        space = self._space(self._past.entities(query.as_of, None, ()))
        locations = tuple(list_locations(space, entity.name))
        on_nothing = _on_nothing(space, entity)
        return Described.of(entity, locations, on_nothing=on_nothing, shape=name_shape_source(entity))

    def relations(self, query: Relations) -> tuple[Relation, ...]:
        """Return the relations; see `CurrentState.relations`."""
        if query.as_of is None:
            raise errors.InternalError("the query has no time")
        everyone = self._past.entities(query.as_of, None, ())
        entities = {entity.name: entity for entity in everyone}
        named = _named(query, entities.get, lambda: everyone)
        is_fixed = named.name in entities and entities[named.name].fixed
        return tuple(list_relations(self._space(everyone), named, is_fixed=is_fixed))

    def _entity(self, word: str, when: When) -> Entity:
        try:
            return self._past.entity(word, when)
        except errors.UnknownName:
            name = find_single(self._past.entities(when, None, ()), word)
            if name is None:
                raise
        return self._past.entity(name, when)

    def _space(self, entities: Iterable[Entity]) -> Space:
        return Space(entities, self._map.classes.limits)


def _fact(relation: Relation) -> Fact:
    return (relation.subject, relation.relation, relation.object)


def _on_nothing(space: Space, entity: Entity) -> str:
    """Return at which height an unsupported object hovers, or "" if it is supported or needs no support."""
    solid = None if entity.fixed else space.solids.get(entity.name)
    found = None if solid is None else describe_unsupported(space, solid)
    return "" if found is None else found.text


def _mark_suppressed(relation: Relation) -> Relation:
    """Return a measured relation with the note that it is suppressed."""
    note = "but this is suppressed, because it would contradict the map (for the reason see: semmap check)"
    return structs.replace(relation, text=f"{relation.text}; {note}")


def _named(
    query: Relations, find: Callable[[str], Entity | None], everyone: Callable[[], Sequence[Entity]]
) -> Relations:
    """Return the query with entity names for its words: a name, a label or a class."""
    names = {
        field: resolve_single(everyone(), word)
        for field in ("name", "other", "viewer")
        if (word := getattr(query, field)) is not None and find(word) is None
    }
    return structs.replace(query, **names) if names else query
