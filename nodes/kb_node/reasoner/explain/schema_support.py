"""The asserted triples behind what the schema says, worked out once for each question."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from itertools import chain
from typing import TypeVar

from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.tbox.axioms import Axioms
from semmap.nodes.kb_node.reasoner.tbox.schema import Schema
from semmap.nodes.kb_node.reasoner.terms import TYPE, iri

Found = dict[Triple, None]
"""A set of triples that keeps its order, so that like explanations are found alike."""
_SUB_CLASS_OF = iri("rdfs:subClassOf")
_K = TypeVar("_K")


class SchemaSupport:
    """Traces what a compiled schema says back to its triples."""

    def __init__(self, schema: Schema) -> None:
        self._schema = schema
        self._known: dict[tuple[object, ...], Found] = {}

    def facts(self, facts: Iterable[Triple]) -> Found:
        """The asserted triples below facts of the schema's closure."""
        return union(*(self._once(self._leaves, fact) for fact in facts))

    def below(self, narrow: int, wide: int) -> Found:
        """Why one class is a subclass of another; for a nominal, the axiom that mentions it."""
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
        """All that the schema's closure says of a subject with some predicates, lists included."""
        return self._once(self._axiom, (subject, *names))

    def restriction(self, cls: int) -> Found:
        """What makes a class a restriction."""
        if passed := self._schema.passed_on.get(cls):
            return self.restriction(passed[0])
        return self.axiom(self._schema.classes[cls], *_RESTRICTION)

    def chains(self, result: Axioms) -> Found:
        """The chains that lead to a property, itself twice among them."""
        transitive = (result.term, TYPE, iri("owl:TransitiveProperty"))
        return self.axiom(result.term, "owl:propertyChainAxiom") | self.facts([transitive])

    def transitive(self, prop: int) -> Found:
        """That a property is transitive, in whichever way that is stated, and all that its steps imply."""
        implied = chain.from_iterable(self._schema.roles(prop).values())
        return self.chains(self._schema.axioms[prop]) | self.facts(implied)

    def about(self, term: Term) -> Found:
        """The axioms that a class, property or individual may contradict another by."""
        return self._once(self._about, term)

    def about_class(self, cls: int) -> Found:
        """The same for a class by its number, and what makes it a restriction."""
        name, negative = self._schema.classes[cls], self._schema.negatives.get(cls)
        if negative is not None:
            return self.axiom(negative, *_NEGATIVE)
        return self.about(name.strip("{}")) | self.restriction(cls)

    def _once(self, find: Callable[[_K], Found], about: _K) -> Found:
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
    """All triples of some sets."""
    return {triple: None for part in parts for triple in part}


_BETWEEN = ("rdf:type", "owl:disjointWith", "owl:complementOf", "owl:propertyDisjointWith", "owl:hasKey")
_NEGATIVE = ("owl:sourceIndividual", "owl:assertionProperty", "owl:targetIndividual", "owl:targetValue")
_RESTRICTION = (
    "owl:onProperty", "owl:onClass", "owl:someValuesFrom", "owl:allValuesFrom", "owl:hasValue",
    "owl:maxCardinality", "owl:maxQualifiedCardinality",
)  # fmt: skip
