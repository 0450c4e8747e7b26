"""What follows from the asserted triples, kept beside them commit by commit.

A reasoner of its own follows the commits. Those that a commit speaks of are not all whom it must be asked
about anew: what is new about one may concern its neighbours. So the search goes on from whoever has changed,
as far as changes reach:

- a relation that came or went concerns the other end (inverses), and, if chains or transitive properties take
  it further, whoever is related to this end by such properties, in as many steps as the longest chain has;
- a class or an equality that came or went concerns all neighbours (keys, limits, values, copies).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Final

from nodes.kb_node.reasoner import Inconsistent, Reasoner
from nodes.kb_node.reasoner.tbox.split import is_schema
from nodes.kb_node.relations.placed import Placed
from nodes.kb_node.relations.rules import COMPUTED
from nodes.kb_node.sparql.triples.computed import Computed, Step
from nodes.kb_node.sparql.triples.dataset import Dataset, Delta, as_stored
from ontology import vocabulary as v
from schemas.explanations import Term, Triple

MANY: Final = 5000
"""Computed facts: of more, those that were withheld are tried again only when something newly contradicts."""
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

    Literals are as the dataset stores them. Left out is what RDF has no place for (literals as subjects),
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
    """What follows in a dataset, exact after each commit.

    Computed facts are asserted to the reasoner, unless they contradict the rest: then they are withheld; and
    what they deny of what is asserted is not.
    """

    def __init__(self, asserted: Iterable[Triple], dataset: Dataset, placed: Iterable[Placed] = ()) -> None:
        """Put into `dataset` what follows from `asserted`, which is consistent, and from where things are."""
        self._dataset = dataset
        asserted = dict.fromkeys(asserted)
        self._computed = Computed(_declared(asserted))
        self._held: dict[Term, set[Triple]] = {}
        """The computed facts that the reasoner has, by their subjects."""
        self._withheld: set[Triple] = set()
        step = self._computed.after(placed, (), (), asserted)
        self._reasoner = Reasoner(t for t in asserted if t not in step.denied)
        self._accept(sorted(step.come))
        dataset.deny(step.denied)
        self._read_schema()
        dataset.infer(self._inferred())

    def _inferred(self, subject: Term | None = None) -> Iterator[Triple]:
        """What follows or is computed about an individual or all, and is not asserted."""
        yield from inferred(self._reasoner, subject)
        for held in self._held.values() if subject is None else (self._held.get(subject, ()),):
            yield from (triple for triple in held if not self._computed.is_believed(triple))

    def _read_schema(self) -> None:
        chains = list(_chains(self._reasoner))
        self._onward = frozenset(property for chain in chains for property in chain)
        self._steps = max(map(len, chains), default=1) - 1

    def after(self, delta: Delta, changed: Iterable[Placed] = (), removed: Iterable[str] = ()) -> Delta:
        """`delta`, which is about what is asserted, with what it changes of what follows; no more is done.

        `changed` are the entities that it changes, `removed` the names of those that it removes.
        """
        was_compiled = self._reasoner.is_compiled
        step = self._computed.after(changed, removed, delta.retracted, delta.inserted)
        touched, otherwise = self._believe(delta, step)
        if was_compiled and self._reasoner.is_compiled and not any(map(is_schema, delta.asserted)):
            gone, new = self._changes((*delta.asserted, *otherwise), touched)
        else:
            gone, new = self._all_changes()
        return Delta(
            seq=delta.seq,
            retracted=delta.retracted,
            inserted=delta.inserted,
            no_longer_inferred=tuple(sorted(gone)),
            newly_inferred=tuple(sorted(new)),
            denied=tuple(sorted(step.denied)),
            undenied=tuple(sorted(step.undenied)),
        )

    def _believe(self, delta: Delta, step: Step) -> tuple[set[Term], set[Triple]]:
        """Let the reasoner have what is asserted and not denied, and what is computed; whom that touched.

        Also which triples it has otherwise than before. While nothing is withheld, that is one change. What
        is withheld, and what newly contradicts, is found by taking in all computed facts anew, in order.
        """
        computed = self._computed
        delete = {t for t in (*delta.retracted, *step.denied, *step.gone) if not self._stays(t)}
        insert = {t for t in (*delta.inserted, *step.undenied) if not computed.is_denied(t)}
        insert = {t for t in insert if t not in step.undenied or computed.is_believed(t)}
        self._withheld -= step.gone
        if not self._withheld or len(computed.all) > MANY:
            try:
                touched = self._reasoner.apply(delete=delete, insert=insert | step.come).touched
            except Inconsistent:
                pass
            else:
                self._hold(step.gone, step.come)
                return set(touched), delete | insert | step.come
        before = {t for held in self._held.values() for t in held}
        delete |= {t for t in before if not computed.is_believed(t)}
        found = set(self._reasoner.apply(delete=delete, insert=insert).touched)
        self._held.clear()
        self._withheld.clear()
        found |= self._accept(sorted(computed.all))
        return found, delete | insert | before | computed.all

    def _stays(self, triple: Triple) -> bool:
        """Whether it is still asserted and so, or computed."""
        return triple in self._computed.all or self._computed.is_believed(triple)

    def _accept(self, computed: Sequence[Triple]) -> set[Term]:
        """Take in what contradicts nothing, the first before the others; whom that touches."""
        if not computed:
            return set()
        try:
            touched = self._reasoner.apply(insert=computed).touched
        except Inconsistent:
            if len(computed) == 1:
                self._withheld.update(computed)
                return set()
            half = len(computed) // 2
            return self._accept(computed[:half]) | self._accept(computed[half:])
        self._hold((), computed)
        return set(touched)

    def _hold(self, gone: Iterable[Triple], come: Iterable[Triple]) -> None:
        for triple in gone:
            held = self._held.get(triple[0], set())
            held.discard(triple)
            if not held:
                self._held.pop(triple[0], None)
        for triple in come:
            self._held.setdefault(triple[0], set()).add(triple)

    def _all_changes(self) -> tuple[set[Triple], set[Triple]]:
        """The same for a commit that changes the schema, or a map that uses its vocabulary freely."""
        self._read_schema()
        before, now = self._dataset.inferred(None), set(self._inferred())
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
            now = set(self._inferred(subject))
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


def _declared(triples: Iterable[Triple]) -> frozenset[Term]:
    """The properties of where things are that a TBox has."""
    return frozenset(s for s, p, _ in triples if p == v.RDF_TYPE and s in COMPUTED)


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
