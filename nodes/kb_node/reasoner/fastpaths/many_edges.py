"""Many edges at once: stored column by column, and looked at singly only where something may follow.

From most edges nothing follows that is not there already: a cup is on a table, and both are in the kitchen.
That is found out for a whole column with a few look-ups each. What is left of a column, and the individuals
whose new classes say something of their other edges, is work for the rules like any other.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence, Set
from typing import NamedTuple

from nodes.kb_node.reasoner.abox.abox import ABox
from nodes.kb_node.reasoner.abox.adjacency import NONE, Adjacency
from nodes.kb_node.reasoner.abox.kinds import Kind
from nodes.kb_node.reasoner.abox.steps import EdgeRules, Step
from nodes.kb_node.reasoner.abox.store import VALUE, Store
from nodes.kb_node.reasoner.explanations import Term, Triple
from nodes.kb_node.reasoner.tbox.axioms import DIFFERENT, Chain, Group, Role
from nodes.kb_node.reasoner.terms import TYPE

Pairs = set[tuple[int, int]]


class Column(NamedTuple):
    """Edges of one predicate, which are new."""

    predicate: int
    triples: Sequence[Triple]
    subjects: Sequence[int]
    objects: Sequence[int]

    def at(self, places: Sequence[int]) -> Column:
        """Those at some places."""
        triples = [self.triples[place] for place in places]
        subjects, objects = ([ends[place] for place in places] for ends in (self.subjects, self.objects))
        return Column(self.predicate, triples, subjects, objects)


class ManyEdges:
    """Puts many edges into an ABox in which no nodes are the same."""

    def __init__(self, abox: ABox) -> None:
        self._abox = abox

    def insert(self, triples: Iterable[Triple], source: int) -> tuple[list[Triple], list[Triple]]:
        """Store triples; those that were, and those that must be inserted one by one.

        What may follow from them is put on the agenda, when all of them are there.
        """
        abox, store = self._abox, self._abox.store
        columns: list[Column] = []
        others: list[Triple] = []
        for term, said in _by_predicate(triples).items():
            predicate = abox.schema.find_property(term)
            if term == TYPE or predicate is None or predicate <= DIFFERENT:
                others += said
            else:
                columns.append(_column(store, predicate, said))
        before = self._before(columns)
        for at, column in enumerate(columns):
            if known := self._known(column, before):
                others += [column.triples[place] for place in sorted(known)]
                columns[at] = column.at([place for place in range(len(column.triples)) if place not in known])
        self._put(columns, before, source)
        return [triple for column in columns for triple in column.triples], others

    def _put(self, columns: Sequence[Column], before: _Ends, source: int) -> None:
        """Store edges that are new, and the values that come with the classes that these give."""
        abox = self._abox
        edges = [self._store(column, before, source) for column in columns]
        following = _Following(abox, columns, before)
        for column, stored in zip(columns, edges, strict=True):
            abox.fresh += [stored[place] for place in sorted(following.doubtful(column, stored))]
        if following.valued:
            values = list(self._values(following.valued))
            self._put(values, self._before(values), VALUE)

    def _store(self, column: Column, before: _Ends, source: int) -> Sequence[int]:
        predicate, subjects = column.predicate, column.subjects
        different = set(subjects)
        is_first = len(different) == len(subjects) and different.isdisjoint(
            before.subjects.get(predicate, ())
        )
        return self._abox.store.add_each(predicate, subjects, column.objects, source, is_first=is_first)

    def _values(self, nodes: Iterable[int]) -> Iterator[Column]:
        """The edges that the classes of nodes come with (cls-hv1), and that nothing else implies."""
        abox, store = self._abox, self._abox.store
        having: dict[tuple[int, Term], list[int]] = {}
        for node in nodes:
            for said in store.kind[node].values:
                having.setdefault(said, []).append(node)
        for (predicate, term), owners in having.items():
            group, value = abox.steps.group((predicate, False)), store.node(term)
            may_have = _Ends.of(store, owners, {*group.out, *group.into}).along(group)
            without = [
                node
                for node in owners
                if node not in may_have or abox.find(node, (predicate, False), value) == NONE
            ]
            yield Column(predicate, (), without, [value] * len(without))

    def _before(self, columns: Iterable[Column]) -> _Ends:
        """What the ends of columns have that matters, before the columns are stored."""
        nodes = set[int]().union(*(ends for column in columns for ends in (column.subjects, column.objects)))
        return _Ends.of(self._abox.store, nodes, self._looked_for(columns))

    def _looked_for(self, columns: Iterable[Column]) -> set[int]:
        """The predicates of edges that matter to whether something follows from new ones."""
        steps = self._abox.steps
        found = {column.predicate for column in columns}
        for column in columns:
            for role in _roles_beside(steps.rules(column.predicate)):
                group = steps.group(role)
                found.update(group.out, group.into)
        return found

    def _known(self, column: Column, before: _Ends) -> set[int]:
        """The places in a column of edges that are there already."""
        predicate = column.predicate
        subjects, edge = before.subjects.get(predicate, ()), self._abox.store.edge
        if not subjects:
            return set()
        ends = enumerate(zip(column.subjects, column.objects, strict=True))
        return {at for at, (s, o) in ends if s in subjects and edge(s, predicate, o) != NONE}


class _Ends(NamedTuple):
    """Which of some nodes are subjects of an edge with a predicate, and which are objects."""

    subjects: dict[int, set[int]]
    """By the predicate."""
    objects: dict[int, set[int]]

    @classmethod
    def of(cls, store: Store, nodes: Iterable[int], predicates: Set[int]) -> _Ends:
        """As the store is; of other predicates nothing is told."""
        return cls(_having(store.out, nodes, predicates), _having(store.into, nodes, predicates))

    def along(self, group: Group) -> set[int]:
        """The nodes from which edges of a group lead."""
        found = set[int]().union(*(self.subjects.get(p, ()) for p in group.out))
        return found.union(*(self.objects.get(p, ()) for p in group.into))

    def with_columns(self, columns: Iterable[Column]) -> _Ends:
        """The same with the edges of columns."""
        subjects, objects = self.subjects.copy(), self.objects.copy()
        for column in columns:
            subjects[column.predicate] = subjects.get(column.predicate, set()).union(column.subjects)
            objects[column.predicate] = objects.get(column.predicate, set()).union(column.objects)
        return _Ends(subjects, objects)


class _Following:
    """What may follow from new edges, which are in the store. They go by their places in a column."""

    def __init__(self, abox: ABox, columns: Sequence[Column], before: _Ends) -> None:
        self._abox = abox
        self._columns = columns
        self._before = before
        self._now = before.with_columns(columns)
        self._implied: dict[int, Pairs] = {}
        self.valued: dict[int, None] = {}
        """Those whose classes come with values; nobody else will look at them."""

    def doubtful(self, column: Column, edges: Sequence[int]) -> set[int]:
        """The edges that the rules must look at; the kinds of all ends are widened."""
        found = self._widen(column, edges)
        rules = self._abox.steps.rules(column.predicate)
        if rules is None:
            return found
        if rules.limits:
            is_alone = self._abox.store.out.is_alone
            return found.union(
                at for at, edge in enumerate(edges) if not (rules.of_values and is_alone(edge))
            )
        found.update(self._excluded(column, rules))
        if rules.irreflexive:
            ends = zip(column.subjects, column.objects, strict=True)
            found.update(at for at, (s, o) in enumerate(ends) if s == o)
        for is_head, chains in ((True, rules.heads), (False, rules.tails)):
            for forwards, chain in chains:
                found.update(self._unconcluded(column, chain, is_head, forwards))
        return found

    def _widen(self, column: Column, edges: Sequence[int]) -> set[int]:
        """Widen the kinds of the ends; which edges say more than that."""
        abox = self._abox
        kind_of = abox.store.kind.__getitem__
        kinds = list(zip(map(kind_of, column.subjects), map(kind_of, column.objects), strict=True))
        steps = {pair: abox.steps.step(column.predicate, *pair) for pair in set(kinds)}
        for which, ends in ((0, column.subjects), (1, column.objects)):
            masks = {
                pair: now.mask
                for pair, step in steps.items()
                if (now := (step.subject, step.object)[which]) is not pair[which]
            }
            if masks:
                wider = {(node, masks[pair]) for node, pair in zip(ends, kinds, strict=True) if pair in masks}
                for node, mask in wider:
                    self._widen_one(node, mask)
        special = {pair for pair, step in steps.items() if step.special or pair[1].excluded is not None}
        return {
            at
            for at, pair in enumerate(kinds if special else ())
            if pair in special and not self._is_all_told(steps[pair], pair, edges[at])
        }

    def _widen_one(self, node: int, mask: int) -> None:
        """Widen a kind; nobody needs to look at the node's edges if what is new says nothing of them."""
        abox, store = self._abox, self._abox.store
        before, is_awaited = store.kind[node], node in abox.dirty
        abox.widen(node, mask)
        now = store.kind[node]
        if is_awaited or now is before or now.clash:
            return
        new = now.mask & ~before.mask
        concerned = abox.steps.concerned
        if not any(
            concerned(p)[which] & new
            for which, side in enumerate((store.out, store.into))
            for p in side.firsts(node)
        ):
            del abox.dirty[node]
            if now.values != before.values:
                self.valued[node] = None

    def _is_all_told(self, step: Step, pair: tuple[Kind, Kind], edge: int) -> bool:
        """Whether a step of an edge is made when the kinds are widened."""
        is_plain = not step.special or (step.of_values and self._abox.store.out.is_alone(edge))
        return is_plain and pair[1].excluded is None

    def _excluded(self, column: Column, rules: EdgeRules) -> Iterator[int]:
        """The edges beside which there is one that must not be."""
        abox = self._abox
        others = [other for _, other in rules.exclusive]
        groups = [abox.steps.group(other) for other in others]
        subjects = set(column.subjects)
        may_have = set[int]().union(*(subjects & self._now.along(group) for group in groups))
        if may_have:
            for at, (s, o) in enumerate(zip(column.subjects, column.objects, strict=True)):
                if s in may_have and any(abox.find(s, other, o) != NONE for other in others):
                    yield at

    def _unconcluded(self, column: Column, chain: Chain, is_head: bool, forwards: bool) -> Iterator[int]:
        """The edges that begin a chain, or end it, whose conclusion is not there."""
        abox = self._abox
        group = abox.steps.group(_role_beside(chain, is_head))
        ends = column.subjects, column.objects
        outer, middle = ends if is_head == forwards else ends[::-1]
        # a new edge that it ends is among those that begin it
        joined = (self._now if is_head else self._before).along(group).intersection(middle)
        if not joined:
            return
        beyond = {node: [end for _, _, end in abox.related(node, group)] for node in joined}
        there = self._pairs(chain.result)
        for at, (node, between) in enumerate(zip(outer, middle, strict=True)):
            for end in beyond.get(between, ()):
                pair = (node, end) if is_head else (end, node)
                if pair not in there and abox.find(pair[0], (chain.result, False), pair[1]) == NONE:
                    yield at
                    break

    def _pairs(self, result: int) -> Pairs:
        """Between whom the new edges imply a property."""
        if (found := self._implied.get(result)) is None:
            group = self._abox.steps.group((result, False))
            found = self._implied[result] = set()
            for column in self._columns:
                if column.predicate in group.out:
                    found.update(zip(column.subjects, column.objects, strict=True))
                if column.predicate in group.into:
                    found.update(zip(column.objects, column.subjects, strict=True))
        return found


def _by_predicate(triples: Iterable[Triple]) -> dict[Term, list[Triple]]:
    found: dict[Term, list[Triple]] = {}
    for triple in triples:
        if (said := found.get(triple[1])) is None:
            found[triple[1]] = [triple]
        else:
            said.append(triple)
    return found


def _column(store: Store, predicate: int, triples: list[Triple]) -> Column:
    """Each triple once; nodes are made for new terms."""
    number = store.numbers.__getitem__
    try:
        subjects, objects = [number(s) for s, _, _ in triples], [number(o) for _, _, o in triples]
    except KeyError:
        subjects, objects = [store.node(s) for s, _, _ in triples], [store.node(o) for _, _, o in triples]
    column = Column(predicate, triples, subjects, objects)
    places = dict(zip(zip(subjects, objects, strict=True), range(len(triples)), strict=True))
    return column if len(places) == len(triples) else column.at(list(places.values()))


def _roles_beside(rules: EdgeRules | None) -> Iterator[Role]:
    """The roles of other edges that rules look for."""
    if rules is not None:
        yield from (other for _, other in rules.exclusive)
        yield from (_role_beside(chain, True) for _, chain in rules.heads)
        yield from (_role_beside(chain, False) for _, chain in rules.tails)


def _role_beside(chain: Chain, is_head: bool) -> Role:
    """How a chain goes on from the middle, seen from its first edge or else its second."""
    return (chain.second, False) if is_head else (chain.first, True)


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
