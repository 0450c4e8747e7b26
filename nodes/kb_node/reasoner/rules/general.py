"""The engine for OWL Full graphs: one closure in which everything is materialised.

It applies all rules exactly. The cost of a change is proportional to the size of the map.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Set
from functools import cached_property

from semmap.nodes.kb_node.reasoner import datatypes
from semmap.nodes.kb_node.reasoner.explain.proof import Prover
from semmap.nodes.kb_node.reasoner.explain.words import Words
from semmap.nodes.kb_node.reasoner.explanations import Explanation, Term, Triple
from semmap.nodes.kb_node.reasoner.rules import swrl
from semmap.nodes.kb_node.reasoner.rules.closure import Closure
from semmap.nodes.kb_node.reasoner.rules.time_limit import TimeLimit
from semmap.nodes.kb_node.reasoner.tbox.split import is_schema
from semmap.nodes.kb_node.reasoner.terms import SAME_AS, TYPE, is_literal, is_named


class GeneralEngine:
    """A graph with its closure. It does not raise on inconsistency: `contradiction` returns the proof."""

    def __init__(self, triples: Iterable[Triple], reason: str = "", computed: Iterable[Triple] = ()) -> None:
        """Close a graph. `reason` states why it cannot be compiled. `computed` facts are not asserted."""
        self.reason = reason
        self._asserted = dict.fromkeys(triples)
        self._computed = dict.fromkeys(triple for triple in computed if triple not in self._asserted)
        self._closure = Closure({**self._asserted, **self._computed})

    @cached_property
    def words(self) -> Words:
        """The words for terms in sentences."""
        return Words.of(self._asserted)

    def __len__(self) -> int:
        return len(self._asserted)

    def contradiction(self) -> Explanation | None:
        """Return the proof that the graph is inconsistent; None if it is consistent."""
        return (
            None
            if self._closure.clash is None
            else Prover(self.words).prove((*self._asserted, *self._computed), None)
        )

    @cached_property
    def rules(self) -> swrl.Rules:
        """The SWRL rules of the graph."""
        return swrl.read_triples(self._asserted)

    def matches(self, rule: swrl.SwrlRule, limit: TimeLimit) -> Iterator[tuple[Term, ...]]:
        """Yield the matches of a SWRL rule, also for each of equal individuals. Raises OutOfTime."""
        return self._closure.matches(rule, limit)

    def asserted(self, s: Term | None, p: Term | None, o: Term | None) -> Iterator[Triple]:
        """Return the asserted triples that match a pattern."""
        return (triple for triple in self._closure.match(s, p, o) if triple in self._asserted)

    def computed(self, s: Term | None, p: Term | None, o: Term | None) -> Iterator[Triple]:
        """Return the computed triples that match a pattern."""
        return (
            triple
            for triple in self._computed
            if all(wanted in (None, term) for wanted, term in zip((s, p, o), triple, strict=True))
        )

    def is_computed(self, triple: Triple) -> bool:
        """Return whether a triple is computed and not asserted."""
        return triple in self._computed

    def equals(self, individual: Term) -> Collection[Term]:
        """Return the individuals that are the same as one, itself included; none if it is only itself."""
        same = {o for _, _, o in self._closure.match(individual, SAME_AS, None)}
        return same | {individual} if same - {individual} else ()

    def about(self, subject: Term) -> dict[Term, list[Term]]:
        """Return the asserted triples of a subject: predicate to objects."""
        objects: dict[Term, list[Term]] = {}
        for _, p, o in self.asserted(subject, None, None):
            objects.setdefault(p, []).append(o)
        return objects

    def mentioned(self, terms: Set[Term]) -> set[Term]:
        """Return those of `terms` that are the subject or object of a triple."""
        return {term for s, _, o in self.asserted(None, None, None) for term in (s, o) if term in terms}

    def inferred(self, s: Term | None, p: Term | None, o: Term | None) -> Iterator[Triple]:
        """Return the inferred triples of a pattern that are not asserted (see `Reasoner.inferred`)."""
        wants_schema = p is not None and (p != TYPE or (o is not None and is_schema((o, p, o))))
        given: set[Triple] = set()
        for triple in self._closure.match(s, p, None if o is not None and is_literal(o) else o):
            subject, predicate, object_ = triple
            if triple in self._asserted or is_literal(subject) or not is_named(predicate):
                continue
            if is_schema(triple):
                if wants_schema:
                    yield triple
            elif is_literal(object_):
                spelled = (subject, predicate, datatypes.canonical(object_))
                if spelled not in given and o in (None, spelled[2]) and not self._is_asserted(spelled):
                    given.add(spelled)
                    yield spelled
            elif predicate != TYPE or is_named(object_):
                yield triple

    def _is_asserted(self, triple: Triple) -> bool:
        """Return whether a value, given in its canonical spelling, is asserted in any spelling."""
        s, p, value = triple
        return any(datatypes.canonical(o) == value for _, _, o in self.asserted(s, p, None))

    def holds(self, triple: Triple) -> bool:
        """Return whether a triple is asserted or inferred."""
        return self._fact(triple) is not None

    def _fact(self, triple: Triple) -> Triple | None:
        """Return the fact that a triple states, in any spelling of its value; None if it does not hold."""
        if self._closure.holds(triple):
            return triple
        s, p, o = triple
        if not is_literal(o):
            return None
        wanted = datatypes.canonical(o)
        return next(
            (fact for fact in self._closure.match(s, p) if datatypes.canonical(fact[2]) == wanted), None
        )

    def types(self, individual: Term) -> frozenset[Term]:
        """Return the named classes of an individual."""
        facts = self._closure.match(individual, TYPE)
        return frozenset(fact[2] for fact in facts if is_named(fact[2]) and not is_schema(fact))

    def instances(self, cls: Term) -> Iterator[Term]:
        """Return the individuals of a class."""
        facts = self._closure.match(None, TYPE, cls)
        return (fact[0] for fact in facts if not is_literal(fact[0]) and not is_schema(fact))

    def explain(self, triple: Triple) -> Explanation:
        """Return the proof of a triple that holds."""
        return Prover(self.words).prove(self._closure.leaves(self._fact(triple)), triple)
