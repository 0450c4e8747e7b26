"""Inference from new edges, column by column.

A rule is applied to all edges of a column with a few look-ups for each. This module computes wider kinds,
values implied by classes, and conclusions of chains. An edge that may imply more, or a contradiction, is
*doubtful*: the rules process it individually.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from semmap.nodes.kb_node.reasoner.abox.abox import ABox
from semmap.nodes.kb_node.reasoner.abox.adjacency import NONE
from semmap.nodes.kb_node.reasoner.abox.kinds import Kind
from semmap.nodes.kb_node.reasoner.abox.steps import EdgeRules, Step
from semmap.nodes.kb_node.reasoner.abox.store import DERIVED, VALUE
from semmap.nodes.kb_node.reasoner.explain.reasons import Edge
from semmap.nodes.kb_node.reasoner.explanations import Term
from semmap.nodes.kb_node.reasoner.fastpaths.edge_columns import Column, Ends
from semmap.nodes.kb_node.reasoner.tbox.axioms import Chain, Role

Pair = tuple[int, int]


class ColumnInference:
    """Inference from columns that are already stored, in an ABox without equal nodes."""

    def __init__(self, abox: ABox, columns: Sequence[Column], before: Ends) -> None:
        """`before` are the ends of the columns before they were stored, for all `relevant_predicates`."""
        self._abox = abox
        self._columns = columns
        self._before = before
        self._now = before.with_columns(columns)
        self._implied: dict[int, set[Pair]] = {}
        self._made: dict[int, dict[Pair, tuple[Edge, Edge]]] = {}
        self._valued: dict[int, None] = {}

    def apply_rules(self, column: Column, edges: Sequence[int]) -> Iterable[int]:
        """Widen the kinds of a column's ends, note its conclusions, and return the doubtful places."""
        doubtful = self._widen(column, edges)
        rules = self._abox.steps.rules(column.predicate)
        if rules is None:
            return doubtful
        if rules.implies_more:
            return range(len(edges))
        if rules.limits:
            is_alone = self._abox.store.out.is_alone
            return doubtful.union(
                at for at, edge in enumerate(edges) if not (rules.only_uniqueness and is_alone(edge))
            )
        doubtful.update(self._excluded(column, rules))
        if rules.irreflexive:
            ends = zip(column.subjects, column.objects, strict=True)
            doubtful.update(at for at, (s, o) in enumerate(ends) if s == o)
        for is_head, chains in ((True, rules.heads), (False, rules.tails)):
            for forwards, chain in chains:
                self._conclude(column, edges, chain, is_head, forwards)
        return doubtful

    def conclusions(self) -> Iterator[Column]:
        """Yield the edges that follow from the processed columns and do not exist."""
        for result, pairs in self._made.items():
            subjects, objects = zip(*pairs, strict=True)
            yield Column(result, DERIVED, subjects, objects, claims=list(pairs.values()))
        yield from self._values()

    def _values(self) -> Iterator[Column]:
        """Yield the edges that are implied by classes (cls-hv1) and by nothing else."""
        abox, store = self._abox, self._abox.store
        having: dict[tuple[int, Term], list[int]] = {}
        for node in self._valued:
            for implied in store.kind[node].values:
                having.setdefault(implied, []).append(node)
        for (predicate, term), owners in having.items():
            group, value = abox.steps.group((predicate, False)), store.node(term)
            may_have = Ends.of(store, owners, {*group.out, *group.into}).along(group)
            without = [
                node
                for node in owners
                if node not in may_have or abox.find(node, (predicate, False), value) == NONE
            ]
            if without:
                yield Column(predicate, VALUE, without, [value] * len(without))

    # Classes

    def _widen(self, column: Column, edges: Sequence[int]) -> set[int]:
        """Widen the kinds of the ends; return the edges that imply more."""
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
                pairs = zip(ends, kinds, strict=True)
                for node, mask in {(node, masks[pair]) for node, pair in pairs if pair in masks}:
                    self._widen_one(node, mask)
        special = {pair for pair, step in steps.items() if step.special or pair[1].excluded is not None}
        return {
            at
            for at, pair in enumerate(kinds if special else ())
            if pair in special and not self._is_done(steps[pair], pair, edges[at])
        }

    def _widen_one(self, node: int, mask: int) -> None:
        """Widen a kind. The node's edges are only processed again if its new classes affect them."""
        abox, store = self._abox, self._abox.store
        before, is_pending = store.kind[node], node in abox.dirty
        abox.widen(node, mask)
        now = store.kind[node]
        if is_pending or now is before or now.clash:
            return
        new = now.mask & ~before.mask
        relevant_classes = abox.steps.relevant_classes
        if not new & abox.schema.rule_classes and not any(
            relevant_classes(p)[which] & new
            for which, side in enumerate((store.out, store.into))
            for p in side.predicates(node)
        ):
            del abox.dirty[node]
            if now.values != before.values:
                self._valued[node] = None

    def _is_done(self, step: Step, pair: tuple[Kind, Kind], edge: int) -> bool:
        """Return whether a step needs nothing more after the kinds are widened."""
        is_plain = not step.special or (step.only_uniqueness and self._abox.store.out.is_alone(edge))
        return is_plain and pair[1].excluded is None

    # Pairs

    def _excluded(self, column: Column, rules: EdgeRules) -> Iterator[int]:
        """Yield the edges that coexist with an excluded one."""
        abox = self._abox
        others = [other for _, other in rules.exclusive]
        groups = [abox.steps.group(other) for other in others]
        subjects = set(column.subjects)
        may_have = set[int]().union(*(subjects & self._now.along(group) for group in groups))
        if may_have:
            for at, (s, o) in enumerate(zip(column.subjects, column.objects, strict=True)):
                if s in may_have and any(abox.find(s, other, o) != NONE for other in others):
                    yield at

    def _conclude(
        self, column: Column, edges: Sequence[int], chain: Chain, is_head: bool, forwards: bool
    ) -> None:
        """Note the conclusions of a chain that the edges start, or end."""
        abox, role = self._abox, _other_role(chain, is_head)
        group = abox.steps.group(role)
        ends = column.subjects, column.objects
        outer, middle = ends if is_head == forwards else ends[::-1]
        # pairs of new edges are found from the first edge
        joined = (self._now if is_head else self._before).along(group).intersection(middle)
        if not joined:
            return
        beyond = {node: [(end, edge) for edge, _, end in abox.related(node, group)] for node in joined}
        roles, result = ((chain.first, False), (chain.second, False)), (chain.result, False)
        there, made = self._pairs(chain.result), self._made.get(chain.result, {})
        for edge, node, between in zip(edges, outer, middle, strict=True):
            for end, other in beyond.get(between, ()):
                x, z = pair = (node, end) if is_head else (end, node)
                if (
                    pair not in there
                    and pair not in made
                    and not abox.is_literal(x)
                    and abox.find(x, result, z) == NONE
                ):
                    first, second = (edge, other) if is_head else (other, edge)
                    made[pair] = Edge(first, roles[0]), Edge(second, roles[1])
        if made:
            self._made[chain.result] = made

    def _pairs(self, result: int) -> set[Pair]:
        """Return the pairs for which the new edges imply a property."""
        if (found := self._implied.get(result)) is None:
            group = self._abox.steps.group((result, False))
            found = self._implied[result] = set()
            for column in self._columns:
                if column.predicate in group.out:
                    found.update(zip(column.subjects, column.objects, strict=True))
                if column.predicate in group.into:
                    found.update(zip(column.objects, column.subjects, strict=True))
        return found


def relevant_predicates(abox: ABox, columns: Iterable[Column]) -> set[int]:
    """Return the predicates of the columns, and of all edges that may affect their conclusions."""
    found: set[int] = set()
    for predicate in {column.predicate for column in columns}:
        found.add(predicate)
        for role in _other_roles(abox.steps.rules(predicate)):
            group = abox.steps.group(role)
            found.update(group.out, group.into)
    return found


def _other_roles(rules: EdgeRules | None) -> Iterator[Role]:
    """Yield the roles of other edges in the rules."""
    if rules is not None:
        yield from (other for _, other in rules.exclusive)
        yield from (_other_role(chain, True) for _, chain in rules.heads)
        yield from (_other_role(chain, False) for _, chain in rules.tails)


def _other_role(chain: Chain, is_head: bool) -> Role:
    """Return the role of the other edge of a chain, seen from its first edge or else its second."""
    return (chain.second, False) if is_head else (chain.first, True)
