"""The triples that queries read: an Oxigraph store with asserted and inferred triples.

Oxigraph stores numbers and dates by value: `"1.0"` and `"1.00"` are the same literal, written `"1"`.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Collection, Iterable, Iterator
from functools import lru_cache
from pathlib import Path

import pyoxigraph as ox
from msgspec import Struct

from semmap.nodes.kb_node.sparql.triples.disk_stores import clone_store
from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term, Triple

ASSERTED = ox.DefaultGraph()
INFERRED = ox.NamedNode("urn:semmap:inferred")
DENIED = ox.NamedNode("urn:semmap:denied")
"""Graph of asserted locations that are suppressed."""
MEASURED = ox.NamedNode("urn:semmap:measured")
"""Graph of relations that were measured on request and are neither asserted nor inferred."""
_TYPE = v.bare(v.RDF_TYPE)


class Delta(Struct, frozen=True, kw_only=True, array_like=True):
    """The changes of the triples by commit `seq`."""

    seq: int
    retracted: tuple[Triple, ...] = ()
    inserted: tuple[Triple, ...] = ()
    no_longer_inferred: tuple[Triple, ...] = ()
    newly_inferred: tuple[Triple, ...] = ()
    denied: tuple[Triple, ...] = ()
    """Asserted, but denied by the present poses."""
    undenied: tuple[Triple, ...] = ()
    """No longer denied, or no longer asserted."""
    unmeasured: tuple[Triple, ...] = ()
    measured: tuple[Triple, ...] = ()
    demand: int = 0
    """The request whose measurements are complete from here on."""

    @property
    def asserted(self) -> tuple[Triple, ...]:
        """The triples that were asserted or retracted."""
        return self.retracted + self.inserted

    @property
    def everything(self) -> tuple[Triple, ...]:
        """All triples of the change."""
        return (
            self.asserted
            + self.no_longer_inferred
            + self.newly_inferred
            + self.denied
            + self.undenied
            + self.unmeasured
            + self.measured
        )


class Dataset:
    """The asserted and inferred triples after commit `seq`.

    Suppressed assertions are in a third graph.
    """

    settled = 0
    """The commit before which the store is not consistent."""
    denials = 0
    """Number of suppressed assertions."""
    demand = 0
    """The last request for measurements."""

    def __init__(self, seq: int, asserted: Iterable[Triple], store: ox.Store | None = None) -> None:
        """Add `asserted` to `store`, which may contain triples already, or to a new one."""
        self.seq = seq
        self.store = store or ox.Store()
        self._other_spellings: Counter[ox.Quad] = Counter()
        asserted = list(asserted)
        self.store.bulk_extend(quads(asserted, ASSERTED))
        if len(self.store) < len(asserted):
            self._count_spellings(asserted)

    def open_in_reader(self) -> Dataset:
        """Return the dataset for use in a forked reader."""
        return self

    def apply(self, delta: Delta) -> None:
        """Apply the next commit."""
        self._shift(delta.undenied, DENIED, ASSERTED)
        self.denials -= len(delta.undenied)
        for quad in quads(delta.retracted, ASSERTED):
            self._retract(quad)
        inserted = list(quads(delta.inserted, ASSERTED))
        self.store.extend(quad for quad in inserted if not isinstance(quad.object, ox.Literal))
        for quad in inserted:
            if isinstance(quad.object, ox.Literal):
                self._insert(quad)
        for quad in quads(delta.no_longer_inferred, INFERRED):
            self.store.remove(quad)
        self.store.extend(quads(delta.newly_inferred, INFERRED))
        self.deny(delta.denied)
        for quad in quads(delta.unmeasured, MEASURED):
            self.store.remove(quad)
        self.store.extend(quads(delta.measured, MEASURED))
        self.seq = delta.seq
        self.demand = max(self.demand, delta.demand)

    def deny(self, triples: Collection[Triple]) -> None:
        """Suppress asserted triples."""
        self._shift(triples, ASSERTED, DENIED)
        self.denials += len(triples)

    def asserted_graphs(self) -> list[ox.NamedNode | ox.BlankNode | ox.DefaultGraph]:
        """Return the graphs with asserted triples: only one if nothing is suppressed, which is faster."""
        return [ASSERTED, DENIED] if self.denials else [ASSERTED]

    def _shift(
        self,
        triples: Iterable[Triple],
        source: ox.NamedNode | ox.DefaultGraph,
        target: ox.NamedNode | ox.DefaultGraph,
    ) -> None:
        for quad in quads(triples, source):
            self.store.remove(quad)
        self.store.extend(quads(triples, target))

    def _insert(self, quad: ox.Quad) -> None:
        """Insert a quad with a literal, unless it is asserted in another spelling already."""
        if quad in self.store:
            self._other_spellings[_stored(quad)] += 1
        else:
            self.store.add(quad)

    def _retract(self, quad: ox.Quad) -> None:
        """Remove a quad, unless it is still asserted in another spelling."""
        if self._other_spellings and (stored := _stored(quad)) in self._other_spellings:
            self._other_spellings[stored] -= 1
            self._other_spellings += Counter()
        else:
            self.store.remove(quad)

    def _count_spellings(self, asserted: Iterable[Triple]) -> None:
        counts = Counter(map(_stored, quads(asserted, ASSERTED)))
        self._other_spellings.update({quad: n - 1 for quad, n in counts.items() if n > 1})

    def infer(self, triples: Iterable[Triple]) -> None:
        """Add inferred triples when inference is first requested."""
        self.store.bulk_extend(quads(triples, INFERRED))

    def inferred(self, subject: Term | None) -> set[Triple]:
        """Return the inferred triples about a subject, or about all."""
        term = None if subject is None else _subject(subject)
        found = self.store.quads_for_pattern(term, None, None, INFERRED)
        return {_triple(quad) for quad in found}

    def follows(self, triple: Triple) -> bool:
        """Return whether a relation of two individuals is inferred."""
        s, p, o = triple
        return ox.Quad(_subject(s), ox.NamedNode(p[1:-1]), _subject(o), INFERRED) in self.store

    def holds_unmeasured(self, triple: Triple) -> bool:
        """Return whether a relation of two individuals is asserted or inferred."""
        s, p, o = _subject(triple[0]), ox.NamedNode(triple[1][1:-1]), _subject(triple[2])
        return any(ox.Quad(s, p, o, graph) in self.store for graph in (ASSERTED, INFERRED))

    def is_measured(self, triple: Triple) -> bool:
        """Return whether a relation of two individuals is measured."""
        s, p, o = triple
        return ox.Quad(_subject(s), ox.NamedNode(p[1:-1]), _subject(o), MEASURED) in self.store

    def neighbours(self, individual: Term) -> set[Term]:
        """Return the individuals related to this one, in either direction, except by class."""
        term = _subject(individual)
        found: set[Term] = set()
        for graph in (ASSERTED, INFERRED):
            for quad in self.store.quads_for_pattern(term, None, None, graph):
                if quad.predicate.value != _TYPE and not isinstance(quad.object, ox.Literal):
                    found.add(str(quad.object))
            for quad in self.store.quads_for_pattern(None, None, term, graph):
                if quad.predicate.value != _TYPE:
                    found.add(str(quad.subject))
        return found


class DiskDataset(Dataset):
    """The triples in a store on disk, and the log since. Only readers open the store.

    Oxigraph's threads for a store on disk do not survive a fork.
    """

    def __init__(self, path: Path, seq: int, settled: int) -> None:
        super().__init__(seq, ())
        self.path = path
        self.settled = settled
        self._first = seq

    def apply(self, delta: Delta) -> None:
        """Only record the commit; the readers apply it."""
        self.seq = delta.seq

    def open_in_reader(self) -> Dataset:
        """Return a clone of the store, without the commits of the log."""
        opened = Dataset(self._first, (), clone_store(self.path))
        opened.settled = self.settled
        return opened

    def merge_log(self, deltas: Iterable[Delta]) -> None:
        """Apply the log to the store in a separate process, so that another log can begin."""
        if (pid := os.fork()) == 0:
            try:
                store = Dataset(self._first, (), ox.Store(str(self.path)))
                for delta in deltas:
                    store.apply(delta)
                store.store.flush()
                del store
            finally:
                os._exit(0)
        os.waitpid(pid, 0)
        self._first = self.seq


def quads(triples: Iterable[Triple], graph: ox.NamedNode | ox.DefaultGraph) -> Iterator[ox.Quad]:
    """Yield triples in N-Triples terms as quads of a graph."""
    lines = "".join(f"{s} {p} {o} .\n" for s, p, o in triples).encode()
    for quad in ox.parse(lines, ox.RdfFormat.N_TRIPLES):
        yield ox.Quad(quad.subject, quad.predicate, quad.object, graph)


@lru_cache(maxsize=10_000)
def as_stored(term: Term) -> Term:
    """Return a term as Oxigraph returns it."""
    if not term.startswith('"') or "^^" not in term:
        return term
    (quad,) = quads([("<x:s>", "<x:p>", term)], ASSERTED)
    return str(_stored(quad).object)


def _stored(quad: ox.Quad) -> ox.Quad:
    """Return a quad as Oxigraph returns it."""
    if not isinstance(quad.object, ox.Literal):
        return quad
    store = ox.Store()
    store.add(quad)
    (stored,) = store.quads_for_pattern(None, None, None)
    return stored


def _subject(term: Term) -> ox.NamedNode | ox.BlankNode:
    return ox.NamedNode(term[1:-1]) if term.startswith("<") else ox.BlankNode(term[2:])


def _triple(quad: ox.Quad) -> Triple:
    return (str(quad.subject), str(quad.predicate), str(quad.object))
