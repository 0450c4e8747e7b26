"""Runs of triples about new individuals: what follows is worked out once for each shape.

Two runs have one *shape* if they differ in nothing but the names of the new individuals, and in which other
individuals and literals, of the same kinds, these are related to. Where nothing follows but kinds, a run of a
known shape is written down as it will stand, without looking at any rule.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import count
from typing import NamedTuple

from nodes.kb_node.reasoner.abox import ABox
from nodes.kb_node.reasoner.adjacency import NONE
from nodes.kb_node.reasoner.kinds import Kind
from nodes.kb_node.reasoner.layout import Layout, NewEdge
from nodes.kb_node.reasoner.proof import Proof
from nodes.kb_node.reasoner.split import is_schema
from nodes.kb_node.reasoner.store import VALUE
from nodes.kb_node.reasoner.terms import TYPE
from schemas.explanations import Explanation, Term, Triple

Key = tuple[object, ...]
_LONGEST = 64
"""Triples of a run whose shape is looked at; a home's entities have about twenty."""
_MOST = 2000
"""Shapes remembered."""


class Run(NamedTuple):
    """Consecutive triples; all but the first subject were mentioned before."""

    key: Key | None
    """The shape; None where a subject is no new individual, or the run is too long."""
    triples: Sequence[Triple]
    individuals: dict[Term, int]
    """The new individuals with their places."""
    others: list[Term]
    """The other objects, triple by triple."""


@dataclass(frozen=True, eq=False, slots=True, weakref_slot=True)
class Written:
    """What a run of a known shape leaves. One object is one shape."""

    layout: Layout
    constants: tuple[Term, ...]
    """The values that come with classes; they are the last of the layout's other objects."""
    touched: tuple[int, ...]
    """The places of those that are subjects or have a named class."""

    def touched_of(self, individuals: dict[Term, int]) -> list[Term]:
        """What is touched of a run's individuals."""
        names = tuple(individuals)
        return [names[place] for place in self.touched]


class Alike(NamedTuple):
    """A run and its shape. Runs of one shape have their triples in one order, and their objects by kind."""

    shape: Written
    run: Run


class Contradiction(NamedTuple):
    """Why no run of a shape is accepted, whatever else is said."""

    proof: Proof
    places: tuple[int, ...]
    """The new individuals that stand for the terms of the proof."""

    def of(self, individuals: dict[Term, int]) -> Explanation:
        """The explanation with the names of a run."""
        names = tuple(individuals)
        return self.proof.about([names[place] for place in self.places])


class Shapes:
    """The shapes that are known. None stands for one that every run must be worked out of."""

    def __init__(self, abox: ABox) -> None:
        self._abox = abox
        self.known: dict[Key, Written | Contradiction | None] = {}

    def runs(self, triples: Sequence[Triple]) -> Iterator[Run]:
        """Cut triples into runs; each is read against the store as it is when the run is asked for."""
        store = self._abox.store
        numbers, kinds, literal = store.numbers, store.kind, self._abox.kinds.literal
        start, is_plain = 0, True
        places: dict[Term, int] = {}
        others: list[Term] = []
        key: list[object] = []
        append = key.append
        for at, (s, p, o) in enumerate(triples):
            subject = places.get(s)
            if subject is None:
                if at > start:
                    yield Run(tuple(key) if is_plain else None, triples[start:at], places, others)
                    start, is_plain, places, others, key = at, True, {}, [], []
                    append = key.append
                subject = places[s] = 0
                if s in numbers:
                    is_plain = False
            append(subject)
            append(p)
            if p == TYPE:
                append(o)
                continue
            node = numbers.get(o)
            if node is not None:
                append(kinds[node])
                others.append(o)
            elif o[0] == '"':
                append(literal(o))
                others.append(o)
            else:
                place = places.get(o)
                if place is None:
                    place = places[o] = len(places)
                append(place)
            if at - start == _LONGEST:
                is_plain = False
        if triples:
            yield Run(tuple(key) if is_plain else None, triples[start:], places, others)

    def write(self, written: Written, run: Run) -> bool:
        """Write down what a run of a known shape leaves; False, and nothing done, if it cannot be."""
        store, others = self._abox.store, run.others
        if written.constants:
            kinds = written.layout.others[len(others) :]
            for term, kind in zip(written.constants, kinds, strict=True):
                node = store.find(term)
                if node is None or store.kind[node] is not kind:
                    return False
            others = [*others, *written.constants]
        store.write(written.layout, run.individuals, others)
        return True

    def learn(self, run: Run) -> None:
        """Remember the shape of a run that was just worked out."""
        if run.key is not None:
            self._remember(run.key, self._written(run))

    def refuse(self, triples: Sequence[Triple], proof: Proof, terms: Sequence[Term]) -> None:
        """Remember the shape of triples that were refused, if `proof` about `terms` is of nothing else."""
        first = next(self.runs(triples))
        if first.key is None or len(first.triples) < len(triples):
            return
        there, places = set(triples), first.individuals
        support = [fact for fact in proof.about(terms).support if not is_schema(fact)]
        is_of_itself = all(fact in there and (fact[1] == TYPE or fact[2] in places) for fact in support)
        named = tuple([places.get(term, 0) for term in terms])  # any other term is not in the proof itself
        self._remember(first.key, Contradiction(proof, named) if is_of_itself else None)

    def _remember(self, key: Key, found: Written | Contradiction | None) -> None:
        if len(self.known) >= _MOST:
            self.known.clear()
        self.known[key] = found

    def _written(self, run: Run) -> Written | None:
        """What stands in the store of a run that was just worked out; None if it is more than kinds."""
        abox, store = self._abox, self._abox.store
        places = run.individuals
        individuals = [store.numbers[term] for term in places]
        others = [store.numbers[term] for term in run.others]
        before = [kind for kind in run.key or () if isinstance(kind, Kind)]
        if before != [store.kind[node] for node in others] or len(set(run.triples)) < len(run.triples):
            return None
        values = [e for node in individuals for e in store.out.all(node) if store.source[e] == VALUE]
        constants = [store.terms[store.object[edge]] for edge in values]
        others += [store.object[edge] for edge in values]
        place = count(len(places))
        edges = {
            self._edge(t): places[t[2]] if t[2] in places else next(place)
            for t in run.triples
            if t[1] != TYPE
        }
        edges |= {edge: next(place) for edge in values}
        if any(edge not in edges for node in individuals for edge in store.out.all(node)):
            return None
        if not all(map(abox.is_plain, edges)) or not abox.equals.keys().isdisjoint(individuals):
            return None
        known = [e for e, to in edges.items() if to >= len(places)]
        said = [(store.subject[e], store.predicate[e]) for e in known if store.source[e] != VALUE]
        come = {(store.subject[e], store.predicate[e]) for e in values}
        if len(set(said)) < len(said) or not come.isdisjoint(said):
            return None  # another run may have one object twice where this one has two of a kind
        return Written(
            Layout(
                kinds=tuple([store.kind[node] for node in individuals]),
                others=tuple([store.kind[node] for node in others]),
                edges=tuple([self._new_edge(edge, edges, individuals) for edge in edges]),
                heads=tuple([_index(store.out.heads[node], edges) for node in individuals]),
            ),
            tuple(constants),
            tuple(self._touched(run)),
        )

    def _edge(self, triple: Triple) -> int:
        store, predicate = self._abox.store, self._abox.schema.property(triple[1])
        return store.edge(store.numbers[triple[0]], predicate, store.numbers[triple[2]])

    def _new_edge(self, edge: int, edges: dict[int, int], individuals: list[int]) -> NewEdge:
        store, out = self._abox.store, self._abox.store.out
        subject = individuals.index(store.subject[edge])
        links = (out.after[edge], out.before[edge], out.group[edge])
        places = [_index(other, edges) for other in links]
        return NewEdge(subject, store.predicate[edge], edges[edge], store.source[edge], *places)

    def _touched(self, run: Run) -> Iterator[int]:
        store, subjects = self._abox.store, {s for s, _, _ in run.triples}
        for term, place in run.individuals.items():
            if term in subjects or store.kind[store.numbers[term]].names:
                yield place


def _index(edge: int, edges: dict[int, int]) -> int:
    return NONE if edge == NONE else list(edges).index(edge)
