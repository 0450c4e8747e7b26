"""Inferred triples, kept up to date with the asserted ones commit by commit.

A separate reasoner follows the commits. A commit may change what follows about more individuals than it
mentions, so the search continues from each individual that has changed:

- A changed relation concerns the other end (inverses). If chains or transitive properties extend it, it also
  concerns the individuals related to this end, in as many steps as the longest chain has.
- A changed class or equality concerns all neighbours (keys, cardinalities, values, equal individuals).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import chain

from semmap.nodes.kb_node.derived_facts import UNCHANGED, DerivedChanges
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.reasoner.rules.facts import Facts
from semmap.nodes.kb_node.reasoner.tbox.split import is_schema
from semmap.nodes.kb_node.sparql.triples.dataset import Dataset, Delta, as_stored
from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term, Triple

_OF_THE_SCHEMA = tuple(
    v.iri(name)
    for name in (
        v.RDFS + "subClassOf", v.RDFS + "subPropertyOf", v.RDFS + "domain", v.RDFS + "range",
        v.OWL + "equivalentClass", v.OWL + "equivalentProperty", v.OWL + "disjointWith", v.OWL + "inverseOf",
    )
)  # fmt: skip
_CHAIN = v.iri(v.OWL + "propertyChainAxiom")
_TRANSITIVE = v.iri(v.OWL + "TransitiveProperty")
_FIRST, _REST = v.iri(v.RDF + "first"), v.iri(v.RDF + "rest")


def inferred(reasoner: Reasoner, subject: Term | None = None) -> Iterator[Triple]:
    """Yield the inferred triples about an individual, or about all individuals, named classes and properties.

    Literals are as the dataset stores them. Left out are literals as subjects, which RDF does not allow,
    unnamed classes, and that everything is the same as itself.
    """
    if subject is None:
        for predicate in _OF_THE_SCHEMA:
            for s, p, o in reasoner.inferred(None, predicate, None):
                if s.startswith("<") and o.startswith("<"):
                    yield (s, p, o)
    for s, p, o in reasoner.inferred(subject, None, None):
        if (
            not s.startswith('"')
            and not (p == v.RDF_TYPE and o.startswith("_:"))
            and not (p == v.OWL_SAME_AS and s == o)
            and p not in _OF_THE_SCHEMA
        ):
            yield (s, p, as_stored(o))


class Consequences:
    """The inferred triples of a dataset, exact after each commit. They include computed facts."""

    def __init__(
        self,
        asserted: Iterable[Triple],
        dataset: Dataset,
        derived_changes: DerivedChanges = UNCHANGED,
        closed: Facts | None = None,
    ) -> None:
        """Add to `dataset` what follows from the asserted and computed facts that are not suppressed.

        `closed` is the closure of the TBox, if it is known.
        """
        self._dataset = dataset
        suppressed = set(derived_changes.aside)
        self._reasoner = Reasoner((t for t in asserted if t not in suppressed), closed=closed)
        self._reasoner.update_computed(add=derived_changes.come, suppress=derived_changes.aside)
        dataset.deny(derived_changes.aside)
        self._read_schema()
        dataset.infer(inferred(self._reasoner))

    def _read_schema(self) -> None:
        chains = list(_chains(self._reasoner))
        self._onward = frozenset(property for chain in chains for property in chain)
        self._steps = max(map(len, chains), default=1) - 1

    def after(self, delta: Delta, derived_changes: DerivedChanges = UNCHANGED) -> Delta:
        """Return `delta` with the changes of inferred triples; the dataset is not changed.

        `derived_changes` are the changes of computed and suppressed facts.
        """
        was_compiled = self._reasoner.is_compiled
        removal = self._reasoner.update_computed(
            remove=derived_changes.gone, suppress=derived_changes.aside, report_implied=True
        )
        touched = self._reasoner.apply(delete=delta.retracted, insert=delta.inserted).touched
        addition = self._reasoner.update_computed(
            add=derived_changes.come, restore=derived_changes.back, report_implied=True
        )
        if not (was_compiled and self._reasoner.is_compiled) or any(map(is_schema, delta.asserted)):
            removed, new = self._all_changes()
        elif removal.implied is None or addition.implied is None:
            touched |= removal.touched | addition.touched
            removed, new = self._changes((*delta.asserted, *chain(*derived_changes)), touched)
        else:
            removed, new = self._changes(delta.asserted, touched)
            for triple in removal.implied | addition.implied:
                self._compare(triple, removed, new)
            for term in removal.touched | addition.touched:
                self._compare_classes(term, removed, new)
        return Delta(
            seq=delta.seq,
            retracted=delta.retracted,
            inserted=delta.inserted,
            no_longer_inferred=tuple(sorted(removed)),
            newly_inferred=tuple(sorted(new)),
            denied=derived_changes.aside,
            undenied=derived_changes.back,
        )

    def _compare(self, triple: Triple, removed: set[Triple], new: set[Triple]) -> None:
        """Add a relation to the removed or the new inferred triples."""
        was, follows = self._dataset.follows(triple), self._reasoner.follows(triple)
        if was != follows:
            (new if follows else removed).add(triple)

    def _compare_classes(self, term: Term, removed: set[Triple], new: set[Triple]) -> None:
        before = {t for t in self._dataset.inferred(term) if t[1] == v.RDF_TYPE}
        now = set(self._reasoner.inferred(term, v.RDF_TYPE, None))
        removed |= before - now
        new |= now - before

    def _all_changes(self) -> tuple[set[Triple], set[Triple]]:
        """Return the changes after a change of the schema, or for a map that uses its vocabulary freely."""
        self._read_schema()
        before, now = self._dataset.inferred(None), set(inferred(self._reasoner))
        return before - now, now - before

    def _changes(
        self, otherwise: Iterable[Triple], touched: Iterable[Term]
    ) -> tuple[set[Triple], set[Triple]]:
        """Return the removed and the new inferred triples after a change of these triples."""
        removed, new = set[Triple](), set[Triple]()
        by_subject: dict[Term, list[Triple]] = {}
        for triple in otherwise:
            by_subject.setdefault(triple[0], []).append(triple)
        waiting = {o for triples in by_subject.values() for _, p, o in triples if p != v.RDF_TYPE}
        waiting.update(touched, by_subject)
        seen = set[Term]()
        while waiting:
            subject = waiting.pop()
            if subject in seen or subject.startswith('"'):
                continue
            seen.add(subject)
            before = {t for t in self._dataset.inferred(subject) if t[1] not in _OF_THE_SCHEMA}
            now = set(inferred(self._reasoner, subject))
            removed |= before - now
            new |= now - before
            waiting |= self._concerned(subject, {*(before ^ now), *by_subject.get(subject, ())}) - seen
        return removed, new

    def _concerned(self, subject: Term, changed: set[Triple]) -> set[Term]:
        """Return the individuals that a change of these triples about `subject` may concern."""
        concerned = set[Term]()
        predicates = {p for _, p, _ in changed}
        if not predicates.isdisjoint((v.RDF_TYPE, v.OWL_SAME_AS)):
            concerned |= self._neighbours(subject)
        if not predicates.isdisjoint(self._onward):
            concerned |= self._composed_with(subject)
        for _, p, o in changed:
            if p != v.RDF_TYPE:
                concerned.add(o)
            if p == v.OWL_SAME_AS:
                concerned |= self._neighbours(o)
        return concerned

    def _composed_with(self, individual: Term) -> set[Term]:
        """Return the individuals whose relations a chain through this individual may add to."""
        found = edge = {individual}
        for _ in range(self._steps):
            edge = {n for member in edge for n in self._neighbours(member)} - found
            found = found | edge
        return found

    def _neighbours(self, individual: Term) -> set[Term]:
        """Return the individuals that it is or was related to, in either direction; no literals."""
        if individual.startswith('"'):
            return set()
        found = {o for _, p, o in self._about(individual, None) if p != v.RDF_TYPE and not o.startswith('"')}
        found.update(s for s, p, _ in self._about(None, individual) if p != v.RDF_TYPE)
        return found | self._dataset.neighbours(individual)

    def _about(self, s: Term | None, o: Term | None) -> Iterator[Triple]:
        yield from self._reasoner.asserted(s, None, o)
        yield from self._reasoner.inferred(s, None, o)


def _chains(reasoner: Reasoner) -> Iterator[list[Term]]:
    """Yield the property chains; a transitive property is a chain of itself twice."""
    for source in (reasoner.asserted, reasoner.inferred):
        yield from ([p, p] for p, _, _ in source(None, v.RDF_TYPE, _TRANSITIVE))
    for _, _, cell in reasoner.asserted(None, _CHAIN, None):
        chain: list[Term] = []
        while firsts := [o for _, _, o in reasoner.asserted(cell, _FIRST, None)]:
            chain += firsts
            cell = next(o for _, _, o in reasoner.asserted(cell, _REST, None))
        yield chain
