"""The ABox and what follows in it: forward from what was inserted until nothing changes or something clashes.

Stored are the asserted edges, the kind of each node, and what cannot be read off them: edges that chains or
values make, and which nodes are the same. The agenda is a queue of new edges and of nodes whose kind grew.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import combinations, count

from nodes.kb_node.reasoner import datatypes
from nodes.kb_node.reasoner.kinds import Kind, Kinds
from nodes.kb_node.reasoner.reasons import Claim, Clash, Edge, Member, Reason, Same
from nodes.kb_node.reasoner.schema import (
    ANY,
    DIFFERENT,
    SAME,
    Chain,
    Group,
    Key,
    Limit,
    NotCompilable,
    Role,
    Schema,
)  # fmt: skip
from nodes.kb_node.reasoner.steps import EdgeRules, Step, Steps
from nodes.kb_node.reasoner.store import ASSERTED, DERIVED, NONE, VALUE, Store
from nodes.kb_node.reasoner.terms import TYPE, is_literal
from schemas.explanations import Term, Triple

MANY = 16
"""Pairs of nodes beyond which edges are searched by the one end only."""


class Equals:
    """Nodes that are the same individual, and the links that made them so."""

    __slots__ = ("links", "members")

    def __init__(self, member: int) -> None:
        self.members = [member]
        self.links: list[Reason] = []


class ABox:
    """Individuals, their edges and what follows. `insert` and `delete` change, `run` concludes.

    A Clash leaves the agenda as it was, so that the caller can undo its changes and `run` again.
    """

    def __init__(self, schema: Schema) -> None:
        self.schema = schema
        self.kinds = Kinds(schema)
        self.steps = Steps(schema, self.kinds)
        self.store = Store(self.kinds)
        self.equals: dict[int, Equals] = {}
        self.reasons: dict[int, Reason] = {}
        self.moved: dict[int, Kind] = {}
        """The nodes whose kind changed since `settle`, with the kind they had."""
        self.rest_on_edge: dict[int, list[Reason]] = {}
        self.rest_on_node: dict[int, list[Reason]] = {}
        self._order = count()
        self.spellings: dict[datatypes.Value, list[int]] = {}
        self.fresh: list[int] = []
        self.dirty: dict[int, None] = {}
        for term in schema.nominals:
            if not is_literal(term):
                self.store.node(term)

    # Changes

    def insert(self, triple: Triple) -> bool:
        """Assert a triple; whether it is new. Conclusions come with `run`."""
        s, p, o = triple
        store, schema = self.store, self.schema
        subject = store.numbers.get(s)
        if subject is None:
            subject = store.node(s)
        if p == TYPE:
            cls = schema.find_class(o)
            return self._give(subject, self._first_use(o, schema.cls) if cls is None else cls)
        object_ = store.numbers.get(o)
        if object_ is None:
            object_ = store.node(o)
        predicate = schema.find_property(p)
        if predicate is None:
            predicate = self._first_use(p, schema.property)
        edge = store.edge(subject, predicate, object_)
        if edge != NONE:
            if store.source[edge] == ASSERTED:
                return False
            store.source[edge] = ASSERTED
            if reason := self.reasons.pop(edge, None):
                reason.alive = False
            return True
        self.fresh.append(store.add(subject, predicate, object_, ASSERTED))
        return True

    def run(self) -> None:
        """Draw all conclusions. Raises Clash at the first contradiction."""
        fresh, dirty = self.fresh, self.dirty
        while fresh or dirty:
            if dirty:
                node, _ = dirty.popitem()
                try:
                    self._spread(node)
                except Clash:
                    dirty[node] = None
                    raise
            else:
                edge = fresh.pop()
                try:
                    self._look_at(edge)
                except Clash:
                    fresh.append(edge)
                    raise

    def settle(self) -> None:
        """File the individuals whose kind changed; to be called at the end of a transaction."""
        for node, before in self.moved.items():
            if before.excluded is None:
                self.store.file(node, before, self.store.kind[node])
        self.moved.clear()

    # Reading

    def members(self, node: int) -> list[int]:
        """All nodes that are the same as one, itself included."""
        equals = self.equals.get(node)
        return [node] if equals is None else equals.members

    def is_same(self, one: int, other: int) -> bool:
        """Whether two nodes are the same individual or value."""
        if one == other:
            return True
        equals = self.equals.get(one)
        if equals is not None and equals is self.equals.get(other):
            return True
        return self.value(one) is not None and self.value(one) == self.value(other)

    def is_term(self, node: int, term: Term) -> bool:
        """Whether a node is what a term names: the same individual, or a literal of the same value."""
        if self.store.terms[node] == term:
            return True
        other = self.store.find(term)
        if other is not None and self.is_same(node, other):
            return True
        return is_literal(term) and self.value(node) is not None and self.value(node) == datatypes.value(term)

    def is_literal(self, node: int) -> bool:
        """Whether a node is a literal."""
        return self.store.kind[node].excluded is not None

    def related(self, node: int, group: Group) -> Iterator[tuple[int, int, int]]:
        """The edges that a role follows from a node: (edge, its end here, its end there)."""
        store = self.store
        for member in self.members(node):
            for p in group.out:
                for edge in store.out.of(member, p):
                    yield edge, member, store.object[edge]
            for p in group.into:
                for edge in store.into.of(member, p):
                    yield edge, member, store.subject[edge]

    def find(self, one: int, role: Role, other: int) -> int:
        """An edge that implies a role between two nodes or their equals, or NONE."""
        group, store = self.steps.group(role), self.store
        if len(self.members(one)) * len(self.members(other)) > MANY:
            return next((edge for edge, _, end in self.related(one, group) if self.is_same(end, other)), NONE)
        for x in self.members(one):
            for y in self.members(other):
                for p in group.out:
                    if (edge := store.edge(x, p, y)) != NONE:
                        return edge
                for p in group.into:
                    if (edge := store.edge(y, p, x)) != NONE:
                        return edge
        return NONE

    # Forward

    def _first_use(self, term: Term, number: Callable[[Term], int]) -> int:
        """A class or property that the schema does not mention."""
        node = self.store.find(term)
        if node is not None and node in self.equals:
            raise NotCompilable(f"{term} is the same as another class or property")
        return number(term)

    def _give(self, node: int, cls: int) -> bool:
        kind = self.store.kind[node]
        if cls in kind.given:
            return False
        wider = self.kinds.give(kind, cls)
        self.set(node, wider)
        if wider.mask != kind.mask:
            self._widen(node, wider.mask)
            if wider.clash or wider.values or not self.store.is_bare(node):
                self.dirty[node] = None
        return True

    def _widen(self, node: int, mask: int) -> None:
        """Add classes to a node and all that are the same."""
        for member in self.members(node):
            kind = self.store.kind[member]
            wider = self.kinds.widen(kind, mask)
            if wider is not kind:
                self.set(member, wider)
                self.dirty[member] = None

    def set(self, node: int, kind: Kind) -> None:
        """Change the kind of a node."""
        self.moved.setdefault(node, self.store.kind[node])
        self.store.kind[node] = kind

    def _spread(self, node: int) -> None:
        """A node's kind grew: what that says of the node itself and of its neighbours."""
        kind = self.store.kind[node]
        if kind.clash:
            one, other = kind.clash
            raise Clash(Member(node, one), Member(node, other))
        self.add_values(node)
        for side in (self.store.out, self.store.into):
            for edge in side.all(node):
                if self.store.predicate[edge] > DIFFERENT:
                    self._step(edge)

    def add_values(self, node: int) -> None:
        """Add the edges that a node's classes come with (cls-hv1)."""
        for predicate, term in self.store.kind[node].values:
            value = self.store.node(term)
            if self.find(node, (predicate, False), value) == NONE:
                self.fresh.append(self.store.add(node, predicate, value, VALUE))

    def _look_at(self, edge: int) -> None:
        """A new edge: all rules that it may take part in."""
        store = self.store
        s, p, o = store.subject[edge], store.predicate[edge], store.object[edge]
        if p == NONE:
            return
        if p == SAME:
            self._join(s, o, Edge(edge))
            return
        if p == DIFFERENT:
            if self.is_same(s, o):
                raise Clash(Edge(edge), Same(s, o))
            return
        self._step(edge)
        rules = self.steps.rules(p)
        if rules is None or (rules.of_values and s not in self.equals and store.out.is_alone(edge)):
            return
        self._apply(rules, edge, s, o)

    def _step(self, edge: int) -> None:
        store = self.store
        s, p, o = store.subject[edge], store.predicate[edge], store.object[edge]
        subject, object_ = store.kind[s], store.kind[o]
        step = self.steps.step(p, subject, object_)
        if step.subject is not subject:
            self._widen(s, step.subject.mask)
        if step.object is not object_:
            self._widen(o, step.object.mask)
        if step.special:
            self._check(step, edge, s, o)

    def _check(self, step: Step, edge: int, s: int, o: int) -> None:
        """The parts of a step that are about more than one edge, or that clash."""
        if self.store.kind[o].clash and self.is_literal(o):
            self._clash_of_literal(edge, o)
        if step.clash:
            role, owner, filler = step.clash
            x, y = (o, s) if role[1] else (s, o)
            raise Clash(Edge(edge, role), *_member(x, owner), *_member(y, filler))
        for at_subject, limit in step.limits:
            self._limit(edge, *((s, o) if at_subject else (o, s)), limit)
        for at_subject, key in step.keys:
            self._identify(s if at_subject else o, key)

    def _clash_of_literal(self, edge: int, node: int) -> None:
        one, other = self.store.kind[node].clash or (0, 0)
        if one < 0:
            raise Clash(Edge(edge))
        raise Clash(Member(node, one), Member(node, other))

    def _apply(self, rules: EdgeRules, edge: int, s: int, o: int) -> None:
        if rules.by_value and self.is_literal(o):
            self._meet(o)
        if rules.irreflexive and self.is_same(s, o):
            raise Clash(Edge(edge, rules.irreflexive), Same(s, o))
        for at_subject, limit in rules.limits:
            self._limit(edge, *((s, o) if at_subject else (o, s)), limit)
        for role, other in rules.exclusive:
            found = self.find(s, other, o)
            if found != NONE:
                raise Clash(Edge(edge, role), Edge(found, other), *self.bridges((edge, found)))
        for forwards, chain in rules.heads:
            self._continue(edge, *((s, o) if forwards else (o, s)), chain)
        for forwards, chain in rules.tails:
            self._begin(edge, *((s, o) if forwards else (o, s)), chain)

    def bridges(self, edges: Iterable[int], *nodes: int) -> list[Claim]:
        """That nodes and the ends of edges are the same, where they are and are not one node."""
        store = self.store
        ends = {node for edge in edges for node in (store.subject[edge], store.object[edge])}
        pairs = combinations(sorted(ends.union(nodes)), 2)
        return [Same(one, other) for one, other in pairs if self.equals and self.is_same(one, other)]

    def _limit(self, edge: int, owner: int, value: int, limit: Limit) -> None:
        """At most one value: this one and any other are the same (prp-fp, prp-ifp, cls-maxc2, cls-maxqc*)."""
        group = self.steps.group(limit.role)
        if (
            not group.into
            and len(group.out) == 1
            and owner not in self.equals
            and self.store.out.is_alone(edge)
        ):
            return
        for other, end, found in self.related(owner, group):
            if other == edge or self.is_same(value, found):
                continue
            if limit.filler != ANY and not self.store.kind[found].mask >> limit.filler & 1:
                continue
            claims: list[Claim] = [
                Edge(edge, limit.role),
                Edge(other, limit.role),
                *_member(owner, limit.owner),
            ]
            claims += [*_member(value, limit.filler), *_member(found, limit.filler)]
            if end != owner:
                claims.append(Same(owner, end))
            self._join(value, found, *claims)
            return

    def _identify(self, node: int, key: Key) -> None:
        """Somebody else of the class who has a value in common for every property of the key (prp-key)."""
        onward = self.steps.group((key.properties[0], False))
        back = self.steps.group((key.properties[0], True))
        for first, end, value in list(self.related(node, onward)):
            for second, there, other in list(self.related(value, back)):
                if self.is_same(other, node) or not self.store.kind[other].mask >> key.owner & 1:
                    continue
                role = (key.properties[0], False)
                claims: list[Claim] = [Edge(first, role), Edge(second, role)]
                claims += [Same(a, b) for a, b in ((node, end), (value, there)) if a != b]
                for p in key.properties[1:]:
                    agreed = self._agreement(node, other, (p, False))
                    if agreed is None:
                        break
                    claims += agreed
                else:
                    self._join(node, other, *claims, Member(node, key.owner), Member(other, key.owner))

    def _agreement(self, one: int, other: int, role: Role) -> list[Claim] | None:
        """Two edges that lead from two nodes to the same value, or None."""
        group = self.steps.group(role)
        for first, here, value in self.related(one, group):
            for second, there, found in self.related(other, group):
                if self.is_same(value, found):
                    ends = ((one, here), (other, there), (value, found))
                    return [Edge(first, role), Edge(second, role), *(Same(a, b) for a, b in ends if a != b)]
        return None

    def _continue(self, edge: int, x: int, y: int, chain: Chain) -> None:
        for other, end, z in list(self.related(y, self.steps.group((chain.second, False)))):
            self.make_chain(chain, x, z, edge, other, *_same(y, end))

    def _begin(self, edge: int, y: int, z: int, chain: Chain) -> None:
        for other, end, x in list(self.related(y, self.steps.group((chain.first, True)))):
            self.make_chain(chain, x, z, other, edge, *_same(y, end))

    def make_chain(self, chain: Chain, x: int, z: int, first: int, second: int, *same: Claim) -> None:
        """Two edges, and what makes them meet, add a third (prp-spo2, prp-trp)."""
        edges = Edge(first, (chain.first, False)), Edge(second, (chain.second, False))
        self._derive(x, chain.result, z, *edges, *same)

    def _derive(self, subject: int, predicate: int, object_: int, *claims: Claim) -> None:
        """Add an edge that a rule makes, unless another one implies it."""
        if self.is_literal(subject) or self.find(subject, (predicate, False), object_) != NONE:
            return
        edge = self.store.add(subject, predicate, object_, DERIVED)
        self.reasons[edge] = self._remember(Reason(next(self._order), claims, edge=edge))
        self.fresh.append(edge)

    def _meet(self, literal: int) -> None:
        """Spellings of one value are the same node where that matters (dt-eq)."""
        value = self.value(literal)
        if value is None:
            return
        known = self.spellings.setdefault(value, [])
        if literal not in known:
            known.append(literal)
        if known[0] != literal:
            self._join(known[0], literal)

    def _join(self, one: int, other: int, *claims: Claim) -> None:
        """Two nodes are the same (eq-*): one set of members, one mask, and all edges looked at anew."""
        mine, theirs = self.equals.get(one), self.equals.get(other)
        if one == other or (mine is not None and mine is theirs):
            return
        self._check_joinable(one, other, claims)
        mine, theirs = mine or Equals(one), theirs or Equals(other)
        if len(mine.members) < len(theirs.members):
            mine, theirs = theirs, mine
        newcomers = list(theirs.members)
        mine.members += newcomers
        mine.links += theirs.links
        mine.links.append(self._remember(Reason(next(self._order), claims, link=(one, other))))
        for member in mine.members:
            self.equals[member] = mine
        self._widen(one, self.store.kind[one].mask | self.store.kind[other].mask)
        for node in newcomers:
            self.fresh += self.store.out.all(node)
            self.fresh += self.store.into.all(node)

    def _check_joinable(self, one: int, other: int, claims: tuple[Claim, ...]) -> None:
        terms = self.store.terms
        if self.is_literal(one) and self.is_literal(other):
            values = {self.value(node) for node in (*self.members(one), *self.members(other))}
            if len(values - {None}) > 1:
                raise Clash(*claims, *self._different(one, other))
        elif self.is_literal(one) or self.is_literal(other):
            raise NotCompilable(f"an individual is a value: {terms[one]}, {terms[other]}")
        elif self.schema.speaks_of(terms[one]) or self.schema.speaks_of(terms[other]):
            raise NotCompilable(f"{terms[one]} is the same as {terms[other]}")

    def _different(self, one: int, other: int) -> Iterator[Claim]:
        """The literals known to be the same as two, among which are two values."""
        for node in (one, other):
            yield from (Same(node, member) for member in self.members(node) if member != node)

    def value(self, node: int) -> datatypes.Value | None:
        """The value of a literal; None for an individual."""
        if not self.is_literal(node):
            return None
        return datatypes.value(self.store.terms[node])

    def _remember(self, reason: Reason) -> Reason:
        """Note what a conclusion rests on, to find it when that is deleted."""
        for claim in reason.claims:
            if isinstance(claim, Edge):
                rest = self.rest_on_edge.setdefault(claim.edge, [])
            else:
                node = claim.node if isinstance(claim, Member) else claim.one
                rest = self.rest_on_node.setdefault(node, [])
            if len(rest) >= MANY and len(rest) & (len(rest) - 1) == 0:
                rest[:] = [other for other in rest if other.alive]
            rest.append(reason)
        return reason

    def forget(self, node: int) -> None:
        """Release a node that nothing is said of any more."""
        value = self.value(node) if self.spellings else None
        if self.store.release(node) and value in self.spellings:
            self.spellings[value] = [other for other in self.spellings[value] if other != node]
            if not self.spellings[value]:
                del self.spellings[value]


def _member(node: int, cls: int) -> tuple[Claim, ...]:
    return () if cls == ANY else (Member(node, cls),)


def _same(one: int, other: int) -> tuple[Claim, ...]:
    return () if one == other else (Same(one, other),)
