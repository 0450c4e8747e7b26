"""Which entities of the map as it is a description means: answers `find`."""

from __future__ import annotations

from typing import NamedTuple

from msgspec import structs

from semmap.nodes.kb_node.answers.speakable import item, terms
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.relations.asked import Asked
from semmap.nodes.kb_node.relations.measuring.phrases import SPOKEN
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.viewing import View
from semmap.nodes.kb_node.relations.selection import is_in, is_on, only_meant
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


class Sought(NamedTuple):
    """What was found, and what is still to be looked for in the past."""

    found: Found
    missing: Missing | None = None

    def with_the_past(self, gone: tuple[str, ...]) -> Found:
        """The same with when it was last there."""
        return structs.replace(self.found, gone=gone)


class Finding:
    """Finds entities by what is said of them; owned by the node's thread."""

    def __init__(self, semantic_map: SemanticMap) -> None:
        self._map = semantic_map
        self._classes: ClassTable | None = None
        self._known: MapIndex | None = None
        self._read: dict[str, Entity] = {}
        self._seq = -1

    def find(self, query: Find) -> Sought:
        """What is described. Raises BadRequest, UnknownName for an asker or viewer that is not there."""
        space = self._map.places.space()
        asker = None if query.asker is None else self._named(query.asker)
        around = Asked(space, self._view(query, space), self._map.beliefs.left_out)
        with space.remembering():
            answer = find(query.text, self.known(), around, asker)
            found = explanation.explain(answer)
        return Sought(structs.replace(found, seq=self._map.seq), missing(answer))

    def described(self, text: str) -> tuple[str, ...]:
        """The entities that a text describes, by name; none where that cannot be said."""
        space = self._map.places.space()
        around = Asked(space, None, self._map.beliefs.left_out)
        try:
            with space.remembering():
                found = find(text, self.known(), around)
        except errors.BadRequest:
            return ()
        return tuple(sorted(found.names))

    def is_at(self, thing: str, other: str) -> bool:
        """Whether a thing is on, in or inside another, or that cannot be told."""
        space, left_out = self._map.places.space(), self._map.beliefs.left_out
        solid = space.solids.get(thing)
        if solid is None or other not in space.solids:
            return True
        return is_on(space, solid, {other}, left_out) or is_in(space, solid, {other}, left_out)

    def where(self, thing: str) -> str:
        """What a thing is on, inside or in: `on desk1`; "" for nothing."""
        around = Asked(self._map.places.space(), None, self._map.beliefs.left_out)
        relation, other = next(iter(around.whereabouts(thing)), (None, ""))
        return f"{SPOKEN[relation].removeprefix('is ')} {other}" if relation else ""

    def question(self, names: tuple[str, ...], language: Language) -> str:
        """What to ask back to learn which of several entities is meant."""
        space = self._map.places.space()
        around = Asked(space, None, self._map.beliefs.left_out)
        with space.remembering():
            return clarification.clarifying_question(names, Resolver(self.known(), around, language))

    def known(self) -> MapIndex:
        """What there is to be described, after the last commit; who is as before is not read again."""
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
            raise errors.Refused(f"{name} has no position, so nobody can look from there")
        return View.of(viewer)

    def _named(self, word: str) -> str:
        return word if self._map.find(word) is not None else only_meant(tuple(self._map.entities()), word)
