"""Which entities of the map as it is a description means: answers `find`."""

from __future__ import annotations

from collections.abc import Iterator

from msgspec import structs

from nodes.kb_node.entities.class_table import ClassTable
from nodes.kb_node.reasoner import Reasoner
from nodes.kb_node.relations.asked import Asked
from nodes.kb_node.relations.measuring.space import Space
from nodes.kb_node.relations.measuring.viewing import View
from nodes.kb_node.relations.selection import only_meant
from nodes.kb_node.semantic_map import SemanticMap
from nodes.language.finding import asking_back
from nodes.language.finding.finding import answer, find
from nodes.language.finding.known import Item, Known, Terms
from nodes.language.finding.resolving import Resolver
from ontology import vocabulary as v
from schemas import errors
from schemas.commands import Find
from schemas.entities import Entity
from schemas.explanations import Term
from schemas.language import Found, Language

_HAS_AFFORDANCE = v.dm("hasAffordance")


class Finding:
    """Finds entities by what is said of them; owned by the node's thread."""

    def __init__(self, semantic_map: SemanticMap) -> None:
        self._map = semantic_map
        self._classes: ClassTable | None = None
        self._known: Known | None = None
        self._read: dict[str, Entity] = {}
        self._seq = -1

    def find(self, query: Find) -> Found:
        """What is described. Raises BadRequest, UnknownName for an asker or viewer that is not there."""
        space = self._map.places.space()
        asker = None if query.asker is None else self._named(query.asker)
        around = Asked(space, self._view(query, space), self._map.beliefs.left_out)
        with space.remembering():
            found = find(query.text, self.known(), around, asker)
        return structs.replace(found, seq=self._map.seq)

    def narrowed(self, text: str, names: tuple[str, ...]) -> tuple[str, ...]:
        """Of the entities that a text may mean those that it does; all where that cannot be said."""
        space = self._map.places.space()
        around = Asked(space, None, self._map.beliefs.left_out)
        try:
            with space.remembering():
                found = answer(text, self.known(), around)
        except errors.BadRequest:
            return names
        return tuple(name for name in found.names if name in names) or names

    def question(self, names: tuple[str, ...], language: Language) -> str:
        """What to ask back to learn which of several entities is meant."""
        space = self._map.places.space()
        around = Asked(space, None, self._map.beliefs.left_out)
        with space.remembering():
            return asking_back.question(names, Resolver(self.known(), around, language))

    def known(self) -> Known:
        """What there is to be described, after the last commit; who is as before is not read again."""
        if self._known is None or self._classes is not self._map.classes:
            self._classes, self._seq, self._read = self._map.classes, -1, {}
            self._known = Known(terms(self._map.reasoner, self._map.classes))
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


def item(entity: Entity) -> Item:
    """An entity as one speaks of it."""
    references = filter(None, (entity.preferred_reference, *entity.alternative_references))
    values: dict[str, frozenset[object]] = {
        name: frozenset(value if isinstance(value, tuple) else (value,))
        for name, value in entity.properties.items()
    }
    return Item(entity.name, entity.class_, frozenset(entity.types), tuple(references), values, entity.place)


def terms(reasoner: Reasoner, classes: ClassTable) -> Terms:
    """What a TBox has words for."""
    rows = [row for row in classes.rows if row.spatial]
    named = [(language, row.name, text) for row in rows for language, text in row.labels.items()]
    named += [("", row.name, text) for row in rows for text in row.also]
    named += [("en" if row.labels else "", row.name, row.name) for row in rows]
    values = {value for row in classes.stated.rows() if row.kind == "object" for value in row.values}
    affordances = {v.local_name(i) for i in reasoner.instances(v.dm("Affordance"))}
    return Terms(
        tuple(named),
        tuple(_labels(reasoner, values - affordances)),
        tuple(_labels(reasoner, affordances)),
        _affords(reasoner, classes),
    )


def _labels(reasoner: Reasoner, names: set[str]) -> Iterator[tuple[str, str, str]]:
    for name in sorted(names):
        for _, _, label in reasoner.asserted(v.dm(name), v.RDFS_LABEL, None):
            yield v.language_of(label) or "", name, v.lexical(label)


def _affords(reasoner: Reasoner, classes: ClassTable) -> dict[str, frozenset[str]]:
    """Class to what the TBox says that its instances afford."""
    found: dict[str, set[str]] = {}
    for restriction, _, value in reasoner.asserted(None, v.iri(f"{v.OWL}hasValue"), None):
        if any(reasoner.asserted(restriction, v.iri(f"{v.OWL}onProperty"), _HAS_AFFORDANCE)):
            for cls, _, _ in reasoner.asserted(None, v.RDFS_SUB_CLASS_OF, restriction):
                if (name := _name(classes, cls)) is not None:
                    found.setdefault(name, set()).add(v.local_name(value))
    return {name: frozenset(values) for name, values in found.items()}


def _name(classes: ClassTable, cls: Term) -> str | None:
    return classes.names.get(cls)
