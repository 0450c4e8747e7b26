"""The ABox in columns: terms by number, edges as linked lists, nothing that can be worked out.

A *node* is the number of an individual or literal. An *edge* is the number of a row subject, predicate,
object. Freed numbers are used again.
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
"""Nodes or edges that room is made for at once."""
VALUE, DERIVED, COMPUTED = 1, 2, 3
"""Where an edge comes from if it is not ASSERTED: a class that has a value (cls-hv1), another rule, or no
rule at all. A computed one is given like an asserted one, and was not said."""
GIVEN: Final = frozenset((ASSERTED, COMPUTED))
"""Edges that rest on no other."""


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
        """Where an individual is among those of its kind; `NONE` for one that is listed nowhere."""
        self.log: list[tuple[int, int, int]] | None = None
        """While somebody wants to know: the edges that were added or removed."""
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
        kind = kinds.literal(term) if is_literal(term) else kinds.individual(term)
        node = self._free_nodes_for(1).pop()
        self.terms[node], self.kind[node], self.numbers[term] = term, kind, node
        if kind.mask and kind.excluded is None:
            self.list_under_kind(node, kind, kind)
        return node

    def _free_nodes_for(self, count: int) -> list[int]:
        """At least so many free numbers to pop; such nodes are bare and filed nowhere."""
        free = self._free_nodes
        while len(free) < count:
            free.extend(reversed(self._more_nodes(BLOCK)))
        return free

    def _more_nodes(self, count: int) -> range:
        """Make room for so many nodes."""
        first, room = len(self.terms), array("i", [NONE]) * count
        self.terms.extend([""] * count)
        self.kind.extend([self._kinds.nothing] * count)
        for column in (self.places, self.out.heads, self.into.heads):
            column.extend(room)
        return range(first, first + count)

    def is_bare(self, node: int) -> bool:
        """Whether a node has no edges."""
        return self.out.heads[node] == NONE and self.into.heads[node] == NONE

    def release(self, node: int) -> bool:
        """Forget a node without edges or asserted classes; returns whether it was forgotten."""
        kind = self.kind[node]
        told = kind.excluded is None and kind.given
        if told or not self.is_bare(node):
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
        """List an individual under its new kind instead of its old one; with None no more."""
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
        """For how many nodes or edges, whichever is more, there is room between others."""
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
        """Add new individuals with their edges, all of which leave from them.

        What is zipped is of one length by the layout; to make sure of it takes a thirtieth of an add.
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
        """Like `write` for many, in new rows side by side; the other objects are there, and told as nodes.

        `individuals` and `others` are column by column.
        """
        count, width, length = len(individuals[0]), len(layout.kinds), len(layout.edges)
        rows, edges = self._more_nodes(count * width), self._more_edges(count * length)
        _put(self.kind, rows, layout.kinds * count)
        _put(self.predicate, edges, [p for _, p, _ in layout.edges] * count)
        nodes: list[list[int]] = []  # of the same objects wherever a number stands, for memory's sake
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
            if o < width and o not in entered:  # nothing leads to a new individual yet
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
        """Like `add` for many new edges of one predicate; `is_first` if each is its subject's only one."""
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
        """The nodes of literals, of known kinds, that edges will enter; room is made for new ones."""
        nodes = dict(zip(kinds, map(self.numbers.get, kinds), strict=True))
        new = [term for term, node in nodes.items() if node is None]
        rows = self._more_nodes(len(new))
        made = dict(zip(new, rows, strict=True))
        self.numbers.update(made)
        _put(self.terms, rows, new)
        _put(self.kind, rows, [kinds[term] for term in new])
        return {term: made[term] if node is None else node for term, node in nodes.items()}

    def _free_edges_for(self, count: int) -> list[int]:
        """At least so many free numbers to pop; such edges are in no list, and asserted."""
        free = self._free_edges
        while len(free) < count:
            free.extend(reversed(self._more_edges(BLOCK)))
        return free

    def _more_edges(self, count: int) -> range:
        """Make room for so many edges."""
        first, room = len(self.subject), array("i", [NONE]) * count
        for row in (self.subject, self.predicate, self.object):
            row.extend(room)
        for side in (self.out, self.into):
            for column in (side.after, side.before, side.group):
                column.extend(room)
        self.source.extend(bytes(count))
        return range(first, first + count)

    def remove(self, edge: int) -> None:
        """Forget an edge."""
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
        """Let an edge lead to another literal, and forget the old one if nobody has it any more."""
        old = self.object[edge]
        self.into.unlink(old, edge)
        if self.into.heads[old] == NONE:
            self._forget(old)
        self.object[edge] = node = self.node(term)
        self.into.link(node, edge, self.predicate[edge])

    def fill(self, columns: Columns, kinds: Iterable[Kind], properties: Sequence[int]) -> None:
        """Be what columns say instead, with these kinds of the nodes, and these numbers of the properties."""
        terms, number = columns.terms, list(range(max(len(columns.terms), len(columns.subject)))).__getitem__
        self.terms[:] = terms  # and the numbers are the same objects wherever they stand, for memory's sake
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
        """Forget individuals and all edges that leave from them, where no other enters."""
        object_, predicate, source = self.object, self.predicate, self.source
        into, heads, into_after, into_group = self.into, self.into.heads, self.into.after, self.into.group
        after, before, group = self.out.after, self.out.before, self.out.group
        for edge in edges:  # `clear` and `remove` written out: robots remove things all day
            node = object_[edge]
            if heads[node] == edge and into_after[edge] == NONE and into_group[edge] == NONE:  # as most are
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
        """The edge of a triple, or NONE. Costs as much as the shorter of the two lists it is in."""
        leaving = self.out.first(subject, predicate)
        if leaving == NONE:
            return NONE
        return self._edge(subject, object_, leaving, self.into.first(object_, predicate))

    def edge_of(self, subject: int, predicates: tuple[int, ...], object_: int) -> int:
        """The first edge of two with one of some predicates, or NONE."""
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
        """The one among the edges that leave and that enter, from two of one predicate on."""
        subjects, objects, after, before = self.subject, self.object, self.out.after, self.into.after
        while leaving != NONE and entering != NONE:
            if objects[leaving] == object_:
                return leaving
            if subjects[entering] == subject:
                return entering
            leaving, entering = after[leaving], before[entering]
        return NONE


def _put(column: MutableSequence[Any], rows: range, values: Iterable[Any]) -> None:
    """Write values into rows at equal distances."""
    if isinstance(column, array):
        values = array("i", values)
    column[rows.start : rows.stop : rows.step] = values
