"""What follows from the asserted triples, kept beside them commit by commit.

A reasoner of its own follows the commits. Those that a commit speaks of are not all whom it must be asked
about anew: what is new about one may concern its neighbours. So the search goes on from whoever has changed,
as far as changes reach:

- a relation that came or went concerns the other end (inverses), and, if chains or transitive properties take
  it further, whoever is related to this end by such properties, in as many steps as the longest chain has;
- a class or an equality that came or went concerns all neighbours (keys, limits, values, copies).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import chain

from semmap.nodes.kb_node.derived_facts import UNCHANGED, DerivedChanges
from semmap.nodes.kb_node.reasoner import Reasoner
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
    """What follows about an individual, or about all and about classes and properties by their names.

    Literals are as the dataset stores them. ReaderExited out is what RDF has no place for (literals as subjects),
    classes without a name, and that everything is the same as itself.
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
    """What follows in a dataset, exact after each commit; what is computed is among it."""

    def __init__(
        self, asserted: Iterable[Triple], dataset: Dataset, derived_changes: DerivedChanges = UNCHANGED
    ) -> None:
        """Put into `dataset` what follows from what is asserted and computed, and not set aside."""
        self._dataset = dataset
        aside = set(derived_changes.aside)
        self._reasoner = Reasoner(t for t in asserted if t not in aside)
        self._reasoner.believe(come=derived_changes.come, aside=derived_changes.aside)
        dataset.deny(derived_changes.aside)
        self._read_schema()
        dataset.infer(inferred(self._reasoner))

    def _read_schema(self) -> None:
        chains = list(_chains(self._reasoner))
        self._onward = frozenset(property for chain in chains for property in chain)
        self._steps = max(map(len, chains), default=1) - 1

    def after(self, delta: Delta, derived_changes: DerivedChanges = UNCHANGED) -> Delta:
        """`delta`, which is about what is asserted, with what it changes of what follows; no more is done.

        `derived_changes` is what it changes besides.
        """
        was_compiled = self._reasoner.is_compiled
        less = self._reasoner.believe(
            gone=derived_changes.gone, aside=derived_changes.aside, tell_implied=True
        )
        touched = self._reasoner.apply(delete=delta.retracted, insert=delta.inserted).touched
        more = self._reasoner.believe(come=derived_changes.come, back=derived_changes.back, tell_implied=True)
        if not (was_compiled and self._reasoner.is_compiled) or any(map(is_schema, delta.asserted)):
            gone, new = self._all_changes()
        elif less.implied is None or more.implied is None:
            touched |= less.touched | more.touched
            gone, new = self._changes((*delta.asserted, *chain(*derived_changes)), touched)
        else:
            gone, new = self._changes(delta.asserted, touched)
            for triple in less.implied | more.implied:
                self._compare(triple, gone, new)
            for term in less.touched | more.touched:
                self._compare_classes(term, gone, new)
        return Delta(
            seq=delta.seq,
            retracted=delta.retracted,
            inserted=delta.inserted,
            no_longer_inferred=tuple(sorted(gone)),
            newly_inferred=tuple(sorted(new)),
            denied=derived_changes.aside,
            undenied=derived_changes.back,
        )

    def _compare(self, triple: Triple, gone: set[Triple], new: set[Triple]) -> None:
        """Add a relation to what follows no longer, or newly."""
        was, does = self._dataset.follows(triple), self._reasoner.follows(triple)
        if was != does:
            (new if does else gone).add(triple)

    def _compare_classes(self, term: Term, gone: set[Triple], new: set[Triple]) -> None:
        before = {t for t in self._dataset.inferred(term) if t[1] == v.RDF_TYPE}
        now = set(self._reasoner.inferred(term, v.RDF_TYPE, None))
        gone |= before - now
        new |= now - before

    def _all_changes(self) -> tuple[set[Triple], set[Triple]]:
        """The same for a commit that changes the schema, or a map that uses its vocabulary freely."""
        self._read_schema()
        before, now = self._dataset.inferred(None), set(inferred(self._reasoner))
        return before - now, now - before

    def _changes(
        self, otherwise: Iterable[Triple], touched: Iterable[Term]
    ) -> tuple[set[Triple], set[Triple]]:
        """What follows no longer, and what follows newly, when these triples came or went."""
        gone, new = set[Triple](), set[Triple]()
        said: dict[Term, list[Triple]] = {}
        for triple in otherwise:
            said.setdefault(triple[0], []).append(triple)
        waiting = {o for triples in said.values() for _, p, o in triples if p != v.RDF_TYPE}
        waiting.update(touched, said)
        seen = set[Term]()
        while waiting:
            subject = waiting.pop()
            if subject in seen or subject.startswith('"'):
                continue
            seen.add(subject)
            before = {t for t in self._dataset.inferred(subject) if t[1] not in _OF_THE_SCHEMA}
            now = set(inferred(self._reasoner, subject))
            gone |= before - now
            new |= now - before
            waiting |= self._concerned(subject, {*(before ^ now), *said.get(subject, ())}) - seen
        return gone, new

    def _concerned(self, subject: Term, changed: set[Triple]) -> set[Term]:
        """Whom it may concern that these triples about `subject` came or went."""
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
        """Whose relations a chain that goes on from this individual may add to."""
        found = edge = {individual}
        for _ in range(self._steps):
            edge = {n for member in edge for n in self._neighbours(member)} - found
            found = found | edge
        return found

    def _neighbours(self, individual: Term) -> set[Term]:
        """Whom it is or was related to, either way; the values of its properties are none of them."""
        if individual.startswith('"'):
            return set()
        found = {o for _, p, o in self._about(individual, None) if p != v.RDF_TYPE and not o.startswith('"')}
        found.update(s for s, p, _ in self._about(None, individual) if p != v.RDF_TYPE)
        return found | self._dataset.neighbours(individual)

    def _about(self, s: Term | None, o: Term | None) -> Iterator[Triple]:
        yield from self._reasoner.asserted(s, None, o)
        yield from self._reasoner.inferred(s, None, o)


def _chains(reasoner: Reasoner) -> Iterator[list[Term]]:
    """The chains of properties that make others; a transitive property is a chain of itself twice."""
    for source in (reasoner.asserted, reasoner.inferred):
        yield from ([p, p] for p, _, _ in source(None, v.RDF_TYPE, _TRANSITIVE))
    for _, _, cell in reasoner.asserted(None, _CHAIN, None):
        chain: list[Term] = []
        while firsts := [o for _, _, o in reasoner.asserted(cell, _FIRST, None)]:
            chain += firsts
            cell = next(o for _, _, o in reasoner.asserted(cell, _REST, None))
        yield chain
