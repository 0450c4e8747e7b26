"""Matching of SWRL rules with an ABox.

Variables stand for nodes, or for calculated values that need not occur in the ABox. Equal nodes are
interchangeable: a match with one of them is a match with all.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from itertools import islice

from semmap.nodes.kb_node.reasoner.abox.abox import ABox
from semmap.nodes.kb_node.reasoner.abox.adjacency import NONE
from semmap.nodes.kb_node.reasoner.explain.reasons import Applied, Claim, Edge, Member, Same
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.rules import builtins, swrl
from semmap.nodes.kb_node.reasoner.rules.swrl import Atom, SwrlRule
from semmap.nodes.kb_node.reasoner.rules.time_limit import TimeLimit
from semmap.nodes.kb_node.reasoner.tbox.axioms import DIFFERENT

Bound = dict[Term, int | Term]
"""The node of each variable, or its calculated value."""
Match = tuple[Bound, tuple[Claim, ...]]


class RuleMatching:
    """Finds the matches of rules, with the claims that they depend on."""

    def __init__(self, abox: ABox, limit: TimeLimit | None = None) -> None:
        self._abox = abox
        self._limit = limit
        self._store = abox.store
        self._orders: dict[tuple[tuple[Atom, ...], int, frozenset[Term]], tuple[Atom, ...]] = {}

    def matches(self, rule: SwrlRule) -> Iterator[Match]:
        """Yield all matches of a rule."""
        return self._join(rule.body, 0, {}, (Applied(rule),))

    def of_atom(self, rule: SwrlRule, at: int, nodes: Sequence[int], *claims: Claim) -> list[Match]:
        """Return the matches in which the arguments of one atom of the body are the given nodes."""
        start = self._bind(rule.body[at], nodes)
        if start is None:
            return []
        atoms = self._order(rule, at, frozenset(start[0]))
        return list(self._join(atoms, 0, start[0], (Applied(rule), *claims, *start[1])))

    def of_head(self, rule: SwrlRule, nodes: Sequence[int]) -> list[Match]:
        """Return a match in which the arguments of the head are the given nodes, if there is one.

        If an argument is calculated, all matches with the other arguments are returned.
        """
        start = None if rule.head is None else self._bind(rule.head, nodes)
        if start is None:
            return []
        matched = swrl.find_matched(rule.body)
        bound = {variable: node for variable, node in start[0].items() if variable in matched}
        atoms = self._order(rule, NONE, frozenset(bound))
        found = self._join(atoms, 0, bound, (Applied(rule), *start[1]))
        return list(found if len(bound) < len(start[0]) else islice(found, 1))

    def node(self, argument: Term, bound: Bound) -> int:
        """Return the node of an argument of a head, which is created if it does not exist."""
        value = bound.get(argument, argument)
        return value if isinstance(value, int) else self._store.node(value)

    def _order(self, rule: SwrlRule, at: int, bound: frozenset[Term]) -> tuple[Atom, ...]:
        key = (rule.body, at, bound)
        if key not in self._orders:
            rest = [atom for i, atom in enumerate(rule.body) if i != at]
            self._orders[key] = swrl.ordered(rest, bound)
        return self._orders[key]

    def _bind(self, atom: Atom, nodes: Sequence[int]) -> Match | None:
        """Bind the arguments of an atom to nodes; None if they do not fit."""
        bound: Bound = {}
        claims: list[Claim] = []
        for argument, node in zip(atom.arguments, nodes, strict=False):
            known = bound.get(argument, argument)
            if not isinstance(known, int) and swrl.is_variable(argument):
                bound[argument] = node
            elif (same := self._agree(known, node)) is not None:
                claims += same
            else:
                return None
        return bound, tuple(claims)

    def _agree(self, known: int | Term, node: int) -> tuple[Claim, ...] | None:
        """Return the claim that a node is a known node or value; None if it is not."""
        other = known if isinstance(known, int) else self._abox.named(node, known)
        if other is None or not self._abox.is_same(other, node):
            return None
        return () if other == node else (Same(node, other),)

    def _join(
        self, atoms: Sequence[Atom], at: int, bound: Bound, claims: tuple[Claim, ...]
    ) -> Iterator[Match]:
        if at == len(atoms):
            yield bound, claims
            return
        for more, needed in self._match(atoms[at], bound):
            yield from self._join(atoms, at + 1, {**bound, **more} if more else bound, (*claims, *needed))

    def _match(self, atom: Atom, bound: Bound) -> Iterator[Match]:
        if self._limit is not None:
            self._limit.check()
        if atom.kind == swrl.CLASS:
            return self._match_class(atom, bound)
        if atom.kind == swrl.PROPERTY:
            return self._match_property(atom, bound)
        if atom.kind == swrl.BUILT_IN:
            return self._match_built_in(atom, bound)
        return self._match_equality(atom, bound)

    def _value(self, argument: Term, bound: Bound) -> int | Term | None:
        """Return the node or value of an argument; None if it is not bound yet."""
        if swrl.is_variable(argument):
            return bound.get(argument)
        found = self._store.find(argument)
        return argument if found is None else found

    def _nodes(self) -> Iterator[int]:
        return (node for node, term in enumerate(self._store.terms) if term)

    def _match_class(self, atom: Atom, bound: Bound) -> Iterator[Match]:
        cls = self._abox.schema.cls(atom.predicate)
        node = self._value(atom.arguments[0], bound)
        if isinstance(node, str):
            if node[0] == '"' and self._abox.kinds.literal(node).mask >> cls & 1:
                yield {}, ()
            return
        for one in self._nodes() if node is None else (node,):
            if self._store.kind[one].mask >> cls & 1:
                yield ({atom.arguments[0]: one} if node is None else {}), (Member(one, cls),)

    def _match_property(self, atom: Atom, bound: Bound) -> Iterator[Match]:
        abox, prop = self._abox, self._abox.schema.property(atom.predicate)
        first, second = (self._value(argument, bound) for argument in atom.arguments)
        if isinstance(first, str):
            return
        if first is None and isinstance(second, int) and not abox.is_literal(second):
            ends = [(second, True)]
        else:
            ends = [(node, False) for node in (self._nodes() if first is None else (first,))]
        for node, backwards in ends:
            for edge, near, far in list(abox.related(node, abox.steps.group((prop, backwards)))):
                subject, object_ = (far, node) if backwards else (node, far)
                more: Bound = {}
                claims: list[Claim] = [Edge(edge, (prop, False))]
                claims += () if near == node else (Same(node, near),)
                for argument, known, found in zip(
                    atom.arguments, (first, second), (subject, object_), strict=True
                ):
                    value = more.get(argument) if known is None else known
                    if value is None:
                        more[argument] = found
                    elif (same := self._agree(value, found)) is not None:
                        claims += same
                    else:
                        break
                else:
                    yield more, tuple(claims)

    def _match_equality(self, atom: Atom, bound: Bound) -> Iterator[Match]:
        one, other = (self._value(argument, bound) for argument in atom.arguments)
        if atom.kind == swrl.SAME and one == other and one is not None:
            yield {}, ()
        if not (isinstance(one, int) and isinstance(other, int)):
            return
        if atom.kind == swrl.SAME:
            if one != other and self._abox.is_same(one, other):
                yield {}, (Same(one, other),)
            return
        for x, y in ((one, other), (other, one)):
            if (edge := self._abox.find(x, (DIFFERENT, False), y)) != NONE:
                yield {}, (Edge(edge), *self._abox.equality_claims((edge,), x, y))
                return
        members = [self._abox.members(node) for node in (one, other)]
        terms = [[self._store.terms[member] for member in nodes] for nodes in members]
        for listed, axiom in self._all_different:
            if not any(map(listed.isdisjoint, terms)) and not self._abox.is_same(one, other):
                apart = Applied(SwrlRule(axiom[0][0], (), None, axiom))
                ends = zip((one, other), members, strict=True)
                yield {}, (apart, *(Same(end, node) for end, nodes in ends for node in nodes if node != end))
                return

    @cached_property
    def _all_different(self) -> list[tuple[frozenset[Term], tuple[Triple, ...]]]:
        return swrl.read_all_different(self._abox.schema.closure)

    def _match_built_in(self, atom: Atom, bound: Bound) -> Iterator[Match]:
        values: list[Term | None] = []
        for argument in atom.arguments:
            value = self._value(argument, bound)
            values.append(self._store.terms[value] if isinstance(value, int) else value)
        result, operands = values[0], [value for value in values[1:] if value is not None]
        if builtins.is_comparison(atom.predicate):
            if result is not None and builtins.compare(atom.predicate, result, operands[0]):
                yield {}, ()
            return
        found = builtins.calculate(atom.predicate, operands)
        if found is None:
            return
        if result is None:
            yield {atom.arguments[0]: found}, ()
        elif builtins.is_equal(result, found):
            yield {}, ()
