"""Entities that match a description, and when missing ones were last there: the command `find`."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Set
from contextlib import contextmanager
from itertools import islice
from typing import Final, NamedTuple

from msgspec import structs

from semmap.nodes.kb_node.answers.past.differences import find_spells
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.relations.facts.place_facts import Fact
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.relations.measuring.viewing import View
from semmap.nodes.kb_node.relations.relation_cache import RelationCache
from semmap.nodes.kb_node.relations.selection import is_in, is_on, resolve_single
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.language.reference_resolution import clarification, explanation
from semmap.nodes.language.reference_resolution.map_index import Item, MapIndex, Terms
from semmap.nodes.language.reference_resolution.missing import Missing, missing
from semmap.nodes.language.reference_resolution.resolution import find
from semmap.nodes.language.reference_resolution.resolver import Resolver
from semmap.nodes.language.steps.entity_tests import World
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import Find, WasWhen
from semmap.schemas.entities import Entity
from semmap.schemas.language import Found, Language
from semmap.schemas.relations import PHRASES

_HAS_AFFORDANCE = v.dm("hasAffordance")
_MOST: Final = 3
"""Sentences of each kind."""
_LOOKED_AT: Final = 200
"""Recently removed entities that are checked."""


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
        left_out = self._map.derived_facts.suppressed_measurements
        found, gone = search(query, space, self.known(), self._named, left_out)
        return SearchResult(structs.replace(found, seq=self._map.seq), gone)

    def terms(self) -> Terms:
        """Return the labels of the TBox."""
        return terms(self._map.reasoner, self._map.classes)

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

    def denoted(self, text: str) -> tuple[tuple[str, ...], bool]:
        """Return the entities that a text may denote, and whether exactly one of several is meant."""
        space = self._map.places.space()
        around = RelationCache(space, None, self._map.derived_facts.suppressed_measurements)
        try:
            with space.caching():
                found = find(text, self.known(), around)
        except errors.BadRequest:
            return (), False
        return tuple(sorted(found.names)), found.outcome == "ambiguous"

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

    @contextmanager
    def world(self, above: Mapping[str, frozenset[str]], seen: Callable[[str], str]) -> Iterator[World]:
        """Yield the map as commands need it.

        `above` maps the classes of the TBox to their superclasses. `seen` returns in words when an entity was
        last seen.
        """
        space = self._map.places.space()
        around = RelationCache(space, None, self._map.derived_facts.suppressed_measurements)
        with space.caching():
            yield World(self.known(), around, above, self.where, seen)

    def known(self) -> MapIndex:
        """Return the search items after the last commit; unchanged entities are not read again."""
        if self._known is None or self._classes is not self._map.classes:
            self._classes, self._seq, self._read = self._map.classes, -1, {}
            self._known = MapIndex(self.terms())
        if self._seq != self._map.seq:
            there = {entity.name: entity for entity in self._map.entities()}
            changed = [entity for name, entity in there.items() if self._read.get(name) is not entity]
            self._known.update(map(item, changed), self._read.keys() - there.keys())
            self._read, self._seq = there, self._map.seq
        return self._known

    def _named(self, word: str) -> str:
        return self._map.resolve(word).name


def search(
    query: Find, space: Space, known: MapIndex, named: Callable[[str], str], left_out: Set[Fact] = frozenset()
) -> SearchResult:
    """Return the described entities of one state of the map.

    `named` returns the name of the entity that a word refers to. The relations `left_out` are suppressed.
    Raises BadRequest; UnknownName for an unknown asker or viewer.
    """
    asker = None if query.asker is None else named(query.asker)
    around = RelationCache(space, _view(query, space, named), left_out)
    with space.caching():
        answer = find(query.text, known, around, asker, query.answer)
        return SearchResult(explanation.explain(answer), missing(answer))


def _view(query: Find, space: Space, named: Callable[[str], str]) -> View | None:
    if query.viewpoint is not None:
        return View.at(*query.viewpoint)
    if query.viewer is None:
        return None
    viewer = space.solids.get(name := named(query.viewer))
    if viewer is None:
        raise errors.Refused(f"{name} has no position, so it cannot be the viewer")
    return View.of(viewer)


def find_past(query: Find, past: HistoryReader, labels: Terms, limits: Thresholds) -> Found:
    """Return the described entities of the map as of `query.as_of`, by the present labels of the TBox.

    For any thread. Raises the errors of `search`, and Refused if there was no map.
    """
    if query.as_of is None:
        raise errors.InternalError("the query has no time")
    seq = past.commit_at(query.as_of)
    entities = past.entities(seq)
    known = MapIndex(labels)
    known.update(map(item, entities), ())
    found = search(query, Space(entities, limits), known, lambda word: resolve_single(entities, word)).found
    return structs.replace(found, seq=seq)


def item(entity: Entity) -> Item:
    """Return an entity as a search item."""
    references = filter(
        None, (entity.preferred_reference, *entity.alternative_references, *entity.other_names)
    )
    values: dict[str, frozenset[object]] = {
        name: frozenset(value if isinstance(value, tuple) else (value,))
        for name, value in entity.properties.items()
    }
    return Item(entity.name, entity.class_, frozenset(entity.types), tuple(references), values, entity.place)


def terms(reasoner: Reasoner, classes: ClassTable) -> Terms:
    """Return the classes, values and affordances of a TBox with their labels."""
    rows = [row for row in classes.rows if row.spatial]
    named = [(language, row.name, text) for row in rows for language, text in row.labels.items()]
    named += [("", row.name, text) for row in rows for text in row.also]
    named += [("en" if row.labels else "", row.name, row.name) for row in rows]
    values = {value for row in classes.property_table.rows() if row.kind == "object" for value in row.values}
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
    """Return by class which affordances the TBox states for its instances."""
    found: dict[str, set[str]] = {}
    for restriction, _, value in reasoner.asserted(None, v.iri(f"{v.OWL}hasValue"), None):
        if any(reasoner.asserted(restriction, v.iri(f"{v.OWL}onProperty"), _HAS_AFFORDANCE)):
            for cls, _, _ in reasoner.asserted(None, v.RDFS_SUB_CLASS_OF, restriction):
                if (name := classes.names.get(cls)) is not None:
                    found.setdefault(name, set()).add(v.local_name(value))
    return {name: frozenset(values) for name, values in found.items()}


def describe_missing(
    journal: Journal, past: HistoryReader, missing: Missing, present: Set[str], limits: Thresholds
) -> tuple[str, ...]:
    """Return sentences on when it was last there, newest first.

    For any thread. `present` are the present names.
    """
    removed = islice(_removed(journal, past, missing, present), _MOST)
    moved = islice(_moved(journal, past, missing, limits), _MOST)
    return (*removed, *moved)


def _removed(journal: Journal, past: HistoryReader, missing: Missing, present: Set[str]) -> Iterator[str]:
    """Yield sentences on removed entities of that kind."""
    touched = [(seq, name) for name, seq in journal.last_touches(past.last) if name not in present]
    for seq, name in sorted(touched, reverse=True)[:_LOOKED_AT]:
        try:
            entity = past.entity(name, seq - 1)
        except (
            errors.UnknownName,
            errors.Refused,
        ):  # it existed only briefly, or before the history begins
            continue
        if missing.is_such(item(entity)):
            yield f"{name} was there until commit {seq}, {_at(journal, seq)}"


def _moved(journal: Journal, past: HistoryReader, missing: Missing, limits: Thresholds) -> Iterator[str]:
    """Yield sentences on present entities that were at the described location before."""
    for name, relation, other in missing.pairs:
        asked = WasWhen(name=name, relation=relation, other=other)
        held = find_spells(journal, past, asked, limits).spells
        if held and (until := held[-1].until) is not None:
            where = PHRASES[relation].removeprefix("is ")
            yield f"{name} was {where} {other} until commit {until}, {_at(journal, until)}"


def _at(journal: Journal, seq: int) -> str:
    return time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(journal.stamps.of(seq) / 1e9))
