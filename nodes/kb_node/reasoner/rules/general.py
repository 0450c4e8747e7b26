"""The engine for graphs that use the vocabulary freely (OWL Full): everything is materialised in one closure.

Exact for all rules; a change costs as much as the map is large.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Set

from nodes.kb_node.reasoner.explain.proof import Prover
from nodes.kb_node.reasoner.rules.closure import Closure
from nodes.kb_node.reasoner.terms import TYPE, is_named
from schemas.explanations import Explanation, Term, Triple


class GeneralEngine:
    """A graph with its closure. Raises nothing: a clash is found in `contradiction`."""

    def __init__(self, triples: Iterable[Triple]) -> None:
        self._asserted = dict.fromkeys(triples)
        self._closure = Closure(self._asserted)

    def __len__(self) -> int:
        return len(self._asserted)

    def contradiction(self) -> Explanation | None:
        """Why the graph is inconsistent; None when it is not."""
        return None if self._closure.clash is None else Prover().prove(self._asserted, None)

    def asserted(self, s: Term | None, p: Term | None, o: Term | None) -> Iterator[Triple]:
        """The asserted triples of a pattern."""
        return (triple for triple in self._closure.match(s, p, o) if triple in self._asserted)

    def about(self, subject: Term) -> dict[Term, list[Term]]:
        """The asserted triples of a subject: predicate to objects."""
        objects: dict[Term, list[Term]] = {}
        for _, p, o in self.asserted(subject, None, None):
            objects.setdefault(p, []).append(o)
        return objects

    def mentioned(self, terms: Set[Term]) -> set[Term]:
        """Those that a triple has as its subject or object."""
        return {term for s, _, o in self.asserted(None, None, None) for term in (s, o) if term in terms}

    def inferred(self, s: Term | None, p: Term | None, o: Term | None) -> Iterator[Triple]:
        """The triples of a pattern that follow and were not asserted."""
        return (triple for triple in self._closure.match(s, p, o) if triple not in self._asserted)

    def holds(self, triple: Triple) -> bool:
        """Whether a triple is asserted or follows."""
        return self._closure.holds(triple)

    def types(self, individual: Term) -> frozenset[Term]:
        """The named classes of an individual."""
        return frozenset(o for _, _, o in self._closure.match(individual, TYPE) if is_named(o))

    def instances(self, cls: Term) -> Iterator[Term]:
        """The individuals of a class."""
        return (s for s, _, _ in self._closure.match(None, TYPE, cls))

    def explain(self, triple: Triple) -> Explanation:
        """Why a triple follows that holds."""
        return Prover().prove(self._closure.leaves(triple), triple)
