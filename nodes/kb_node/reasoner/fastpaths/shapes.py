"""The consequences of new individuals, computed once for each shape of their triples.

Two runs have the same *shape* if they have the same form, and their other objects are of the same kinds. If
the rules imply only kinds, a run of a known shape is stored directly, without applying rules.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import count, repeat
from typing import NamedTuple

from semmap.nodes.kb_node.reasoner.abox.abox import ABox
from semmap.nodes.kb_node.reasoner.abox.adjacency import NONE
from semmap.nodes.kb_node.reasoner.abox.store import VALUE
from semmap.nodes.kb_node.reasoner.explain.proof import Proof
from semmap.nodes.kb_node.reasoner.explanations import Explanation, Term, Triple
from semmap.nodes.kb_node.reasoner.fastpaths.batches import read_batches
from semmap.nodes.kb_node.reasoner.fastpaths.layout import Layout
from semmap.nodes.kb_node.reasoner.fastpaths.runs import Form, Run, Runs, Shape, Terms
from semmap.nodes.kb_node.reasoner.rules import swrl
from semmap.nodes.kb_node.reasoner.tbox.split import is_schema
from semmap.nodes.kb_node.reasoner.terms import TYPE

_MOST = 2000
"""Number of cached shapes."""
_FEW = 64
"""Number of triples below which runs are not batched."""


@dataclass(frozen=True, eq=False, slots=True, weakref_slot=True)
class KnownShape:
    """The stored form of a run of a known shape. There is one object for each shape."""

    layout: Layout
    constants: tuple[Term, ...]
    """The values implied by classes. They are the last of the layout's other objects."""
    touched: tuple[int, ...]
    """The places of individuals that are subjects or have a named class."""


class UniformRuns(NamedTuple):
    """Runs of one shape: the same order of triples, and objects of the same kinds.

    A column has the terms at one place of each run, so that many runs need few objects.
    """

    shape: KnownShape
    form: Form
    individuals: Sequence[Terms]
    others: Sequence[Terms]

    def rows(self) -> Iterator[tuple[Terms, Terms]]:
        """Yield the individuals and the other objects of each run."""
        others = zip(*self.others, strict=True) if self.others else repeat(())
        return zip(zip(*self.individuals, strict=True), others, strict=False)

    @property
    def touched(self) -> set[Term]:
        """The individuals that are subjects or have a named class."""
        return set().union(*(self.individuals[place] for place in self.shape.touched))


class Contradiction(NamedTuple):
    """The proof that every run of a shape is contradictory."""

    proof: Proof
    places: tuple[int, ...]
    """The new individuals that replace the terms of the proof."""

    def of(self, run: Run) -> Explanation:
        """Return the explanation with the names of a run."""
        return self.proof.about([run.individuals[place] for place in self.places])


class Shapes:
    """The known shapes. None marks a shape whose runs always need the rules."""

    def __init__(self, abox: ABox) -> None:
        self._abox = abox
        self._runs = Runs(abox.store, abox.kinds)
        self.known: dict[Shape, KnownShape | Contradiction | None] = {}

    def runs(self, triples: Sequence[Triple], start: int = 0, stop: int | None = None) -> Iterator[Run]:
        """Yield the runs from `start`. Each is read against the current state of the store."""
        return self._runs.of(triples, start, len(triples) if stop is None else stop)

    def write_all(self, triples: Sequence[Triple], start: int) -> tuple[list[UniformRuns], int]:
        """Store the consecutive runs of known shapes from `start`; return them and the position of their end.

        Returns an empty list and changes nothing if there are few runs, if a rule may be needed, or if the
        store has free rows to fill first.
        """
        store = self._abox.store
        if len(triples) - start < _FEW or store.free_rows > len(triples) - start:
            return [], len(triples)
        found, end = read_batches(self._runs, triples, start)
        end = max(end, start + 1)
        if found is None:
            return [], end
        shapes: list[KnownShape] = []
        for batch in found.of_shape:
            shape = self.known.get((batch.form, batch.kinds))
            if not isinstance(shape, KnownShape) or not self._has_constants(shape):
                return [], end
            shapes.append(shape)
        node_of = store.add_literals(found.kind_of)
        alike: list[UniformRuns] = []
        for shape, batch in zip(shapes, found.of_shape, strict=True):
            others = [list(map(node_of.__getitem__, terms)) for terms in batch.others]
            constants = [[store.numbers[term]] * batch.size for term in shape.constants]
            store.append(shape.layout, batch.individuals, others + constants)
            alike.append(UniformRuns(shape, batch.form, batch.individuals, batch.others))
        return alike, end

    def write(self, shape: KnownShape, run: Run) -> bool:
        """Store a run of a known shape. Returns False and changes nothing if that is not possible."""
        if not self._has_constants(shape):
            return False
        self._abox.store.write(shape.layout, run.individuals, run.others + shape.constants)
        return True

    def _has_constants(self, shape: KnownShape) -> bool:
        """Return whether the values implied by classes are unchanged."""
        store, constants = self._abox.store, shape.constants
        for term, kind in zip(constants, shape.layout.others[-len(constants) :], strict=False):
            node = store.find(term)
            if node is None or store.kind[node] is not kind:
                return False
        return True

    def learn(self, run: Run) -> None:
        """Cache the shape of a run to which the rules were just applied."""
        if run.form is not None:
            self._remember(run, self._known_shape(run))

    def note_rejection(self, triples: Sequence[Triple], proof: Proof, terms: Sequence[Term]) -> None:
        """Cache the shape of rejected triples, if their `proof` about `terms` depends only on them."""
        first = next(self.runs(triples))
        if first.form is None or len(first.triples) < len(triples):
            return
        there, places = set(triples), first.places
        support = [fact for fact in proof.about(terms).support if not is_schema(fact)]
        is_independent = all(fact in there and (fact[1] == TYPE or fact[2] in places) for fact in support)
        is_independent &= not any(map(swrl.is_of_rule, proof.about(terms).support))  # it may name individuals
        named = tuple([places.get(term, 0) for term in terms])  # the proof does not contain other terms
        self._remember(first, Contradiction(proof, named) if is_independent else None)

    def _remember(self, run: Run, found: KnownShape | Contradiction | None) -> None:
        if len(self.known) >= _MOST:
            self.known.clear()
        self.known[run.shape] = found

    def _known_shape(self, run: Run) -> KnownShape | None:
        """Return the stored form of a run after the rules; None if they implied more than kinds."""
        abox, store = self._abox, self._abox.store
        places = run.places
        individuals = [store.numbers[term] for term in places]
        others = [store.numbers[term] for term in run.others]
        if run.kinds != tuple([store.kind[node] for node in others]):
            return None
        if len(set(run.triples)) < len(run.triples) or self._may_match_rules(individuals, others):
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
        asserted = [(store.subject[e], store.predicate[e]) for e in known if store.source[e] != VALUE]
        implied = {(store.subject[e], store.predicate[e]) for e in values}
        if len(set(asserted)) < len(asserted) or not implied.isdisjoint(asserted):
            return None  # another run may repeat an object where this one has two of the same kind
        return KnownShape(
            self._layout(individuals, others, edges), tuple(constants), tuple(self._touched(run))
        )

    def _may_match_rules(self, individuals: Sequence[int], others: Sequence[int]) -> bool:
        """Return whether SWRL rules may match new nodes by their classes alone. Their edges are plain."""
        abox, kind = self._abox, self._abox.store.kind
        new = (*individuals, *filter(abox.is_literal, others))
        return any(kind[node].mask & abox.schema.lone_rule_classes for node in new)

    def _edge(self, triple: Triple) -> int:
        store, predicate = self._abox.store, self._abox.schema.property(triple[1])
        return store.edge(store.numbers[triple[0]], predicate, store.numbers[triple[2]])

    def _layout(self, individuals: list[int], others: list[int], edges: dict[int, int]) -> Layout:
        """Return the layout of individuals in the store, with their outgoing `edges` and where these lead."""
        store, out = self._abox.store, self._abox.store.out
        place = {node: i for i, node in enumerate(individuals)}
        index = {edge: i for i, edge in enumerate(edges)}

        def linked(column: Sequence[int]) -> tuple[tuple[int, int], ...]:
            return tuple([(i, index[column[edge]]) for edge, i in index.items() if column[edge] != NONE])

        return Layout(
            kinds=tuple([store.kind[node] for node in individuals]),
            others=tuple([store.kind[node] for node in others]),
            edges=tuple([(place[store.subject[e]], store.predicate[e], to) for e, to in edges.items()]),
            values=tuple([i for edge, i in index.items() if store.source[edge] == VALUE]),
            heads=tuple([(i, index[e]) for node, i in place.items() if (e := out.heads[node]) != NONE]),
            groups=linked(out.group),
            pairs=linked(out.after),
        )

    def _touched(self, run: Run) -> Iterator[int]:
        store, subjects = self._abox.store, {s for s, _, _ in run.triples}
        for place, term in enumerate(run.individuals):
            if term in subjects or store.kind[store.numbers[term]].names:
                yield place
