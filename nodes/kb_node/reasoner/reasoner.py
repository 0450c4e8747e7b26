"""The reasoner as the rest of the knowledge base sees it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import islice
from typing import NamedTuple

from nodes.kb_node.reasoner.closure import Closure
from nodes.kb_node.reasoner.proof import prove
from nodes.kb_node.reasoner.terms import FIRST, REST, TYPE, iri, is_literal
from schemas.explanations import Explanation, Term, Triple

_SUB_CLASS_OF = iri("rdfs:subClassOf")


class Inconsistent(Exception):
    """A change that the ontology contradicts; it was undone."""

    def __init__(self, explanation: Explanation) -> None:
        super().__init__(explanation.text)
        self.explanation = explanation


class Change(NamedTuple):
    """What a transaction did: the individuals whose asserted triples or inferred named classes changed."""

    touched: frozenset[Term]


class Reasoner:
    """A TBox and an ABox that are consistent, and what follows from them."""

    def __init__(self, tbox: Iterable[Triple] = ()) -> None:
        """Start with a TBox. Raises Inconsistent when it contradicts itself."""
        self._asserted: dict[Triple, None] = {}
        self._closure = Closure()
        self.apply(insert=tbox)

    def __len__(self) -> int:
        """How many triples are asserted, TBox included."""
        return len(self._asserted)

    def apply(self, *, delete: Iterable[Triple] = (), insert: Iterable[Triple] = ()) -> Change:
        """One transaction: deletes, then inserts, then checks.

        Deleting what is not there and inserting what is there changes nothing.

        Raises:
            Inconsistent: everything is as it was before.
        """
        removed = [triple for triple in dict.fromkeys(delete) if triple in self._asserted]
        asserted = self._asserted.copy()
        for triple in removed:
            del asserted[triple]
        added = [triple for triple in dict.fromkeys(insert) if triple not in asserted]
        asserted.update(dict.fromkeys(added))
        before = len(self._closure.facts)
        if removed or any(p in (FIRST, REST) for _, p, _ in added):
            closure, known = Closure(asserted), set(self._closure.facts)
        else:
            closure, known = self._closure, set()
            closure.insert(added)
        if closure.clash is not None:
            explanation = prove(asserted, None)
            self._closure = Closure(self._asserted)
            raise Inconsistent(explanation)
        different = known ^ set(closure.facts) if known else islice(closure.facts, before, None)
        self._closure, self._asserted = closure, asserted
        changed = {triple[0] for triple in (*removed, *added)}
        changed |= {s for s, p, _ in different if p == TYPE}
        return Change(frozenset(term for term in changed if not is_literal(term)))

    def asserted(
        self, s: Term | None = None, p: Term | None = None, o: Term | None = None
    ) -> Iterator[Triple]:
        """Asserted triples of a pattern; None is a wildcard."""
        return (triple for triple in self._closure.match(s, p, o) if triple in self._asserted)

    def inferred(
        self, s: Term | None = None, p: Term | None = None, o: Term | None = None
    ) -> Iterator[Triple]:
        """Triples of a pattern that follow and were not asserted."""
        return (triple for triple in self._closure.match(s, p, o) if triple not in self._asserted)

    def holds(self, triple: Triple) -> bool:
        """Whether a triple is asserted or follows."""
        return self._closure.holds(triple)

    def types(self, individual: Term) -> frozenset[Term]:
        """The named classes of an individual, asserted and inferred."""
        return frozenset(o for _, _, o in self._closure.match(individual, TYPE) if o[0] == "<")

    def instances(self, cls: Term) -> Iterator[Term]:
        """The individuals of a class, asserted and inferred."""
        return (s for s, _, _ in self._closure.match(None, TYPE, cls))

    def superclasses(self, cls: Term) -> frozenset[Term]:
        """The named classes that a class is a subclass of, itself included."""
        found = {o for _, _, o in self._closure.match(cls, _SUB_CLASS_OF) if o[0] == "<"}
        return frozenset(found | {cls})

    def subclasses(self, cls: Term) -> frozenset[Term]:
        """The named classes that are subclasses of a class, itself included."""
        found = {s for s, _, _ in self._closure.match(None, _SUB_CLASS_OF, cls) if s[0] == "<"}
        return frozenset(found | {cls})

    def explain(self, triple: Triple) -> Explanation | None:
        """Why a triple holds; None when it does not."""
        return prove(self._asserted, triple) if self.holds(triple) else None
