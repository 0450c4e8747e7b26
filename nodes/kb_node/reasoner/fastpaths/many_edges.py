"""Bulk insertion of edges: stored column by column, and processed singly only if a rule may be violated.

Most edges imply little that is new: a cup is on a table, and both are already in the kitchen.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from semmap.nodes.kb_node.reasoner.abox.abox import ABox
from semmap.nodes.kb_node.reasoner.abox.adjacency import NONE
from semmap.nodes.kb_node.reasoner.abox.store import Store
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.fastpaths.column_inference import ColumnInference, relevant_predicates
from semmap.nodes.kb_node.reasoner.fastpaths.edge_columns import Column, Ends, ends_of
from semmap.nodes.kb_node.reasoner.tbox.axioms import DIFFERENT
from semmap.nodes.kb_node.reasoner.terms import TYPE


class ManyEdges:
    """Inserts many edges into an ABox without equal nodes."""

    def __init__(self, abox: ABox) -> None:
        self._abox = abox

    def insert(self, triples: Iterable[Triple], source: int) -> tuple[list[Triple], list[Triple]]:
        """Store triples; return those that were stored, and those that must be inserted one by one.

        Their conclusions are stored, or will be when the rules run.
        """
        abox = self._abox
        columns: list[Column] = []
        others: list[Triple] = []
        for term, group in _by_predicate(triples).items():
            predicate = abox.schema.find_property(term)
            if term == TYPE or predicate is None or predicate <= DIFFERENT:
                others += group
            else:
                columns.append(_column(abox.store, predicate, source, group))
        before = self._before(columns)
        for at, column in enumerate(columns):
            if known := self._known(column, before):
                others += [column.triples[place] for place in sorted(known)]
                columns[at] = column.at([place for place in range(len(column.triples)) if place not in known])
        stored = [triple for column in columns for triple in column.triples]
        while columns:
            columns = self._store_and_infer(columns, before)
            before = self._before(columns)
        return stored, others

    def _store_and_infer(self, columns: Sequence[Column], before: Ends) -> list[Column]:
        """Store new edges; return the edges that follow and must be stored next."""
        abox = self._abox
        edges = [self._store(column, before) for column in columns]
        inference = ColumnInference(abox, columns, before)
        for column, stored in zip(columns, edges, strict=True):
            doubtful = inference.apply_rules(column, stored)
            abox.fresh += [stored[place] for place in sorted(doubtful)]
        return list(inference.conclusions())

    def _store(self, column: Column, before: Ends) -> Sequence[int]:
        abox, predicate, subjects = self._abox, column.predicate, column.subjects
        each, having = set(subjects), before.subjects.get(predicate, ())
        edges = abox.store.add_each(
            predicate,
            subjects,
            column.objects,
            column.source,
            is_first=len(each) == len(subjects) and each.isdisjoint(having),
        )
        for edge, claims in zip(edges, column.claims, strict=False):
            abox.reasons[edge] = abox.conclude(claims, edge=edge)
        return edges

    def _before(self, columns: Iterable[Column]) -> Ends:
        """Return the relevant edges of the ends of columns before the columns are stored."""
        return Ends.of(self._abox.store, ends_of(columns), relevant_predicates(self._abox, columns))

    def _known(self, column: Column, before: Ends) -> set[int]:
        """Return the places of edges that already exist."""
        predicate = column.predicate
        subjects, edge = before.subjects.get(predicate, ()), self._abox.store.edge
        if not subjects:
            return set()
        ends = enumerate(zip(column.subjects, column.objects, strict=True))
        return {at for at, (s, o) in ends if s in subjects and edge(s, predicate, o) != NONE}


def _by_predicate(triples: Iterable[Triple]) -> dict[Term, list[Triple]]:
    found: dict[Term, list[Triple]] = {}
    for triple in triples:
        if (group := found.get(triple[1])) is None:
            found[triple[1]] = [triple]
        else:
            group.append(triple)
    return found


def _column(store: Store, predicate: int, source: int, triples: list[Triple]) -> Column:
    """Return a column without duplicates. Creates nodes for new terms."""
    number = store.numbers.__getitem__
    try:
        subjects, objects = [number(s) for s, _, _ in triples], [number(o) for _, _, o in triples]
    except KeyError:
        subjects, objects = [store.node(s) for s, _, _ in triples], [store.node(o) for _, _, o in triples]
    column = Column(predicate, source, subjects, objects, triples)
    places = dict(zip(zip(subjects, objects, strict=True), range(len(triples)), strict=True))
    return column if len(places) == len(triples) else column.at(list(places.values()))
