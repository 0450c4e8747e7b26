"""The individuals of the map that are not in space, by name and IRI.

Few commands need them, so their names are collected when one is looked up for the first time. Later commits
only note what they are about, and the next lookup reads that again.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from itertools import chain
from operator import attrgetter
from typing import TYPE_CHECKING, Final

from semmap.nodes.kb_node.entities import individual_reading
from semmap.nodes.kb_node.progress import with_progress
from semmap.nodes.kb_node.sparql.queries.text import query_prefixes
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commits import Commit
from semmap.schemas.entities import Entity, composed
from semmap.schemas.explanations import Term, Triple

if TYPE_CHECKING:
    from semmap.nodes.kb_node.map_state import MapState
    from semmap.nodes.kb_node.reasoner import Reasoner

_IRI: Final = re.compile(r"(https?|file)://\S+|(urn|mailto|tag):\S+", re.IGNORECASE)
_MANY: Final = 100_000
"""Triples of a commit after which collecting all names again is faster."""


class Individuals:
    """Finds and reads individuals that are not in space. Owned by the thread of the map."""

    def __init__(self, state: MapState) -> None:
        self._state = state
        self._collected_from: Reasoner | None = None
        """The reasoner whose individuals were collected; None before the first lookup."""
        self._by_name: dict[str, set[Term]] = {}
        self._names: dict[Term, str] = {}
        self._changed: set[Term] = set()

    def note(self, commit: Commit) -> None:
        """Note what a commit, or its reversal, has changed."""
        if self._collected_from is None:
            return
        if len(commit.retracted) + len(commit.inserted) > _MANY:
            self._collected_from = None
            return
        self._changed.update(triple[0] for triple in chain(commit.retracted, commit.inserted))

    def terms(self) -> list[Term]:
        """Return the individuals that the map describes; those of its TBox are not included."""
        self._update()
        return [term for term in self._names if self._is_individual(term) and not self.is_of_tbox(term)]

    def list(self) -> tuple[Entity, ...]:
        """Return these individuals, sorted by name. Equal ones (`owl:sameAs`) are one individual."""
        reasoner, classes = self._state.reasoner, self._state.classes
        terms = set(self.terms())
        first = (min(terms & {term, *reasoner.equals(term)}) for term in terms)
        read = (individual_reading.read_individual(reasoner, classes, term) for term in set(first))
        return tuple(sorted(read, key=attrgetter("name", "iri")))

    def find(self, word: str) -> Entity | None:
        """Return the individual with this name or IRI, also one of the TBox, or None.

        Raises BadRequest for a name of several.
        """
        term = self.find_term(word)
        if term is None:
            return None
        return individual_reading.read_individual(self._state.reasoner, self._state.classes, term)

    def find_term(self, word: str) -> Term | None:
        """Return the IRI term of the individual; see `find`."""
        if (term := self.parse_iri(word)) is not None:
            return term if self._is_individual(term) else None
        if self._is_individual(own := v.entity_iri(name := composed(word))):
            return own
        self._update()
        named = sorted(filter(self._is_individual, self._by_name.get(name, ())))
        if len(named) > 1 and not set(named) <= {named[0], *self._state.reasoner.equals(named[0])}:
            raise errors.BadRequest(f"'{word}' is ambiguous: {errors.enumerated(named)}; give the IRI in <>")
        return named[0] if named else None

    def find_referring(self, entity: Entity) -> dict[str, tuple[str, ...]]:
        """Return the names of what refers to an individual, by property."""
        return individual_reading.find_referring(self._state.reasoner, v.iri(entity.iri))

    def parse_iri(self, word: str) -> Term | None:
        """Return the term of an IRI, with or without <>, or with a known prefix; None for another word."""
        if word.startswith("<") and word.endswith(">"):
            return word
        if _IRI.fullmatch(word):
            return v.iri(word)
        prefix, colon, name = word.partition(":")
        known = query_prefixes(self._state.classes.prefixes) if colon else {}
        return v.iri(known[prefix] + name) if prefix in known else None

    def is_of_tbox(self, term: Term) -> bool:
        """Return whether the TBox describes a term, so that commands cannot change it."""
        return not self._state.tbox.isdisjoint(self._state.reasoner.asserted(term))

    def _is_individual(self, term: Term) -> bool:
        return individual_reading.is_individual(self._state.reasoner, self._state.classes, term)

    def _update(self) -> None:
        """Collect the names, or read those again that commits have changed."""
        reasoner = self._state.reasoner
        if self._collected_from is not reasoner:
            self._by_name, self._names, self._changed = {}, {}, set()
            for triples in with_progress(reasoner.by_subject(), self._state.progress):
                self._collect(triples)
            self._collected_from = reasoner
        for term in self._changed:
            if (name := self._names.pop(term, None)) is not None:
                self._by_name[name].discard(term)
            self._collect(reasoner.asserted(term))
        self._changed.clear()

    def _collect(self, triples: Iterable[Triple]) -> None:
        types: dict[Term, list[Term]] = {}
        for s, p, o in triples:
            of = types.setdefault(s, [])
            if p == v.RDF_TYPE:
                of.append(o)
        for term, of in types.items():
            if term not in self._names and individual_reading.may_be_individual(
                self._state.classes, term, of
            ):
                name = self._names[term] = v.entity_name(term)
                self._by_name.setdefault(name, set()).add(term)
