"""Edges of one predicate as columns, and the nodes that have edges of a predicate."""

from __future__ import annotations

from collections.abc import Iterable, Sequence, Set
from typing import NamedTuple

from semmap.nodes.kb_node.reasoner.abox.adjacency import NONE, Adjacency
from semmap.nodes.kb_node.reasoner.abox.store import Store
from semmap.nodes.kb_node.reasoner.explain.reasons import Edge
from semmap.nodes.kb_node.reasoner.explanations import Triple
from semmap.nodes.kb_node.reasoner.tbox.axioms import Group


class Column(NamedTuple):
    """Edges of one predicate and source. A place is the position of an edge in the column."""

    predicate: int
    source: int
    subjects: Sequence[int]
    objects: Sequence[int]
    triples: Sequence[Triple] = ()
    """The triples, for edges that were inserted."""
    claims: Sequence[tuple[Edge, Edge]] = ()
    """The reasons, for edges derived by a chain."""

    def at(self, places: Sequence[int]) -> Column:
        """Return the inserted edges at some places."""
        subjects, objects = ([ends[place] for place in places] for ends in (self.subjects, self.objects))
        triples = [self.triples[place] for place in places]
        return self._replace(subjects=subjects, objects=objects, triples=triples)


class Ends(NamedTuple):
    """The nodes that are subjects or objects of an edge with a predicate."""

    subjects: dict[int, set[int]]
    """Nodes by predicate."""
    objects: dict[int, set[int]]

    @classmethod
    def of(cls, store: Store, nodes: Iterable[int], predicates: Set[int]) -> Ends:
        """Return the ends among some nodes in the store, for the given predicates only."""
        return cls(_having(store.out, nodes, predicates), _having(store.into, nodes, predicates))

    def along(self, group: Group) -> set[int]:
        """Return the nodes that have edges of a group."""
        found = set[int]().union(*(self.subjects.get(p, ()) for p in group.out))
        return found.union(*(self.objects.get(p, ()) for p in group.into))

    def with_columns(self, columns: Iterable[Column]) -> Ends:
        """Return the ends together with those of columns."""
        subjects, objects = self.subjects.copy(), self.objects.copy()
        for column in columns:
            subjects[column.predicate] = subjects.get(column.predicate, set()).union(column.subjects)
            objects[column.predicate] = objects.get(column.predicate, set()).union(column.objects)
        return Ends(subjects, objects)


def ends_of(columns: Iterable[Column]) -> set[int]:
    """Return the subjects and objects of columns."""
    return set[int]().union(*(ends for column in columns for ends in (column.subjects, column.objects)))


def _having(side: Adjacency, nodes: Iterable[int], predicates: Set[int]) -> dict[int, set[int]]:
    """Return the nodes that have an edge of a predicate, by predicate."""
    found: dict[int, set[int]] = {}
    heads, group, column = side.heads, side.group, side.predicate
    for node in nodes:
        edge = heads[node]
        while edge != NONE:  # this runs for every node of a load
            if (predicate := column[edge]) in predicates:
                found.setdefault(predicate, set()).add(node)
            edge = group[edge]
    return found
