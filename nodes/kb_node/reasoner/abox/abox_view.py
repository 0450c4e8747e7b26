"""Pattern queries on the ABox: asserted triples, and inferred ones that are not stored."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Set
from contextlib import suppress
from itertools import chain

from semmap.nodes.kb_node.reasoner import datatypes
from semmap.nodes.kb_node.reasoner.abox.abox import ABox
from semmap.nodes.kb_node.reasoner.abox.adjacency import NONE
from semmap.nodes.kb_node.reasoner.abox.kinds import Kind
from semmap.nodes.kb_node.reasoner.abox.store import ASSERTED, COMPUTED
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.tbox.axioms import DIFFERENT, SAME, Role
from semmap.nodes.kb_node.reasoner.terms import SAME_AS, TYPE, is_literal

Further = tuple[tuple[int, Term], ...]
"""The properties, with their names, that an edge implies at one of its ends."""


class View:
    """Read access to an ABox; None in a pattern is a wildcard."""

    def __init__(self, abox: ABox) -> None:
        self._abox = abox
        self._store = abox.store
        self._schema = abox.schema
        self._further: dict[int, tuple[Further, Further]] = {}
        self._inferred_names: dict[Kind, list[Term]] = {}

    # Asserted

    def asserted(self, s: Term | None, p: Term | None, o: Term | None) -> Iterator[Triple]:
        """Return the asserted triples that match a pattern."""
        if p is None and (s is None or o is None):
            if s is not None:
                return self._asserted_about(s)
            return self._everything() if o is None else self._asserted_with_object(o)
        return self._matching(s, p, o)

    def _everything(self) -> Iterator[Triple]:
        for node, term in enumerate(self._store.terms):
            if term and not self._abox.is_literal(node):
                yield from self._asserted_about(term)

    def _asserted_about(self, s: Term) -> Iterator[Triple]:
        """Yield the asserted triples of a subject."""
        store, axioms, node = self._store, self._schema.axioms, self._store.numbers.get(s)
        if node is None:
            return
        for cls in self._given(node):
            yield (s, TYPE, self._schema.classes[cls])
        for edge in store.out.all(node):
            if store.source[edge] == ASSERTED:
                yield (s, axioms[store.predicate[edge]].term, store.terms[store.object[edge]])

    def _asserted_with_object(self, o: Term) -> Iterator[Triple]:
        """Yield the asserted triples of an object."""
        if self._schema.find_class(o) is not None:
            yield from self._asserted_types(None, o)
        store, axioms, node = self._store, self._schema.axioms, self._store.numbers.get(o)
        if node is None:
            return
        for edge in store.into.all(node):
            if store.source[edge] == ASSERTED:
                yield (store.terms[store.subject[edge]], axioms[store.predicate[edge]].term, o)

    def _matching(self, s: Term | None, p: Term | None, o: Term | None) -> Iterator[Triple]:
        if p is None or p == TYPE:
            yield from self._asserted_types(s, o)
        if p != TYPE:
            for edge in self._asserted_edges(s, p, o):
                yield self._triple(edge)

    def computed(self, s: Term | None, p: Term | None, o: Term | None) -> Iterator[Triple]:
        """Yield the computed triples that match a pattern."""
        source, edge = self._store.source, -1
        if s is None and p is None and o is None:
            while (edge := source.find(COMPUTED, edge + 1)) >= 0:
                yield self._triple(edge)
            return
        for edge in self._stored_edges(s, p, o):
            if source[edge] == COMPUTED:
                yield self._triple(edge)

    def is_computed(self, triple: Triple) -> bool:
        """Return whether a triple is computed and not asserted."""
        s, o, predicate = (
            self._store.find(triple[0]),
            self._store.find(triple[2]),
            self._schema.find_property(triple[1]),
        )
        if s is None or o is None or predicate is None:
            return False
        edge = self._store.edge(s, predicate, o)
        return edge != NONE and self._store.source[edge] == COMPUTED

    def by_subject(self) -> Iterator[list[Triple]]:
        """Yield the asserted triples, subject by subject. The ABox may change between two subjects.

        A subject that changes during the iteration is returned as before or after the change. New subjects
        may be missing.
        """
        store, schema = self._store, self._schema
        for node, term in enumerate(store.terms):
            if not term or self._abox.is_literal(node):
                continue
            triples = [(term, TYPE, schema.classes[cls]) for cls in self._given(node)]
            for edge in store.out.all(node):
                if store.source[edge] == ASSERTED:
                    predicate = schema.axioms[store.predicate[edge]].term
                    triples.append((term, predicate, store.terms[store.object[edge]]))
            yield triples

    def about(self, s: Term) -> dict[Term, list[Term]]:
        """Return the asserted triples of a subject: predicate to objects."""
        store, schema, node = self._store, self._schema, self._store.find(s)
        if node is None:
            return {}
        objects: dict[Term, list[Term]] = {}
        if types := [schema.classes[cls] for cls in self._given(node)]:
            objects[TYPE] = types
        source, axioms, predicate = store.source, schema.axioms, store.predicate
        terms, object_ = store.terms, store.object
        for edge in store.out.all(node):
            if source[edge] == ASSERTED:
                objects.setdefault(axioms[predicate[edge]].term, []).append(terms[object_[edge]])
        return objects

    def _asserted_types(self, s: Term | None, o: Term | None) -> Iterator[Triple]:
        cls = None if o is None else self._schema.find_class(o)
        if o is not None and cls is None:
            return
        for node in self._nodes(s, cls):
            for given in self._given(node):
                if cls is None or given == cls:
                    yield (self._store.terms[node], TYPE, self._schema.classes[given])

    def _nodes(self, s: Term | None, cls: int | None) -> Iterator[int]:
        """Yield the individuals that may have asserted classes: one, those given a class, or all."""
        if s is not None:
            node = self._store.find(s)
            if node is not None:
                yield node
            return
        for kind in self._abox.kinds:
            if kind.nodes and (cls is None or cls in kind.given):
                yield from kind.nodes

    def _given(self, node: int) -> Iterator[int]:
        return self._abox.kinds.given(self._store.kind[node])

    def _asserted_edges(self, s: Term | None, p: Term | None, o: Term | None) -> Iterator[int]:
        return (e for e in self._stored_edges(s, p, o) if self._store.source[e] == ASSERTED)

    def _stored_edges(self, s: Term | None, p: Term | None, o: Term | None) -> Iterator[int]:
        store = self._store
        subject = None if s is None else store.find(s)
        object_ = None if o is None else store.find(o)
        predicate = None if p is None else self._schema.find_property(p)
        if (s and subject is None) or (o and object_ is None) or (p and predicate is None):
            return
        yield from self._edges(subject, predicate, object_)

    def _edges(self, s: int | None, p: int | None, o: int | None) -> Iterator[int]:
        store = self._store
        if s is not None and p is not None and o is not None:
            edge = store.edge(s, p, o)
            if edge != NONE:
                yield edge
        elif s is not None:
            for edge in store.out.all(s) if p is None else store.out.of(s, p):
                if o is None or store.object[edge] == o:
                    yield edge
        elif o is not None:
            yield from store.into.all(o) if p is None else store.into.of(o, p)
        elif p is None:
            for edge, predicate in enumerate(store.predicate):
                if predicate != NONE:
                    yield edge
        else:
            yield from _places_of(p, store.predicate)

    def _triple(self, edge: int) -> Triple:
        store = self._store
        predicate = self._schema.axioms[store.predicate[edge]].term
        return (store.terms[store.subject[edge]], predicate, store.terms[store.object[edge]])

    # Inferred

    def inferred(self, s: Term | None, p: Term | None, o: Term | None) -> Iterator[Triple]:
        """Yield the inferred triples of a pattern that are not asserted, each once.

        Anonymous classes and `x owl:sameAs x` are left out. A value is returned once, in its canonical
        spelling, unless it was asserted in any spelling.
        """
        if s is not None:
            node = self._store.find(s)
            nodes = iter(()) if node is None else iter((node,))
        elif o is not None and p != TYPE and not is_literal(o):
            nodes = self._neighbours(o)
        elif p == TYPE and o is not None:
            nodes = (node for node in self._instances(o))
        else:
            nodes = (node for node, term in enumerate(self._store.terms) if term)
        is_regular = p is None and not (self._abox.equals or self._abox.spellings)
        virtual = self._virtual_predicates() if is_regular else frozenset[int]()
        for node in nodes:
            if not self._abox.is_literal(node):
                found = self._inferred_quickly(node, virtual) if is_regular else self._inferred_of(node, p)
                if o is None:
                    yield from found
                else:
                    yield from (triple for triple in found if triple[2] == o)

    def _virtual_predicates(self) -> frozenset[int]:
        """Return the predicates of the edges that may be steps of a virtual role."""
        groups = [
            self._abox.steps.group((p, turned)) for p in self._schema.virtual for turned in (False, True)
        ]
        return frozenset(p for group in groups for p in (*group.out, *group.into))

    def _inferred_quickly(self, node: int, virtual: Set[int]) -> Iterable[Triple]:
        """Return `_inferred_of` for an ABox without equalities. `virtual` is from `_virtual_predicates`."""
        store = self._store
        term, kind = store.terms[node], store.kind[node]
        inferred_names = self._inferred_names.get(kind)
        if inferred_names is None:
            given = {self._schema.classes[cls] for cls in self._given(node)}
            inferred_names = self._inferred_names[kind] = list(kind.names - given)
        types = [(term, TYPE, name) for name in inferred_names]
        object_of, predicate, source, further = store.object, store.predicate, store.source, self._further
        implied: dict[tuple[int, int], Term] = {}
        for edge in store.out.all(node):
            if (p := predicate[edge]) in virtual:
                return self._inferred_of(node, None)
            onward, _ = further.get(p) or self._further_of(p)
            if onward:
                end = object_of[edge]
                is_asserted = source[edge] == ASSERTED
                for q, name in onward:
                    if q != p or not is_asserted:
                        implied[q, end] = name
        for edge in store.into.all(node):
            if (p := predicate[edge]) in virtual:
                return self._inferred_of(node, None)
            _, back = further.get(p) or self._further_of(p)
            if back:
                end = store.subject[edge]
                for q, name in back:
                    implied[q, end] = name
        if not implied:
            return types
        kinds = store.kind
        if any(kinds[end].excluded is not None for _, end in implied):
            return self._inferred_of(node, None)  # literals have spellings
        asserted = {(predicate[e], object_of[e]) for e in store.out.all(node) if source[e] == ASSERTED}
        terms = store.terms
        return types + [
            (term, name, terms[end]) for (q, end), name in implied.items() if (q, end) not in asserted
        ]

    def _further_of(self, predicate: int) -> tuple[Further, Further]:
        """Return the named properties that an edge implies for its subject, and those for its object."""
        ends: tuple[list[tuple[int, Term]], list[tuple[int, Term]]] = ([], [])
        for q, backwards in self._schema.roles(predicate) if predicate != SAME else ():
            if self._schema.axioms[q].is_shown:
                ends[backwards].append((q, self._schema.axioms[q].term))
        found = self._further[predicate] = (tuple(ends[0]), tuple(ends[1]) if predicate > DIFFERENT else ())
        return found

    def _neighbours(self, term: Term) -> Iterator[int]:
        """Return the individuals that may be related to a term."""
        found: dict[int, None] = {}
        found.update(dict.fromkeys(self._instances(term)))
        here = self._store.find(term)
        if here is not None:
            for member in self._abox.members(here):
                found[member] = None
                for edge in self._store.into.all(member):
                    found.update(dict.fromkeys(self._abox.members(self._store.subject[edge])))
                for edge in self._store.out.all(member):
                    found.update(dict.fromkeys(self._abox.members(self._store.object[edge])))
                for p in self._schema.virtual:
                    for turned in (False, True):
                        found.update(dict.fromkeys(self._reached(member, (p, turned))))
        return iter(found)

    def _reached(self, node: int, role: Role) -> Iterator[int]:
        """Yield the nodes that a transitive role leads to."""
        for _, _, end in self._abox.reached(node, role).values():
            yield from self._equals(end)

    def _inferred_of(self, node: int, p: Term | None) -> Iterator[Triple]:
        store, term = self._store, self._store.terms[node]
        if p is None or p == TYPE:
            kind = store.kind[node]
            given = {self._schema.classes[cls] for cls in self._given(node)}
            yield from ((term, TYPE, name) for name in kind.names - given)
        if p is None or p == SAME_AS:
            yield from self._inferred_same(node)
        if p in (TYPE, SAME_AS):
            return
        wanted = None if p is None else self._schema.find_property(p)
        if p is not None and wanted is None:
            return
        asserted = {
            (store.predicate[e], store.object[e]) for e in store.out.all(node) if store.source[e] == ASSERTED
        }
        values: dict[tuple[int, Term], None] = {}
        for predicate, object_ in dict.fromkeys(self._implied(node)):
            axioms = self._schema.axioms[predicate]
            name = axioms.term
            if wanted not in (None, predicate) or not axioms.is_shown:
                continue
            if self._abox.is_literal(object_):
                values[predicate, datatypes.canonical(store.terms[object_])] = None
            elif (predicate, object_) not in asserted:
                yield (term, name, store.terms[object_])
        if values:
            known = {
                (p, datatypes.canonical(store.terms[o])) for p, o in asserted if self._abox.is_literal(o)
            }
            yield from ((term, self._schema.axioms[p].term, o) for p, o in values if (p, o) not in known)

    def _inferred_same(self, node: int) -> Iterator[Triple]:
        store = self._store
        for member in self._abox.members(node):
            edge = store.edge(node, SAME, member)
            if member != node and (edge == NONE or store.source[edge] != ASSERTED):
                yield (store.terms[node], SAME_AS, store.terms[member])

    def _implied(self, node: int) -> Iterator[tuple[int, int]]:
        """Yield all properties and objects of a node, including those of equal nodes at both ends."""
        store, schema, abox = self._store, self._schema, self._abox
        for member in abox.members(node):
            for edge in store.out.all(member):
                if store.predicate[edge] != SAME:
                    others = self._equals(store.object[edge])
                    for q, backwards in schema.roles(store.predicate[edge]):
                        if not backwards:
                            yield from ((q, other) for other in others)
            for edge in store.into.all(member):
                if store.predicate[edge] > DIFFERENT:
                    others = self._equals(store.subject[edge])
                    for q, backwards in schema.roles(store.predicate[edge]):
                        if backwards:
                            yield from ((q, other) for other in others)
        for p in schema.virtual:
            ends = {turned: list(self._reached(node, (p, turned))) for turned in (False, True)}
            for q, backwards in schema.roles(p):
                yield from ((q, other) for other in ends[backwards])

    def _equals(self, node: int) -> list[int]:
        members, value = self._abox.members(node), self._abox.value(node)
        return [
            other for other in members if other == node or value is None or value != self._abox.value(other)
        ]

    # Queries

    def holds(self, triple: Triple) -> bool:
        """Return whether a triple about individuals is asserted or inferred."""
        s, p, o = triple
        if p == SAME_AS and s == o:
            return True
        node = self._store.find(s)
        if node is None:
            return False
        if p == TYPE:
            cls = self._schema.find_class(o)
            return cls is not None and bool(self._store.kind[node].mask >> cls & 1)
        if p == SAME_AS:
            return self._abox.named(node, o) is not None
        predicate = self._schema.find_property(p)
        if predicate is None:
            return False
        group = self._abox.steps.group((predicate, False))
        object_ = None if is_literal(o) else self._store.find(o)
        if object_ is not None:
            if self._abox.find(node, (predicate, False), object_) != NONE:
                return True
        elif any(self._abox.named(end, o) is not None for _, _, end in self._abox.related(node, group)):
            return True
        return any(
            self._abox.named(end, o) is not None
            for role in self._schema.transitive_roles(predicate)
            for _, _, end in self._abox.reached(node, role).values()
        )

    def types(self, individual: Term) -> frozenset[Term]:
        """Return the named classes of an individual."""
        node = self._store.find(individual)
        return frozenset() if node is None else self._store.kind[node].names

    def instances(self, cls: Term) -> Iterator[Term]:
        """Return the individuals of a class."""
        return (self._store.terms[node] for node in self._instances(cls))

    def _instances(self, term: Term) -> Iterator[int]:
        cls = self._schema.find_class(term)
        if cls is None:
            return iter(())
        return chain.from_iterable(kind.nodes for kind in self._abox.kinds if kind.mask >> cls & 1)


def _places_of(value: int, column: list[int]) -> Iterator[int]:
    """Yield the positions of a value in a column. `index` is faster than a loop for rare values."""
    place = -1
    with suppress(ValueError):
        while True:
            place = column.index(value, place + 1)
            yield place
