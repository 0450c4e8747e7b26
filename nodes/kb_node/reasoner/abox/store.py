"""The ABox in columns: terms by number, and edges as linked lists.

A *node* is the number of an individual or literal. An *edge* is the number of a row of subject, predicate and
object. Freed numbers are reused.
"""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Iterable, Mapping, MutableSequence, Sequence, Set
from itertools import repeat
from typing import Any, Final

from semmap.nodes.kb_node.reasoner.abox.adjacency import NONE, Adjacency
from semmap.nodes.kb_node.reasoner.abox.columns import ASSERTED as ASSERTED
from semmap.nodes.kb_node.reasoner.abox.columns import Columns
from semmap.nodes.kb_node.reasoner.abox.kinds import Kind, Kinds
from semmap.nodes.kb_node.reasoner.explanations import Term
from semmap.nodes.kb_node.reasoner.fastpaths.layout import Layout
from semmap.nodes.kb_node.reasoner.terms import is_literal

BLOCK: Final = 256
"""Number of rows that are allocated together."""
VALUE, DERIVED, COMPUTED = 1, 2, 3
"""The source of an edge that is not ASSERTED: a value of a class (cls-hv1), another rule, or an external
computation. A computed edge holds without inference, like an asserted one."""
GIVEN: Final = frozenset((ASSERTED, COMPUTED))
"""The sources of edges that do not depend on other edges."""


Terms = tuple[Term, ...]


class Store:
    """Terms, kinds and edges."""

    def __init__(self, kinds: Kinds) -> None:
        self._kinds = kinds
        self.terms: list[Term] = []
        self.kind: list[Kind] = []
        self.subject: list[int] = []
        self.predicate: list[int] = []
        self.object: list[int] = []
        self.source = bytearray()
        self.out = Adjacency(self.predicate)
        self.into = Adjacency(self.predicate)
        self.numbers: dict[Term, int] = {}
        self.places = array("i")
        """The position of an individual in the list of its kind; `NONE` if it is in no list."""
        self.log: list[tuple[int, int, int]] | None = None
        """The edges that were added or removed, while they are recorded; else None."""
        self._free_nodes: list[int] = []
        self._free_edges: list[int] = []

    # Nodes

    def find(self, term: Term) -> int | None:
        """Return the node of a term, or None."""
        return self.numbers.get(term)

    def node(self, term: Term) -> int:
        """Return the node of a term. Creates the node if it does not exist."""
        found = self.numbers.get(term)
        if found is not None:
            return found
        kinds = self._kinds
        kind = kinds.literal(term) if is_literal(term) else kinds.individual(term)
        node = self._free_nodes_for(1).pop()
        self.terms[node], self.kind[node], self.numbers[term] = term, kind, node
        if kind.mask and kind.excluded is None:
            self.list_under_kind(node, kind, kind)
        return node

    def _free_nodes_for(self, count: int) -> list[int]:
        """Return at least `count` free node numbers. These nodes have no edges and are in no list."""
        free = self._free_nodes
        while len(free) < count:
            free.extend(reversed(self._more_nodes(BLOCK)))
        return free

    def _more_nodes(self, count: int) -> range:
        """Allocate rows for nodes."""
        first, room = len(self.terms), array("i", [NONE]) * count
        self.terms.extend([""] * count)
        self.kind.extend([self._kinds.nothing] * count)
        for column in (self.places, self.out.heads, self.into.heads):
            column.extend(room)
        return range(first, first + count)

    def is_bare(self, node: int) -> bool:
        """Return whether a node has no edges."""
        return self.out.heads[node] == NONE and self.into.heads[node] == NONE

    def release(self, node: int) -> bool:
        """Remove a node if it has no edges and no asserted classes; return whether it was removed."""
        kind = self.kind[node]
        is_asserted = kind.excluded is None and kind.given
        if is_asserted or not self.is_bare(node):
            return False
        self._forget(node)
        return True

    def _forget(self, node: int) -> None:
        if self.places[node] != NONE:
            self.list_under_kind(node, self.kind[node], None)
        del self.numbers[self.terms[node]]
        self.terms[node] = ""
        self._free_nodes.append(node)

    def list_under_kind(self, node: int, old: Kind, new: Kind | None) -> None:
        """Move an individual from the list of its old kind to that of its new kind; None removes it."""
        place = self.places[node]
        if place != NONE:
            nodes = old.nodes
            last = nodes.pop()
            if last != node:
                nodes[place] = last
                self.places[last] = place
            self.places[node] = NONE
        if new is not None:
            self.places[node] = len(new.nodes)
            new.nodes.append(node)

    # Edges

    @property
    def free_rows(self) -> int:
        """The number of free node rows or edge rows, whichever is larger."""
        return max(len(self._free_nodes), len(self._free_edges))

    def add(self, subject: int, predicate: int, object_: int, source: int) -> int:
        """Store a new edge."""
        edge = self._free_edges_for(1).pop()
        self.subject[edge], self.predicate[edge], self.object[edge] = subject, predicate, object_
        if source != ASSERTED:
            self.source[edge] = source
        if self.log is not None:
            self.log.append((subject, predicate, object_))
        self.out.link(subject, edge, predicate)
        self.into.link(object_, edge, predicate)
        return edge

    def write(self, layout: Layout, individuals: Terms, others: Terms) -> None:
        """Add new individuals with their edges, all of which start at them.

        The layout guarantees equal lengths in `zip`. `strict` would cost 3 % of an add.
        """
        terms, kinds, numbers, places = self.terms, self.kind, self.numbers, self.places
        free = self._free_nodes_for(len(individuals) + len(others))
        nodes: list[int] = []
        for term, kind in zip(individuals, layout.kinds):  # noqa: B905
            node = free.pop()
            nodes.append(node)
            terms[node], kinds[node], numbers[term] = term, kind, node
            if kind.mask:
                places[node] = len(kind.nodes)
                kind.nodes.append(node)
        for term, kind in zip(others, layout.others):  # noqa: B905
            node = numbers.get(term, NONE)
            if node == NONE:
                node = free.pop()
                terms[node], kinds[node], numbers[term] = term, kind, node
            nodes.append(node)
        free = self._free_edges_for(len(layout.edges))
        left = len(free) - len(layout.edges)
        edges = free[left:]
        del free[left:]
        subject, predicate, object_ = self.subject, self.predicate, self.object
        heads, link = self.into.heads, self.into.link
        for edge, (s, p, o) in zip(edges, layout.edges):  # noqa: B905
            node = nodes[o]
            subject[edge], predicate[edge], object_[edge] = nodes[s], p, node
            if heads[node] == NONE:
                heads[node] = edge
            else:
                link(node, edge, p)
        heads, group, after, before = self.out.heads, self.out.group, self.out.after, self.out.before
        for place, at in layout.heads:
            heads[nodes[place]] = edges[at]
        for at, to in layout.groups:
            group[edges[at]] = edges[to]
        for at, to in layout.pairs:
            after[edges[at]], before[edges[to]] = edges[to], edges[at]
        for at in layout.values:
            self.source[edges[at]] = VALUE

    def append(self, layout: Layout, individuals: Sequence[Terms], others: Sequence[list[int]]) -> None:
        """Do `write` for many runs, in consecutive new rows. The other objects are existing nodes.

        `individuals` and `others` are columns.
        """
        count, width, length = len(individuals[0]), len(layout.kinds), len(layout.edges)
        rows, edges = self._more_nodes(count * width), self._more_edges(count * length)
        _put(self.kind, rows, layout.kinds * count)
        _put(self.predicate, edges, [p for _, p, _ in layout.edges] * count)
        nodes: list[list[int]] = []  # reuses the same int objects to save memory
        for place, (terms, kind) in enumerate(zip(individuals, layout.kinds, strict=True)):
            here = rows[place::width]
            nodes.append(list(here))
            self.numbers.update(zip(terms, nodes[place], strict=True))
            _put(self.terms, here, terms)
            if kind.mask:
                _put(self.places, here, range(len(kind.nodes), len(kind.nodes) + count))
                kind.nodes.extend(here)
        nodes += others
        entered = set[int]()
        for at, (s, p, o) in enumerate(layout.edges):
            here = edges[at::length]
            _put(self.subject, here, nodes[s])
            _put(self.object, here, nodes[o])
            if o < width and o not in entered:  # a new individual has no incoming edges yet
                _put(self.into.heads, rows[o::width], here)
            else:
                self.into.link_each(nodes[o], here, p)
            entered.add(o)
        for place, at in layout.heads:
            _put(self.out.heads, rows[place::width], edges[at::length])
        for at, to in layout.groups:
            _put(self.out.group, edges[at::length], edges[to::length])
        for at, to in layout.pairs:
            _put(self.out.after, edges[at::length], edges[to::length])
            _put(self.out.before, edges[to::length], edges[at::length])
        for at in layout.values:
            _put(self.source, edges[at::length], bytes([VALUE]) * count)

    def add_each(
        self,
        predicate: int,
        subjects: Sequence[int],
        objects: Sequence[int],
        source: int,
        *,
        is_first: bool = False,
    ) -> Sequence[int]:
        """Do `add` for many edges of one predicate. `is_first`: each is its subject's only edge of it."""
        count = len(subjects)
        if count == 0 or len(self._free_edges) >= count:
            ends = zip(subjects, objects, strict=True)
            return [self.add(subject, predicate, object_, source) for subject, object_ in ends]
        edges = self._more_edges(count)
        _put(self.subject, edges, subjects)
        _put(self.object, edges, objects)
        _put(self.predicate, edges, [predicate] * count)
        if source != ASSERTED:
            _put(self.source, edges, bytes([source]) * count)
        if self.log is not None:
            self.log += zip(subjects, repeat(predicate), objects, strict=False)
        if is_first:
            self.out.link_firsts(subjects, edges)
        else:
            self.out.link_each(subjects, edges, predicate)
        self.into.link_each(objects, edges, predicate)
        return edges

    def add_literals(self, kinds: Mapping[Term, Kind]) -> dict[Term, int]:
        """Return the nodes of literals with known kinds. Creates the nodes that do not exist."""
        nodes = dict(zip(kinds, map(self.numbers.get, kinds), strict=True))
        new = [term for term, node in nodes.items() if node is None]
        rows = self._more_nodes(len(new))
        made = dict(zip(new, rows, strict=True))
        self.numbers.update(made)
        _put(self.terms, rows, new)
        _put(self.kind, rows, [kinds[term] for term in new])
        return {term: made[term] if node is None else node for term, node in nodes.items()}

    def _free_edges_for(self, count: int) -> list[int]:
        """Return at least `count` free edge numbers, of edges in no list with the source ASSERTED."""
        free = self._free_edges
        while len(free) < count:
            free.extend(reversed(self._more_edges(BLOCK)))
        return free

    def _more_edges(self, count: int) -> range:
        """Allocate rows for edges."""
        first, room = len(self.subject), array("i", [NONE]) * count
        for row in (self.subject, self.predicate, self.object):
            row.extend(room)
        for side in (self.out, self.into):
            for column in (side.after, side.before, side.group):
                column.extend(room)
        self.source.extend(bytes(count))
        return range(first, first + count)

    def remove(self, edge: int) -> None:
        """Remove an edge."""
        if self.log is not None:
            self.log.append((self.subject[edge], self.predicate[edge], self.object[edge]))
        self.out.unlink(self.subject[edge], edge)
        self.into.unlink(self.object[edge], edge)
        self._free_edge(edge)

    def _free_edge(self, edge: int) -> None:
        self.predicate[edge] = NONE
        if self.source[edge] != ASSERTED:
            self.source[edge] = ASSERTED
        self._free_edges.append(edge)

    def replace_literal(self, edge: int, term: Term) -> None:
        """Change the object of an edge to another literal. Removes the old literal if it is unused."""
        old = self.object[edge]
        self.into.unlink(old, edge)
        if self.into.heads[old] == NONE:
            self._forget(old)
        self.object[edge] = node = self.node(term)
        self.into.link(node, edge, self.predicate[edge])

    def fill(self, columns: Columns, kinds: Iterable[Kind], properties: Sequence[int]) -> None:
        """Load columns, with the given kinds of nodes and numbers of properties."""
        terms, number = columns.terms, list(range(max(len(columns.terms), len(columns.subject)))).__getitem__
        self.terms[:] = terms  # `number` returns shared int objects to save memory
        self.kind[:] = kinds
        self.subject[:] = [number(node) for node in columns.subject]
        self.object[:] = [number(node) for node in columns.object]
        self.predicate[:] = [NONE if p == NONE else properties[p] for p in columns.predicate]
        self.source[:] = columns.source
        self.numbers.clear()
        self.numbers.update(zip(terms, map(number, range(len(terms))), strict=True))
        self.numbers.pop("", None)
        self.places[:] = columns.places
        for side, links in ((self.out, columns.out), (self.into, columns.into)):
            side.heads[:], side.after[:], side.before[:], side.group[:] = links
        self._free_nodes[:] = [node for node, term in enumerate(terms) if not term]
        self._free_edges[:] = [edge for edge, p in enumerate(columns.predicate) if p == NONE]
        listed = [(node, place) for node, place in enumerate(self.places) if place != NONE]
        for kind, count in Counter(self.kind[node] for node, _ in listed).items():
            kind.nodes[:] = array("i", bytes(count * kind.nodes.itemsize))
        for node, place in listed:
            self.kind[node].nodes[place] = node

    def erase(self, nodes: Set[int], edges: Sequence[int]) -> None:
        """Remove individuals and all their outgoing edges. No other edges may lead to them."""
        object_, predicate, source = self.object, self.predicate, self.source
        into, heads, into_after, into_group = self.into, self.into.heads, self.into.after, self.into.group
        after, before, group = self.out.after, self.out.before, self.out.group
        for edge in edges:  # `clear` and `remove` inlined: removals are frequent
            node = object_[edge]
            if (
                heads[node] == edge and into_after[edge] == NONE and into_group[edge] == NONE
            ):  # the common case
                heads[node] = NONE
                if node not in nodes:
                    self.release(node)
            elif node in nodes:
                into.clear(edge)
            else:
                into.unlink(node, edge)
            if after[edge] != NONE:
                after[edge] = NONE
            if before[edge] != NONE:
                before[edge] = NONE
            if group[edge] != NONE:
                group[edge] = NONE
            predicate[edge] = NONE
            if source[edge] != ASSERTED:
                source[edge] = ASSERTED
        self._free_edges.extend(edges)
        for node in nodes:
            self.out.heads[node] = heads[node] = NONE
            self._forget(node)

    def edge(self, subject: int, predicate: int, object_: int) -> int:
        """Return the edge of a triple, or NONE. The time depends on the shorter of its two lists."""
        leaving = self.out.first(subject, predicate)
        if leaving == NONE:
            return NONE
        return self._edge(subject, object_, leaving, self.into.first(object_, predicate))

    def edge_of(self, subject: int, predicates: tuple[int, ...], object_: int) -> int:
        """Return the first edge between two nodes with one of some predicates, or NONE."""
        if not predicates or self.out.heads[subject] == NONE or self.into.heads[object_] == NONE:
            return NONE
        for leaving in self.out.firsts(subject, predicates):
            entering = self.into.first(object_, self.predicate[leaving])
            if entering != NONE:
                edge = self._edge(subject, object_, leaving, entering)
                if edge != NONE:
                    return edge
        return NONE

    def _edge(self, subject: int, object_: int, leaving: int, entering: int) -> int:
        """Find an edge by walking the outgoing and incoming lists of one predicate in parallel."""
        subjects, objects, after, before = self.subject, self.object, self.out.after, self.into.after
        while leaving != NONE and entering != NONE:
            if objects[leaving] == object_:
                return leaving
            if subjects[entering] == subject:
                return entering
            leaving, entering = after[leaving], before[entering]
        return NONE


def _put(column: MutableSequence[Any], rows: range, values: Iterable[Any]) -> None:
    """Write values into evenly spaced rows."""
    if isinstance(column, array):
        values = array("i", values)
    column[rows.start : rows.stop : rows.step] = values
