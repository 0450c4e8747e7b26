"""Entailment of a graph of facts and axioms. Its blank nodes are existential variables."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, islice

from semmap.nodes.kb_node.reasoner.entailment.axiom_tests import AxiomProver
from semmap.nodes.kb_node.reasoner.entailment.effort import Effort
from semmap.nodes.kb_node.reasoner.entailment.expressions import Reader, Unreadable
from semmap.nodes.kb_node.reasoner.entailment.prover import Prover
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.reasoner import Reasoner
from semmap.nodes.kb_node.reasoner.rules.facts import Facts
from semmap.nodes.kb_node.reasoner.tbox.split import is_schema
from semmap.nodes.kb_node.reasoner.terms import FIRST, REST, TYPE, iri, iris, is_literal, is_named

_DECLARED = frozenset(
    iris(
        "owl:Class rdfs:Class owl:ObjectProperty owl:DatatypeProperty owl:AnnotationProperty rdf:Property "
        "owl:NamedIndividual rdfs:Datatype owl:Ontology owl:Restriction rdf:List owl:DataRange"
    )
)
"""Classes by which a term is declared."""
_PARTS = frozenset(
    iris(
        "owl:intersectionOf owl:unionOf owl:oneOf owl:complementOf owl:datatypeComplementOf owl:onProperty "
        "owl:someValuesFrom owl:allValuesFrom owl:hasValue owl:hasSelf owl:onClass owl:onDataRange "
        "owl:minCardinality owl:maxCardinality owl:cardinality owl:minQualifiedCardinality "
        "owl:maxQualifiedCardinality owl:qualifiedCardinality"
    )
)
"""Predicates that make a node a class expression."""
_DEFINING = frozenset(iris("owl:intersectionOf owl:unionOf owl:oneOf owl:complementOf"))
"""Predicates that define a named class."""
_STATED_BY = {
    iri("owl:AllDifferent"): "different",
    iri("owl:AllDisjointClasses"): "classes",
    iri("owl:AllDisjointProperties"): "properties",
    iri("owl:NegativePropertyAssertion"): "never",
}
"""Axioms that are represented by a node."""
_CANDIDATES = 200
"""Maximum number of individuals that are tried for a blank node."""

Choice = dict[Term, Term]
"""The terms assigned to blank nodes."""


def entails(reasoner: Reasoner, graph: Iterable[Triple], effort: Effort | None = None) -> bool:
    """Return whether a graph follows from the facts of a reasoner; False if no proof is found.

    Three methods are tried in this order: match the graph with the conclusions of the rules; prove its facts
    and axioms one by one; do so with names for values that must exist. The reasoner is restored afterwards.
    An `effort` bounds the search, and may trace it. The first method cannot be traced and is then left out.
    """
    graph = [(_rename_blank_node(s), p, _rename_blank_node(o)) for s, p, o in dict.fromkeys(graph)]
    is_traced = effort is not None and effort.is_traced
    if not is_traced and _Search(reasoner, graph).matches(graph):
        return True
    goal = _GoalGraph(reasoner, graph, effort)
    try:
        if goal.follows():
            return True
        if (
            effort is not None and not effort.allow_recompute
        ):  # too expensive with names for all values that must exist
            return False
        return goal.prover.with_witnesses(goal.individuals(), goal.follows)
    except Unreadable:
        return False


def _rename_blank_node(term: Term) -> Term:
    """Rename a blank node, because its label may be that of another node in the reasoner."""
    return f"_:wanted.{term[2:]}" if term.startswith("_:") else term


def contradictory(reasoner: Reasoner) -> bool:
    """Return whether naming the values that must exist leads to a contradiction the rules do not find."""
    return Prover(reasoner).with_witnesses((), lambda: False)


class _GoalGraph:
    """The graph to prove, read as axioms and facts."""

    def __init__(self, reasoner: Reasoner, graph: Sequence[Triple], effort: Effort | None) -> None:
        self.prover = Prover(reasoner, effort)
        self._facts = Facts(dict.fromkeys(graph))
        self._reader = Reader(self._facts.match)
        self._axioms = AxiomProver(self.prover, self._reader)
        self._search = _Search(reasoner, graph, self.prover, self._reader)
        self._reasoner = reasoner

    def follows(self) -> bool:
        """Return whether the whole graph is proved. Raises Unreadable."""
        for s, p, _ in self._facts.facts:
            if p in _PARTS and not is_named(s):
                self._reader.expression(
                    s
                )  # raises for invalid expressions, which must not count as existing nodes
        search: list[Triple] = []
        has_axioms = any(not self._is_declaration(triple) for triple in self._facts.facts)
        for triple in self._facts.facts:
            if self._is_part(triple) or (
                self._is_declaration(triple) and self._is_declared(triple, has_axioms)
            ):
                continue
            proved = self._axiom(triple)
            if proved is False:
                return False
            if proved is None:
                search.append(triple)
        return self._search.matches(search)

    def individuals(self) -> list[Term]:
        """Return the named individuals of the graph."""
        facts = [triple for triple in self._facts.facts if not is_schema(triple)]
        terms = dict.fromkeys(term for s, p, o in facts for term in ((s,) if p == TYPE else (s, o)))
        return [term for term in terms if is_named(term)]

    def _is_declaration(self, triple: Triple) -> bool:
        return triple[1] == TYPE and triple[2] in _DECLARED

    def _is_declared(self, triple: Triple, has_axioms: bool) -> bool:
        """Return whether a declaration holds. With other axioms it is always true (Direct Semantics)."""
        s, _, o = triple
        if o == iri("owl:Ontology") or (self._is_structure(s) and self._is_used(s)):
            return True
        return has_axioms or self._reasoner.holds(triple) or self._axioms.is_used_as(s, o)

    def _is_part(self, triple: Triple) -> bool:
        """Return whether a triple is part of an axiom or expression."""
        s, p, _ = triple
        if p in (FIRST, REST):
            return self._is_structure(s)
        if p == iri("owl:imports"):
            return self._has(s, TYPE, iri("owl:Ontology"))
        if p == TYPE and triple[2] in _STATED_BY:
            return False
        is_part = p in _PARTS or p in _MEMBERS or p == iri("owl:inverseOf")
        return is_part and self._is_structure(s) and self._is_used(s)

    def _is_used(self, node: Term) -> bool:
        """Return whether an expression is used. Otherwise the graph states that such a class exists."""
        if next(iter(self._facts.match(None, None, node)), None) is not None:
            return True
        return any(
            p not in _PARTS and (p != TYPE or o not in _DECLARED) for _, p, o in self._facts.match(node)
        )

    def _is_structure(self, node: Term) -> bool:
        """Return whether a blank node is an expression, list or axiom, and not an individual."""
        if is_named(node) or is_literal(node):
            return False
        predicates = {p for _, p, _ in self._facts.match(node)}
        if predicates & (_PARTS | {FIRST, REST, iri("owl:inverseOf")}):
            return True
        return any(self._has(node, TYPE, kind) for kind in _STATED_BY)

    def _has(self, s: Term, p: Term, o: Term) -> bool:
        return (s, p, o) in self._facts.facts

    def _axiom(self, triple: Triple) -> bool | None:
        """Return whether an axiom is proved; None if the triple is not an axiom. Raises Unreadable."""
        s, p, o = triple
        axioms = self._axioms
        if p == TYPE and o in _STATED_BY and not is_named(s):
            return self._node_axiom(s, _STATED_BY[o])
        is_open = not is_named(s) and not self._is_structure(s)
        if is_open or (p != TYPE and self._reasoner.holds(triple)):
            return None
        if p in _DEFINING and is_named(s):
            return all(axioms.same_class(self._reader.expression(s), d) for d in self._reader.definitions(s))
        if p in axioms.relations:
            return axioms.relations[p](s, o)
        if p == TYPE and o in axioms.characteristics:
            return self.prover.holds(triple) or axioms.characteristics[o](self._reader.role(s))
        return None

    def _node_axiom(self, node: Term, kind: str) -> bool:
        if kind == "never":
            source = self._one(node, "owl:sourceIndividual")
            prop = self._one(node, "owl:assertionProperty")
            target = self._one(node, "owl:targetIndividual", "owl:targetValue")
            return self._axioms.never(self._reader.role(prop).edge(source, target))
        heads = [*self._objects(node, "owl:members"), *self._objects(node, "owl:distinctMembers")]
        members = [member for head in heads for member in self._reader.members(head)]
        if not members:
            raise Unreadable(node)
        if kind == "different":
            return self._axioms.all_different(members)
        if kind == "classes":
            return self._axioms.disjoint_classes(list(map(self._reader.expression, members)))
        return self._axioms.disjoint_properties(list(map(self._reader.role, members)))

    def _one(self, node: Term, *names: str) -> Term:
        found = [o for name in names for o in self._objects(node, name)]
        if len(found) != 1:
            raise Unreadable(node)
        return found[0]

    def _objects(self, node: Term, name: str) -> list[Term]:
        return [o for _, _, o in self._facts.match(node, iri(name))]


class _Search:
    """Searches terms for the blank nodes of a graph."""

    def __init__(
        self,
        reasoner: Reasoner,
        graph: Sequence[Triple],
        prover: Prover | None = None,
        reader: Reader | None = None,
    ) -> None:
        self._reasoner = reasoner
        self._prover = prover
        self._reader = reader

    def matches(self, wanted: Sequence[Triple]) -> bool:
        """Return whether all of some triples hold for one choice."""
        return self._from({}, list(wanted))

    def _from(self, chosen: Choice, wanted: list[Triple]) -> bool:
        """Search the remaining triples, starting with those that have the fewest open blank nodes."""
        if not wanted:
            return True
        at = min(range(len(wanted)), key=lambda i: (self._open(wanted[i], chosen), wanted[i][1] == TYPE))
        triple, rest = wanted[at], wanted[:at] + wanted[at + 1 :]
        return any(self._from(extended, rest) for extended in self._choices(triple, chosen))

    def _open(self, triple: Triple, chosen: Choice) -> int:
        return sum(self._is_open(term, chosen) for term in triple)

    def _is_open(self, term: Term, chosen: Choice) -> bool:
        return term.startswith("_:") and term not in chosen and not self._is_expression(term)

    def _is_expression(self, term: Term) -> bool:
        if self._reader is None or not term.startswith("_:"):
            return False
        try:
            self._reader.expression(term)
        except Unreadable:
            return False
        return True

    def _choices(self, wanted: Triple, chosen: Choice) -> Iterator[Choice]:
        s, p, o = (None if self._is_open(term, chosen) else chosen.get(term, term) for term in wanted)
        if s is not None and p is not None and o is not None:
            if self._holds((s, p, o)):
                yield chosen
            return
        found = False
        for triple in self._candidates(s, p, o):
            found = True
            extended = dict(chosen)
            pairs = zip(wanted, triple, strict=True)
            if all(
                extended.setdefault(node, term) == term for node, term in pairs if self._is_open(node, chosen)
            ):
                yield extended
        if not found and self._prover is not None and (s is None) != (o is None) and p is not None:
            yield from self._guesses(wanted, chosen)

    def _candidates(self, s: Term | None, p: Term | None, o: Term | None) -> Iterator[Triple]:
        """Return the triples of a pattern. They are copied because proofs change the reasoner."""
        both = chain(self._reasoner.asserted(s, p, o), self._reasoner.inferred(s, p, o))
        return iter(list(both) if self._prover is None else list(islice(both, _CANDIDATES)))

    def _guesses(self, wanted: Triple, chosen: Choice) -> Iterator[Choice]:
        """Try every individual for the only open node."""
        s, p, o = (chosen.get(term, term) for term in wanted)
        node = s if self._is_open(s, chosen) else o
        for term in list(islice(self._individuals(), _CANDIDATES)):
            triple = (term, p, o) if node == s else (s, p, term)
            if self._holds(triple):
                yield {**chosen, node: term}

    def _individuals(self) -> Iterator[Term]:
        return iter(dict.fromkeys(s for s, _, _ in self._reasoner.asserted() if is_named(s)))

    def _holds(self, triple: Triple) -> bool:
        s, p, o = triple
        if self._prover is None:
            return self._reasoner.holds(triple)
        if is_literal(s):
            return self._reasoner.holds(triple)
        if p == TYPE and self._reader is not None and self._is_expression(o):
            return self._prover.member(s, self._reader.expression(o))
        return self._prover.fact(triple)


_MEMBERS = frozenset(
    iris(
        "owl:members owl:distinctMembers owl:sourceIndividual owl:assertionProperty owl:targetIndividual "
        "owl:targetValue"
    )
)
