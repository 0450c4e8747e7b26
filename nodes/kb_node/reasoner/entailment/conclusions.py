"""Whether a graph of facts and axioms follows; its blank nodes stand for something that there is."""

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
"""Predicates that say of a class with a name what it is."""
_STATED_BY = {
    iri("owl:AllDifferent"): "different",
    iri("owl:AllDisjointClasses"): "classes",
    iri("owl:AllDisjointProperties"): "properties",
    iri("owl:NegativePropertyAssertion"): "never",
}
"""Axioms that have a node of their own."""
_CANDIDATES = 200
"""Individuals tried for a blank node."""

Choice = dict[Term, Term]
"""What blank nodes stand for."""


def entails(reasoner: Reasoner, graph: Iterable[Triple], effort: Effort | None = None) -> bool:
    """Whether all of a graph follows from what a reasoner holds; False when no proof is found.

    Tried are, in this order: to find the graph in what the rules derive; to prove its facts and axioms one by
    one; the same with names for what must exist. The reasoner is the same before and after. An `effort`
    bounds the search, and may trace it: then the first way, which leaves no trace, is left out.
    """
    graph = [(_rename_blank_node(s), p, _rename_blank_node(o)) for s, p, o in dict.fromkeys(graph)]
    is_traced = effort is not None and effort.is_traced
    if not is_traced and _Search(reasoner, graph).matches(graph):
        return True
    stated = _GoalGraph(reasoner, graph, effort)
    try:
        if stated.follows():
            return True
        if (
            effort is not None and not effort.allow_recompute
        ):  # names for all that must exist are too many to try
            return False
        return stated.prover.with_witnesses(stated.individuals(), stated.follows)
    except Unreadable:
        return False


def _rename_blank_node(term: Term) -> Term:
    """A blank node's label is its graph's own: the same one in the reasoner is another node's."""
    return f"_:wanted.{term[2:]}" if term.startswith("_:") else term


def contradictory(reasoner: Reasoner) -> bool:
    """Whether names for what must exist show a contradiction in a graph in which the rules find none."""
    return Prover(reasoner).with_witnesses((), lambda: False)


class _GoalGraph:
    """A graph read as axioms and facts."""

    def __init__(self, reasoner: Reasoner, graph: Sequence[Triple], effort: Effort | None) -> None:
        self.prover = Prover(reasoner, effort)
        self._facts = Facts(dict.fromkeys(graph))
        self._reader = Reader(self._facts.match)
        self._axioms = AxiomProver(self.prover, self._reader)
        self._search = _Search(reasoner, graph, self.prover, self._reader)
        self._reasoner = reasoner

    def follows(self) -> bool:
        """Whether all of it is proved. Raises Unreadable."""
        for s, p, _ in self._facts.facts:
            if p in _PARTS and not is_named(s):
                self._reader.expression(s)  # what cannot be read must not pass for something that there is
        search: list[Triple] = []
        says_more = any(not self._is_declaration(triple) for triple in self._facts.facts)
        for triple in self._facts.facts:
            if self._is_part(triple) or (
                self._is_declaration(triple) and self._is_declared(triple, says_more)
            ):
                continue
            proved = self._axiom(triple)
            if proved is False:
                return False
            if proved is None:
                search.append(triple)
        return self._search.matches(search)

    def individuals(self) -> list[Term]:
        """The named individuals that the graph speaks of."""
        facts = [triple for triple in self._facts.facts if not is_schema(triple)]
        terms = dict.fromkeys(term for s, p, o in facts for term in ((s,) if p == TYPE else (s, o)))
        return [term for term in terms if is_named(term)]

    def _is_declaration(self, triple: Triple) -> bool:
        return triple[1] == TYPE and triple[2] in _DECLARED

    def _is_declared(self, triple: Triple, says_more: bool) -> bool:
        """A declaration says nothing (Direct Semantics); by itself, without axioms, it must be true."""
        s, _, o = triple
        if o == iri("owl:Ontology") or (self._is_structure(s) and self._is_used(s)):
            return True
        return says_more or self._reasoner.holds(triple) or self._axioms.is_used_as(s, o)

    def _is_part(self, triple: Triple) -> bool:
        """Whether a triple is told with the axiom or expression that it is a part of."""
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
        """Whether an expression is a part of anything; that such a class exists is another claim."""
        if next(iter(self._facts.match(None, None, node)), None) is not None:
            return True
        return any(
            p not in _PARTS and (p != TYPE or o not in _DECLARED) for _, p, o in self._facts.match(node)
        )

    def _is_structure(self, node: Term) -> bool:
        """Whether a blank node is an expression, a list or an axiom, not an individual."""
        if is_named(node) or is_literal(node):
            return False
        predicates = {p for _, p, _ in self._facts.match(node)}
        if predicates & (_PARTS | {FIRST, REST, iri("owl:inverseOf")}):
            return True
        return any(self._has(node, TYPE, kind) for kind in _STATED_BY)

    def _has(self, s: Term, p: Term, o: Term) -> bool:
        return (s, p, o) in self._facts.facts

    def _axiom(self, triple: Triple) -> bool | None:
        """Whether an axiom is proved; None if the triple is none. Raises Unreadable."""
        s, p, o = triple
        axioms = self._axioms
        if p == TYPE and o in _STATED_BY and not is_named(s):
            return self._stated(s, _STATED_BY[o])
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

    def _stated(self, node: Term, kind: str) -> bool:
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
    """Looks for what the blank nodes of a graph may stand for."""

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
        """Whether all of some triples hold for one choice."""
        return self._from({}, list(wanted))

    def _from(self, chosen: Choice, wanted: list[Triple]) -> bool:
        """The triples with the fewest blank nodes still open come first."""
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
            pairs = ((word, term) for word, term in zip(wanted, triple, strict=True))
            if all(
                extended.setdefault(word, term) == term for word, term in pairs if self._is_open(word, chosen)
            ):
                yield extended
        if not found and self._prover is not None and (s is None) != (o is None) and p is not None:
            yield from self._guesses(wanted, chosen)

    def _candidates(self, s: Term | None, p: Term | None, o: Term | None) -> Iterator[Triple]:
        """Triples of a pattern by the rules; as a list, because proofs change the reasoner meanwhile."""
        both = chain(self._reasoner.asserted(s, p, o), self._reasoner.inferred(s, p, o))
        return iter(list(both) if self._prover is None else list(islice(both, _CANDIDATES)))

    def _guesses(self, wanted: Triple, chosen: Choice) -> Iterator[Choice]:
        """Every individual in the place of the one open node, each to be proved."""
        s, p, o = (chosen.get(term, term) for term in wanted)
        word = s if self._is_open(s, chosen) else o
        for term in list(islice(self._individuals(), _CANDIDATES)):
            triple = (term, p, o) if word == s else (s, p, term)
            if self._holds(triple):
                yield {**chosen, word: term}

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
