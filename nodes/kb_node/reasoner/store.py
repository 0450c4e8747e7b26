"""The ABox in columns: terms by number, edges as linked lists, nothing that can be worked out.

A *node* is the number of an individual or literal. An *edge* is the number of a row subject, predicate,
object. The edges at a node are linked in groups of one predicate, so that a room with ten thousand parts is
asked for its walls without looking at the parts. Freed numbers are used again.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Iterator
from typing import Final, NamedTuple

from nodes.kb_node.reasoner.kinds import Kind, Kinds
from nodes.kb_node.reasoner.terms import is_literal
from schemas.explanations import Term

NONE: Final = -1
BLOCK: Final = 256
"""Edges that room is made for at once."""
ASSERTED, VALUE, DERIVED = 0, 1, 2
"""Where an edge comes from: asserted, a class that comes with a value (cls-hv1), or another rule."""


class Adjacency:
    """The edges that leave (or enter) each node, in groups of one predicate.

    `heads[node]` is the first edge of the node's first group, `group[edge]` leads from there to the first
    edge of the next group, `after` and `before` within a group.
    """

    __slots__ = ("after", "before", "group", "heads", "predicate")

    def __init__(self, predicate: array[int]) -> None:
        self.predicate = predicate
        self.heads = array("i")
        self.after = array("i")
        self.before = array("i")
        self.group = array("i")

    def link(self, node: int, edge: int, predicate: int) -> None:
        """Put an edge, whose predicate is set already, into the list of a node."""
        head = first = self.heads[node]
        if head == NONE:
            self.heads[node] = edge
            self.before[edge] = self.after[edge] = self.group[edge] = NONE
            return
        column, group = self.predicate, self.group
        while first != NONE and column[first] != predicate:
            first = group[first]
        self.before[edge] = NONE
        if first == NONE:
            self.after[edge], group[edge] = NONE, head
            self.heads[node] = edge
            return
        # behind the first of its group, so that the chain of groups stays as it is
        second = self.after[first]
        self.after[first], self.before[edge] = edge, first
        self.after[edge] = second
        if second != NONE:
            self.before[second] = edge

    def unlink(self, node: int, edge: int) -> None:
        """Take an edge out of the list of a node."""
        before, after = self.before[edge], self.after[edge]
        if after != NONE:
            self.before[after] = before
        if before != NONE:
            self.after[before] = after
            return
        replacement = after
        if after == NONE:
            replacement = self.group[edge]
        else:
            self.group[after] = self.group[edge]
        first = self.heads[node]
        if first == edge:
            self.heads[node] = replacement
            return
        while self.group[first] != edge:
            first = self.group[first]
        self.group[first] = replacement

    def is_alone(self, edge: int) -> bool:
        """Whether a node has no other edge with the edge's predicate."""
        return self.before[edge] == NONE and self.after[edge] == NONE

    def of(self, node: int, predicate: int) -> Iterator[int]:
        """The edges of a node with a predicate."""
        edge = self.heads[node]
        while edge != NONE and self.predicate[edge] != predicate:
            edge = self.group[edge]
        while edge != NONE:
            yield edge
            edge = self.after[edge]

    def all(self, node: int) -> Iterator[int]:
        """All edges of a node."""
        first = self.heads[node]
        while first != NONE:
            edge = first
            while edge != NONE:
                yield edge
                edge = self.after[edge]
            first = self.group[first]


class NewEdge(NamedTuple):
    """An edge of a layout: its ends by place, and its neighbours by their index in the layout, NONE for none."""

    subject: int
    predicate: int
    object: int
    source: int
    after: int
    before: int
    group: int


class Layout(NamedTuple):
    """New individuals and their edges, as they are written at once.

    A *place* counts the new individuals first, then the other objects.
    """

    kinds: tuple[Kind, ...]
    """Those of the individuals."""
    others: tuple[Kind, ...]
    """Those of the other objects, which they have already if they are there."""
    edges: tuple[NewEdge, ...]
    heads: tuple[int, ...]
    """The index of each individual's first edge."""


class Store:
    """Terms, kinds and edges."""

    def __init__(self, kinds: Kinds) -> None:
        self._kinds = kinds
        self.terms: list[Term] = []
        self.kind: list[Kind] = []
        self.subject = array("i")
        self.predicate = array("i")
        self.object = array("i")
        self.source = bytearray()
        self.out = Adjacency(self.predicate)
        self.into = Adjacency(self.predicate)
        self.numbers: dict[Term, int] = {}
        self._places = array("i")
        self._free_nodes: list[int] = []
        self._free_edges: list[int] = []

    # Nodes

    def find(self, term: Term) -> int | None:
        """The node of a term, or None."""
        return self.numbers.get(term)

    def node(self, term: Term) -> int:
        """The node of a term; a new one if it is not there."""
        found = self.numbers.get(term)
        if found is not None:
            return found
        kinds = self._kinds
        return self._new(term, kinds.literal(term) if is_literal(term) else kinds.individual(term))

    def _new(self, term: Term, kind: Kind) -> int:
        if self._free_nodes:
            node = self._free_nodes.pop()
            self.terms[node], self.kind[node] = term, kind
        else:
            node = len(self.terms)
            self.terms.append(term)
            self.kind.append(kind)
            self._places.append(NONE)
            self.out.heads.append(NONE)
            self.into.heads.append(NONE)
        self.numbers[term] = node
        if kind.mask and kind.excluded is None:
            self.file(node, kind, kind)
        return node

    def is_bare(self, node: int) -> bool:
        """Whether a node has no edges."""
        return self.out.heads[node] == NONE and self.into.heads[node] == NONE

    def release(self, node: int) -> bool:
        """Forget a node that nothing is said of any more; whether it was forgotten."""
        kind = self.kind[node]
        told = kind.excluded is None and kind.given
        if told or not self.is_bare(node):
            return False
        self.file(node, kind, None)
        del self.numbers[self.terms[node]]
        self.terms[node] = ""
        self._free_nodes.append(node)
        return True

    def file(self, node: int, old: Kind, new: Kind | None) -> None:
        """List an individual under its new kind instead of its old one; with None no more."""
        place = self._places[node]
        if place != NONE:
            nodes = old.nodes
            last = nodes.pop()
            if last != node:
                nodes[place] = last
                self._places[last] = place
            self._places[node] = NONE
        if new is not None:
            self._places[node] = len(new.nodes)
            new.nodes.append(node)

    # Edges

    def add(self, subject: int, predicate: int, object_: int, source: int) -> int:
        """Store a new edge."""
        if not self._free_edges:
            self._make_room()
        edge = self._free_edges.pop()
        self.subject[edge], self.predicate[edge], self.object[edge] = subject, predicate, object_
        self.source[edge] = source
        self.out.link(subject, edge, predicate)
        self.into.link(object_, edge, predicate)
        return edge

    def write(self, layout: Layout, individuals: Iterable[Term], others: Iterable[Term]) -> None:
        """Add new individuals with their edges, all of which leave from them."""
        new, numbers = self._new, self.numbers
        nodes = [new(term, kind) for term, kind in zip(individuals, layout.kinds, strict=True)]
        out, into = self.out, self.into
        edges = layout.edges
        while len(self._free_edges) < len(edges):
            self._make_room()
        left = len(self._free_edges) - len(edges)
        ids = self._free_edges[left:]
        del self._free_edges[left:]
        ids.append(NONE)  # which is also its index
        for node, first in zip(nodes, layout.heads, strict=True):
            out.heads[node] = ids[first]
        for term, kind in zip(others, layout.others, strict=True):
            node = numbers.get(term, NONE)
            nodes.append(new(term, kind) if node == NONE else node)
        for edge, (s, p, o, source, after, before, group) in zip(ids, edges, strict=False):
            node = nodes[o]
            self.subject[edge], self.predicate[edge], self.object[edge] = nodes[s], p, node
            self.source[edge] = source
            out.after[edge], out.before[edge], out.group[edge] = ids[after], ids[before], ids[group]
            if into.heads[node] == NONE:
                into.heads[node] = edge
                into.after[edge] = into.before[edge] = into.group[edge] = NONE
            else:
                into.link(node, edge, p)

    def _make_room(self) -> None:
        edges = range(len(self.subject), len(self.subject) + BLOCK)
        room = array("i", [NONE]) * BLOCK
        for column in (self.subject, self.predicate, self.object):
            column.extend(room)
        for side in (self.out, self.into):
            for column in (side.after, side.before, side.group):
                column.extend(room)
        self.source.extend(bytes(BLOCK))
        self._free_edges.extend(reversed(edges))

    def remove(self, edge: int) -> None:
        """Forget an edge."""
        self.out.unlink(self.subject[edge], edge)
        self.into.unlink(self.object[edge], edge)
        self.predicate[edge] = NONE
        self._free_edges.append(edge)

    def edge(self, subject: int, predicate: int, object_: int) -> int:
        """The edge of a triple, or NONE. Costs as much as the shorter of the two lists it is in."""
        if self.out.heads[subject] == NONE or self.into.heads[object_] == NONE:
            return NONE
        leaving, entering = self.out.of(subject, predicate), self.into.of(object_, predicate)
        for one, other in zip(leaving, entering, strict=False):
            if self.object[one] == object_:
                return one
            if self.subject[other] == subject:
                return other
        return NONE
