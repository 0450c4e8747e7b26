"""Entities and where they are, now and in the past: what `list`, `get`, `relations` and `explain` answer."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from msgspec import structs

from nodes.kb_node.answers import answers, questions
from nodes.kb_node.relations.said import denied
from nodes.kb_node.relations.selection import only_meant, selected
from nodes.kb_node.relations.space import Space
from nodes.kb_node.relations.telling import SPOKEN, explained, relations, whereabouts
from nodes.kb_node.semantic_map import SemanticMap
from nodes.kb_node.storage.history import Past
from ontology import vocabulary as v
from schemas import errors
from schemas.bridge import Entities
from schemas.commands import Explain, Get, Relations
from schemas.entities import Entity
from schemas.explanations import Explanation
from schemas.relations import Described, Relation


class Now:
    """The map as it is; owned by the node's thread."""

    def __init__(self, semantic_map: SemanticMap) -> None:
        self._map = semantic_map

    def entities(self, query: Entities) -> tuple[Entity, ...]:
        """The entities of a class; with `where` those that are there. Raises UnknownClass, UnknownName."""
        found = answers.entities_of(self._map, query.class_)
        if query.where is None:
            return found
        return tuple(selected(self._map.places.space(), found, query.where, self._map.entities()))

    def entity(self, query: Get) -> Described:
        """One entity; with `where` also where it is and what was wrongly said of that. Raises UnknownName."""
        entity = self._map.entity(query.name)
        if not query.where:
            return Described.of(entity)
        space = self._map.places.space()
        wrong = denied(space, answers.said_of_place(self._map, entity))
        return Described.of(entity, tuple(whereabouts(space, entity.name)), tuple(wrong))

    def relations(self, query: Relations) -> tuple[Relation, ...]:
        """Where a thing is relative to others. Raises UnknownName; BadRequest for an ambiguous word."""
        named = _named(query, self._map.find, lambda: tuple(self._map.entities()))
        return tuple(relations(self._map.places.space(), named))

    def explained(self, query: Explain, asked: questions.Asked) -> Explanation | None:
        """What was measured of where a thing is, and what follows besides; None for any other question.

        Raises Refused when the measurement denies it.
        """
        if query.negated or query.predicate not in SPOKEN:
            return None
        seen = explained(self._map.places.space(), query.name, query.predicate, query.value)
        if not seen:
            return None
        explanation = questions.why(self._map.reasoner, asked)
        if explanation is not None:
            link = "; and" if seen.holds else "; but as it stands"
            return structs.replace(explanation, text=f"{explanation.text.rstrip('.')}{link} {seen.text}")
        if not seen.holds:
            raise errors.Refused(seen.text)
        subject, object_ = (v.iri(self._map.entity(name).iri) for name in (seen.subject, seen.object))
        conclusion = (subject, v.dm(seen.relation), object_)
        return Explanation(conclusion=conclusion, support=(), steps=(), text=seen.text)


class Then:
    """The map as of `query.as_of`, read from the journal; for any thread."""

    def __init__(self, semantic_map: SemanticMap, past: Past) -> None:
        self._map = semantic_map
        self._past = past

    def entities(self, query: Entities) -> tuple[Entity, ...]:
        """See `Now.entities`."""
        assert query.as_of is not None
        found = self._past.entities(query.as_of, query.class_, tuple(self._map.classes.iris))
        if query.where is None:
            return found
        everyone = self._past.entities(query.as_of, None, ())
        return tuple(selected(self._space(everyone), found, query.where, everyone))

    def entity(self, query: Get) -> Described:
        """See `Now.entity`; what was wrongly said is not looked for."""
        assert query.as_of is not None
        entity = self._past.entity(query.name, query.as_of)
        if not query.where:
            return Described.of(entity)
        space = self._space(self._past.entities(query.as_of, None, ()))
        return Described.of(entity, tuple(whereabouts(space, entity.name)))

    def relations(self, query: Relations) -> tuple[Relation, ...]:
        """See `Now.relations`."""
        assert query.as_of is not None
        everyone = self._past.entities(query.as_of, None, ())
        there = {entity.name: entity for entity in everyone}
        named = _named(query, there.get, lambda: everyone)
        return tuple(relations(self._space(everyone), named))

    def _space(self, entities: Iterable[Entity]) -> Space:
        return Space(entities, self._map.classes.limits)


def _named(
    query: Relations, find: Callable[[str], Entity | None], everyone: Callable[[], Sequence[Entity]]
) -> Relations:
    """The query with the names of those whom its words mean: a name, else a reference, else a class."""
    names = {
        field: only_meant(everyone(), word)
        for field in ("name", "other", "viewer")
        if (word := getattr(query, field)) is not None and find(word) is None
    }
    return structs.replace(query, **names) if names else query
