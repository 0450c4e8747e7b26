"""Edges in columns: linked lists of the edges of a node, grouped by predicate.

The walls of a room with 10 000 parts are found without visiting the parts.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Iterator, Sequence
from typing import Final

NONE: Final = -1


class Adjacency:
    """The edges that leave (or enter) each node, in groups of one predicate.

    `heads[node]` is the first edge of the node's first group. `group[edge]` is the first edge of the next
    group. `after` and `before` link the edges of a group. All are NONE for an edge that is in no list.
    """

    __slots__ = ("after", "before", "group", "heads", "predicate")

    def __init__(self, predicate: list[int]) -> None:
        self.predicate = predicate
        self.heads = array("i")
        self.after = array("i")
        self.before = array("i")
        self.group = array("i")

    def link(self, node: int, edge: int, predicate: int) -> None:
        """Insert an edge, whose predicate is already set, into the list of a node."""
        head = first = self.heads[node]
        if head == NONE:
            self.heads[node] = edge
            return
        column, group = self.predicate, self.group
        while first != NONE and column[first] != predicate:
            first = group[first]
        if first == NONE:
            group[edge] = head
            self.heads[node] = edge
            return
        # after the first edge of its group, so that the chain of groups does not change
        second = self.after[first]
        self.after[first], self.before[edge] = edge, first
        if second != NONE:
            self.after[edge] = second
            self.before[second] = edge

    def link_each(self, nodes: Sequence[int], edges: range, predicate: int) -> None:
        """Do `link` for each node and its new edge, whose predicate is already set."""
        if len(nodes) > 1 and nodes.count(nodes[0]) == len(nodes):
            self._link_all(nodes[0], edges, predicate)
            return
        heads, column, group = self.heads, self.predicate, self.group
        after, before = self.after, self.before
        for node, edge in zip(nodes, edges, strict=True):  # `link` inlined: this runs millions of times
            head = first = heads[node]
            while first != NONE and column[first] != predicate:
                first = group[first]
            if first == NONE:
                if head != NONE:
                    group[edge] = head
                heads[node] = edge
                continue
            second = after[first]
            after[first], before[edge] = edge, first
            if second != NONE:
                after[edge] = second
                before[second] = edge

    def link_firsts(self, nodes: Sequence[int], edges: range) -> None:
        """Do `link` for different nodes that have no edge of the predicate yet."""
        heads = self.heads
        self.group[edges.start : edges.stop] = array("i", map(heads.__getitem__, nodes))
        for node, edge in zip(nodes, edges, strict=True):
            heads[node] = edge

    def _link_all(self, node: int, edges: range, predicate: int) -> None:
        """Do `link` for many edges of one node. The result is the same as for single calls."""
        self.link(node, edges[0], predicate)
        first = self.heads[node]
        while self.predicate[first] != predicate:
            first = self.group[first]
        after, before, rest = self.after, self.before, edges[1:]
        second, newest, oldest = after[first], rest[-1], rest[0]
        after[first], before[newest] = newest, first
        later, earlier = rest[1:], rest[:-1]
        after[later.start : later.stop : later.step] = array("i", earlier)
        before[earlier.start : earlier.stop : earlier.step] = array("i", later)
        if second != NONE:
            after[oldest] = second
            before[second] = oldest

    def unlink(self, node: int, edge: int) -> None:
        """Remove an edge from the list of a node."""
        before, after = self.before[edge], self.after[edge]
        if after != NONE:
            self.before[after] = before
            self.after[edge] = NONE
        if before != NONE:
            self.after[before] = after
            self.before[edge] = NONE
            return
        group = self.group
        next_group = replacement = group[edge]
        if next_group != NONE:
            group[edge] = NONE
        if after != NONE:
            group[after] = next_group
            replacement = after
        first = self.heads[node]
        if first == edge:
            self.heads[node] = replacement
            return
        while group[first] != edge:
            first = group[first]
        group[first] = replacement

    def clear(self, edge: int) -> None:
        """Reset the links of an edge whose whole list is removed."""
        if self.after[edge] != NONE:
            self.after[edge] = NONE
        if self.before[edge] != NONE:
            self.before[edge] = NONE
        if self.group[edge] != NONE:
            self.group[edge] = NONE

    def is_alone(self, edge: int) -> bool:
        """Return whether a node has no other edge with the edge's predicate."""
        return self.before[edge] == NONE and self.after[edge] == NONE

    def first(self, node: int, predicate: int) -> int:
        """Return the first edge of a node with a predicate, or NONE."""
        edge, column, group = self.heads[node], self.predicate, self.group
        while edge != NONE and column[edge] != predicate:
            edge = group[edge]
        return edge

    def has_any(self, node: int, predicates: tuple[int, ...]) -> bool:
        """Return whether a node has an edge with one of some predicates."""
        edge, column, group = self.heads[node], self.predicate, self.group
        while edge != NONE:
            if column[edge] in predicates:
                return True
            edge = group[edge]
        return False

    def predicates(self, node: int) -> Iterator[int]:
        """Yield the predicates of a node's edges, each once."""
        edge = self.heads[node]
        while edge != NONE:
            yield self.predicate[edge]
            edge = self.group[edge]

    def firsts(self, node: int, predicates: tuple[int, ...]) -> list[int]:
        """Return the first edge of a node for each of some predicates, in the order of the predicates."""
        edge, column, group = self.heads[node], self.predicate, self.group
        found: list[int] = []
        while edge != NONE:
            if column[edge] in predicates:
                found.append(edge)
            edge = group[edge]
        if len(found) > 1:
            found.sort(key=lambda first: predicates.index(column[first]))
        return found

    def of(self, node: int, predicate: int) -> Iterator[int]:
        """Yield the edges of a node with a predicate."""
        edge = self.first(node, predicate)
        while edge != NONE:
            yield edge
            edge = self.after[edge]

    def among(self, node: int, predicates: tuple[int, ...]) -> Iterable[int]:
        """Return the edges of a node with one of some predicates, predicate by predicate."""
        if not predicates or self.heads[node] == NONE:
            return ()
        return self._among(node, predicates)

    def _among(self, node: int, predicates: tuple[int, ...]) -> Iterator[int]:
        after = self.after
        for edge in self.firsts(node, predicates):
            while edge != NONE:
                yield edge
                edge = after[edge]

    def gather(self, nodes: Iterable[int], most: int) -> list[int]:
        """Return all edges of some nodes. Stops after more than `most` edges."""
        heads, after, group = self.heads, self.after, self.group
        found: list[int] = []
        for node in nodes:
            first = heads[node]
            while first != NONE and len(found) <= most:
                edge = first
                while edge != NONE and len(found) <= most:
                    found.append(edge)
                    edge = after[edge]
                first = group[first]
        return found

    def all(self, node: int) -> Iterator[int]:
        """Yield all edges of a node."""
        first = self.heads[node]
        while first != NONE:
            edge = first
            while edge != NONE:
                yield edge
                edge = self.after[edge]
            first = self.group[first]
