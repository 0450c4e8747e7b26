"""Entities that match a description: the command `find`."""

from __future__ import annotations

from typing import NamedTuple

from msgspec import structs

from semmap.nodes.kb_node.answers.search_vocabulary import item, terms
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.viewing import View
from semmap.nodes.kb_node.relations.relation_cache import RelationCache
from semmap.nodes.kb_node.relations.selection import is_in, is_on, resolve_single
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.language.reference_resolution import clarification, explanation
from semmap.nodes.language.reference_resolution.map_index import MapIndex
from semmap.nodes.language.reference_resolution.missing import Missing, missing
from semmap.nodes.language.reference_resolution.resolution import find
from semmap.nodes.language.reference_resolution.resolver import Resolver
from semmap.schemas import errors
from semmap.schemas.commands import Find
from semmap.schemas.entities import Entity
from semmap.schemas.language import Found, Language
from semmap.schemas.relations import PHRASES


class SearchResult(NamedTuple):
    """The result, and what is still to be looked up in the past."""

    found: Found
    missing: Missing | None = None

    def with_last_times(self, gone: tuple[str, ...]) -> Found:
        """Return the result with the times at which the missing entities were last there."""
        return structs.replace(self.found, gone=gone)


class EntitySearch:
    """Finds entities by description. Owned by the node's thread."""

    def __init__(self, semantic_map: SemanticMap) -> None:
        self._map = semantic_map
        self._classes: ClassTable | None = None
        self._known: MapIndex | None = None
        self._read: dict[str, Entity] = {}
        self._seq = -1

    def find(self, query: Find) -> SearchResult:
        """Return the described entities. Raises BadRequest; UnknownName for an unknown asker or viewer."""
        space = self._map.places.space()
        asker = None if query.asker is None else self._named(query.asker)
        around = RelationCache(
            space, self._view(query, space), self._map.derived_facts.suppressed_measurements
        )
        with space.caching():
            answer = find(query.text, self.known(), around, asker)
            found = explanation.explain(answer)
        return SearchResult(structs.replace(found, seq=self._map.seq), missing(answer))

    def described(self, text: str) -> tuple[str, ...]:
        """Return the names of the entities that a text describes, or none if it cannot be read."""
        space = self._map.places.space()
        around = RelationCache(space, None, self._map.derived_facts.suppressed_measurements)
        try:
            with space.caching():
                found = find(text, self.known(), around)
        except errors.BadRequest:
            return ()
        return tuple(sorted(found.names))

    def is_at(self, thing: str, other: str) -> bool:
        """Return whether an object is on, in or inside another, or whether that is unknown."""
        space, left_out = self._map.places.space(), self._map.derived_facts.suppressed_measurements
        solid = space.solids.get(thing)
        if solid is None or other not in space.solids:
            return True
        return is_on(space, solid, {other}, left_out) or is_in(space, solid, {other}, left_out)

    def where(self, thing: str) -> str:
        """Return what an object is on, inside or in, such as `on desk1`, or "" if nothing."""
        around = RelationCache(
            self._map.places.space(), None, self._map.derived_facts.suppressed_measurements
        )
        relation, other = next(iter(around.spatial_relations(thing)), (None, ""))
        return f"{PHRASES[relation].removeprefix('is ')} {other}" if relation else ""

    def question(self, names: tuple[str, ...], language: Language) -> str:
        """Return a question that asks which of several entities is meant."""
        space = self._map.places.space()
        around = RelationCache(space, None, self._map.derived_facts.suppressed_measurements)
        with space.caching():
            return clarification.clarifying_question(names, Resolver(self.known(), around, language))

    def known(self) -> MapIndex:
        """Return the search items after the last commit; unchanged entities are not read again."""
        if self._known is None or self._classes is not self._map.classes:
            self._classes, self._seq, self._read = self._map.classes, -1, {}
            self._known = MapIndex(terms(self._map.reasoner, self._map.classes))
        if self._seq != self._map.seq:
            there = {entity.name: entity for entity in self._map.entities()}
            changed = [entity for name, entity in there.items() if self._read.get(name) is not entity]
            self._known.update(map(item, changed), self._read.keys() - there.keys())
            self._read, self._seq = there, self._map.seq
        return self._known

    def _view(self, query: Find, space: Space) -> View | None:
        if query.viewpoint is not None:
            return View.at(*query.viewpoint)
        if query.viewer is None:
            return None
        viewer = space.solids.get(name := self._named(query.viewer))
        if viewer is None:
            raise errors.Refused(f"{name} has no position, so it cannot be the viewer")
        return View.of(viewer)

    def _named(self, word: str) -> str:
        return word if self._map.find(word) is not None else resolve_single(tuple(self._map.entities()), word)
