"""What descriptions need of a map: the present one, or one of the past."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence, Set
from typing import Protocol

from semmap.nodes.kb_node.entities.equal_individuals import about_entity
from semmap.nodes.kb_node.relations.facts.contradictions import fact_of, find_contradictions
from semmap.nodes.kb_node.relations.facts.place_facts import Fact
from semmap.nodes.kb_node.relations.facts.rules import RULES, About
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.ontology import vocabulary as v
from semmap.schemas.entities import Entity, Stated
from semmap.schemas.relations import Relation


class MapState(Protocol):
    """A map at a moment."""

    def entities(self) -> Collection[Entity]:
        """Return all entities."""

    def find(self, name: str) -> Entity | None:
        """Return the entity of that name, or None."""

    def space(self) -> Space:
        """Return the solids."""

    def about(self, name: str) -> Iterator[About]:
        """Yield what an object is inside, on, in and attached to, by importance. Nothing for a place."""

    def with_supported(self, names: Iterable[str]) -> Collection[str]:
        """Return these names and all that is on, inside or in them, or all names."""

    def left_out(self) -> Set[Fact]:
        """Return the measured facts that are suppressed."""

    def nameless(self, entity: Entity) -> Mapping[str, Stated]:
        """Return the values of properties with nameless ones among them, with their content."""


class PresentState:
    """The present map. Owned by the node's thread."""

    def __init__(self, semantic_map: SemanticMap) -> None:
        self._map = semantic_map

    def entities(self) -> Collection[Entity]:
        """Return all entities."""
        return tuple(self._map.entities())

    def find(self, name: str) -> Entity | None:
        """Return the entity of that name, or None."""
        return self._map.find(name)

    def space(self) -> Space:
        """Return the solids."""
        return self._map.places.space()

    def about(self, name: str) -> Iterator[About]:
        """Yield what an object is inside, on, in and attached to, by importance. Nothing for a place."""
        return self._map.places.about(name)

    def with_supported(self, names: Iterable[str]) -> Collection[str]:
        """Return these names and all that is on, inside or in them."""
        return self._map.places.with_supported(names)

    def left_out(self) -> Set[Fact]:
        """Return the measured facts that are suppressed."""
        return self._map.derived_facts.suppressed_measurements

    def nameless(self, entity: Entity) -> Mapping[str, Stated]:
        """Return the values of properties with nameless ones among them, with their content."""
        iri = v.iri(entity.iri)
        return self._map.classes.property_table.read_nameless(about_entity(self._map.reasoner, iri), iri)


class PastState:
    """A map of the past, measured again with the present thresholds. For any thread."""

    def __init__(self, entities: Sequence[Entity], limits: Thresholds) -> None:
        self._entities = {entity.name: entity for entity in entities}
        self._space = Space(entities, limits)

    def entities(self) -> Collection[Entity]:
        """Return all entities."""
        return self._entities.values()

    def find(self, name: str) -> Entity | None:
        """Return the entity of that name, or None."""
        return self._entities.get(name)

    def space(self) -> Space:
        """Return the solids."""
        return self._space

    def about(self, name: str) -> Iterator[About]:
        """Yield what an object is inside, on, in and attached to, by importance. Nothing for a place."""
        solid = self._space.solids.get(name)
        if solid is not None and not solid.is_place:
            for rule in RULES:
                yield from rule.facts(self._space, solid)

    def with_supported(self, names: Iterable[str]) -> Collection[str]:
        """Return all names."""
        return self._entities.keys()

    def left_out(self) -> Set[Fact]:
        """Return an empty set: contradictions of asserted and measured facts are not derived again."""
        return frozenset()

    def nameless(self, entity: Entity) -> Mapping[str, Stated]:
        """Return nothing: the entities of the past have no nameless parts."""
        return {}

    def find_denied(self) -> Iterator[Relation]:
        """Yield the asserted locations that contradict the geometry."""
        asserted = (
            fact
            for entity in self._entities.values()
            for property_, stated in entity.properties.items()
            for value in (stated if isinstance(stated, tuple) else (stated,))
            if isinstance(value, str) and value in self._entities
            if (fact := fact_of((v.iri(entity.iri), v.dm(property_), v.iri(self._entities[value].iri))))
        )
        return find_contradictions(self._space, asserted)
