"""The asserted triples behind the facts of the schema, with a cache."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from itertools import chain
from typing import TypeVar

from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.tbox.axioms import Axioms
from semmap.nodes.kb_node.reasoner.tbox.schema import Schema
from semmap.nodes.kb_node.reasoner.terms import TYPE, iri

Found = dict[Triple, None]
"""An ordered set of triples, so that results are reproducible."""
_SUB_CLASS_OF = iri("rdfs:subClassOf")
_K = TypeVar("_K")


class SchemaSupport:
    """Traces facts of a compiled schema back to its asserted triples."""

    def __init__(self, schema: Schema) -> None:
        self._schema = schema
        self._known: dict[tuple[object, ...], Found] = {}

    def facts(self, facts: Iterable[Triple]) -> Found:
        """Return the asserted triples from which facts of the schema's closure follow."""
        return union(*(self._cached(self._leaves, fact) for fact in facts))

    def below(self, narrow: int, wide: int) -> Found:
        """Return why a class is a subclass of another. For a nominal, return the axiom that mentions it."""
        if narrow == wide:
            return {}
        schema = self._schema
        if passed := schema.passed_on.get(narrow):
            return self.below(passed[1], wide)
        name, wider = schema.classes[narrow], schema.classes[wide]
        if not name.startswith("{"):
            return self.facts([(name, _SUB_CLASS_OF, wider)])
        for fact in schema.closure.match(name[1:-1], TYPE):
            step = (fact[2], _SUB_CLASS_OF, wider)
            if fact[2] == wider or step in schema.closure.facts:
                return self.facts([fact, step])
        return {}

    def axiom(self, subject: Term, *names: str) -> Found:
        """Return the closure's facts about a subject with the given predicates, including lists."""
        return self._cached(self._axiom, (subject, *names))

    def restriction(self, cls: int) -> Found:
        """Return the triples that define a class as a restriction."""
        if passed := self._schema.passed_on.get(cls):
            return self.restriction(passed[0])
        return self.axiom(self._schema.classes[cls], *_RESTRICTION)

    def chains(self, result: Axioms) -> Found:
        """Return the chains that imply a property, including transitivity."""
        transitive = (result.term, TYPE, iri("owl:TransitiveProperty"))
        return self.axiom(result.term, "owl:propertyChainAxiom") | self.facts([transitive])

    def transitive(self, prop: int) -> Found:
        """Return the axioms that make a property transitive, and all that its steps imply."""
        implied = chain.from_iterable(self._schema.roles(prop).values())
        return self.chains(self._schema.axioms[prop]) | self.facts(implied)

    def about(self, term: Term) -> Found:
        """Return the axioms by which a class, property or individual may contradict another."""
        return self._cached(self._about, term)

    def about_class(self, cls: int) -> Found:
        """Return `about` for a class by its number, and the triples that define it as a restriction."""
        name, negative = self._schema.classes[cls], self._schema.negatives.get(cls)
        if negative is not None:
            return self.axiom(negative, *_NEGATIVE)
        return self.about(name.strip("{}")) | self.restriction(cls) | self.data_range(cls)

    def data_range(self, cls: int) -> Found:
        """Return the triples that define a class as a data range."""
        definition = self._schema.data_ranges.get(cls)
        return {} if definition is None else self.facts(definition[1])

    def _cached(self, find: Callable[[_K], Found], about: _K) -> Found:
        key = (find.__name__, about)
        found = self._known.get(key)
        if found is None:
            found = self._known[key] = find(about)
        return found

    def _leaves(self, fact: Triple) -> Found:
        closure = self._schema.closure
        return dict.fromkeys(closure.leaves(fact)) if fact in closure.facts else {}

    def _axiom(self, subject_and_names: tuple[str, ...]) -> Found:
        subject, *names = subject_and_names
        closure = self._schema.closure
        found: Found = {}
        for name in names:
            for fact in closure.match(subject, iri(name)):
                members = closure.members(fact[2])
                found |= self.facts([fact]) | dict.fromkeys(members[1] if members else ())
        return found

    def _about(self, term: Term) -> Found:
        found = self.axiom(term, *_BETWEEN)
        for axiom in dict.fromkeys(self._schema.listed.get(term, ())):
            found = found | self.axiom(axiom, "rdf:type", "owl:members", "owl:distinctMembers")
        return found


def union(*parts: Found) -> Found:
    """Return the union of sets of triples."""
    return {triple: None for part in parts for triple in part}


_BETWEEN = ("rdf:type", "owl:disjointWith", "owl:complementOf", "owl:propertyDisjointWith", "owl:hasKey")
_NEGATIVE = ("owl:sourceIndividual", "owl:assertionProperty", "owl:targetIndividual", "owl:targetValue")
_RESTRICTION = (
    "owl:onProperty", "owl:onClass", "owl:someValuesFrom", "owl:allValuesFrom", "owl:hasValue",
    "owl:maxCardinality", "owl:maxQualifiedCardinality",
)  # fmt: skip
