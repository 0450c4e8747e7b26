"""Edges of one predicate as columns, and which nodes have edges of what predicates."""

from __future__ import annotations

from collections.abc import Iterable, Sequence, Set
from typing import NamedTuple

from semmap.nodes.kb_node.reasoner.abox.adjacency import NONE, Adjacency
from semmap.nodes.kb_node.reasoner.abox.store import Store
from semmap.nodes.kb_node.reasoner.explain.reasons import Edge
from semmap.nodes.kb_node.reasoner.explanations import Triple
from semmap.nodes.kb_node.reasoner.tbox.axioms import Group


class Column(NamedTuple):
    """Edges of one predicate and source. A place counts the edges of a column."""

    predicate: int
    source: int
    subjects: Sequence[int]
    objects: Sequence[int]
    triples: Sequence[Triple] = ()
    """Of those that were given: what was said."""
    claims: Sequence[tuple[Edge, Edge]] = ()
    """Of those that a chain makes: what each rests on."""

    def at(self, places: Sequence[int]) -> Column:
        """The given ones at some places."""
        subjects, objects = ([ends[place] for place in places] for ends in (self.subjects, self.objects))
        triples = [self.triples[place] for place in places]
        return self._replace(subjects=subjects, objects=objects, triples=triples)


class Ends(NamedTuple):
    """Which nodes are subjects of an edge with a predicate, and which are objects."""

    subjects: dict[int, set[int]]
    """By the predicate."""
    objects: dict[int, set[int]]

    @classmethod
    def of(cls, store: Store, nodes: Iterable[int], predicates: Set[int]) -> Ends:
        """Of some nodes as the store is; of other predicates nothing is told."""
        return cls(_having(store.out, nodes, predicates), _having(store.into, nodes, predicates))

    def along(self, group: Group) -> set[int]:
        """The nodes from which edges of a group lead."""
        found = set[int]().union(*(self.subjects.get(p, ()) for p in group.out))
        return found.union(*(self.objects.get(p, ()) for p in group.into))

    def with_columns(self, columns: Iterable[Column]) -> Ends:
        """The same with the edges of columns."""
        subjects, objects = self.subjects.copy(), self.objects.copy()
        for column in columns:
            subjects[column.predicate] = subjects.get(column.predicate, set()).union(column.subjects)
            objects[column.predicate] = objects.get(column.predicate, set()).union(column.objects)
        return Ends(subjects, objects)


def ends_of(columns: Iterable[Column]) -> set[int]:
    """The subjects and objects of columns."""
    return set[int]().union(*(ends for column in columns for ends in (column.subjects, column.objects)))


def _having(side: Adjacency, nodes: Iterable[int], predicates: Set[int]) -> dict[int, set[int]]:
    """The nodes that have an edge with a predicate, by that."""
    found: dict[int, set[int]] = {}
    heads, group, column = side.heads, side.group, side.predicate
    for node in nodes:
        edge = heads[node]
        while edge != NONE:  # this runs for every node of a load
            if (predicate := column[edge]) in predicates:
                found.setdefault(predicate, set()).add(node)
            edge = group[edge]
    return found
