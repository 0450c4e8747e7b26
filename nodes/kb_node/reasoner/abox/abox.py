"""The ABox and what follows in it: forward from what was inserted until nothing changes or something clashes.

Stored are the asserted edges, the kind of each node, and what cannot be read off them: edges that chains or
values make, and which nodes are the same. The agenda is a queue of new edges and of nodes whose kind grew.
"""

from __future__ import annotations

from collections.abc import Callable

from nodes.kb_node.reasoner.abox.adjacency import NONE
from nodes.kb_node.reasoner.abox.equality import Equality
from nodes.kb_node.reasoner.abox.steps import EdgeRules, Step
from nodes.kb_node.reasoner.abox.store import ASSERTED, DERIVED, VALUE
from nodes.kb_node.reasoner.explain.reasons import Claim, Clash, Edge, Member, Reason, Same, member
from nodes.kb_node.reasoner.explanations import Term, Triple
from nodes.kb_node.reasoner.tbox.axioms import DIFFERENT, SAME, Chain, NotCompilable
from nodes.kb_node.reasoner.terms import TYPE


class ABox(Equality):
    """Individuals, their edges and what follows. `insert` and `delete` change, `run` concludes.

    A Clash leaves the agenda as it was, so that the caller can undo its changes and `run` again.
    """

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
        node = edge = NONE
        try:
            while fresh or dirty:
                node = edge = NONE
                if dirty:
                    node, _ = dirty.popitem()
                    self._spread(node)
                else:
                    edge = fresh.pop()
                    self._look_at(edge)
        except (Clash, NotCompilable):
            if node == NONE:
                fresh.append(edge)
            else:
                dirty[node] = None
            raise

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

    def _spread(self, node: int) -> None:
        """A node's kind grew: what that says of the node itself and of its neighbours."""
        kind = self.store.kind[node]
        if kind.clash and not (self.is_literal(node) and self.store.is_bare(node)):
            one, other = kind.clash
            raise Clash(Member(node, one), Member(node, other))
        self.add_values(node)
        for side in (self.store.out, self.store.into):
            for edge in side.all(node):
                if self.store.predicate[edge] > DIFFERENT:
                    self._step(edge)

    def add_values(self, node: int) -> None:
        """Add the edges that a node's classes come with (cls-hv1)."""
        is_new = self.store.is_bare(node) and node not in self.equals
        for predicate, term in self.store.kind[node].values:
            value = self.store.node(term)
            if is_new or self.find(node, (predicate, False), value) == NONE:
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
        if self.is_mixed and self.is_literal(o):
            self._meet(o)
        rules = self._step(edge).rules
        if rules is None or (rules.of_values and s not in self.equals and store.out.is_alone(edge)):
            return
        self._apply(rules, edge, s, o)

    def _step(self, edge: int) -> Step:
        store = self.store
        s, p, o = store.subject[edge], store.predicate[edge], store.object[edge]
        subject, object_ = store.kind[s], store.kind[o]
        step = self.steps.known.get((p, subject, object_)) or self.steps.step(p, subject, object_)
        if step.subject is not subject:
            self._widen(s, step.subject.mask)
        if step.object is not object_:
            self._widen(o, step.object.mask)
        if step.special and not (step.of_values and s not in self.equals and store.out.is_alone(edge)):
            self._check(step, edge, s, o)
        return step

    def is_plain(self, edge: int) -> bool:
        """Whether nothing follows from an edge but the kinds that its ends have now."""
        store = self.store
        s, p, o = store.subject[edge], store.predicate[edge], store.object[edge]
        if p <= DIFFERENT or store.source[edge] == DERIVED:
            return False
        step = self.steps.step(p, store.kind[s], store.kind[o])
        rules = step.rules
        if step.special or rules is not None:
            of_values = (step.of_values or not step.special) and (rules is None or rules.of_values)
            return of_values and store.out.is_alone(edge)
        return True

    def _check(self, step: Step, edge: int, s: int, o: int) -> None:
        """The parts of a step that are about more than one edge, or that clash."""
        if self.store.kind[o].clash and self.is_literal(o):
            self._clash_of_literal(edge, o)
        if step.clash:
            role, owner, filler = step.clash
            x, y = (o, s) if role[1] else (s, o)
            raise Clash(Edge(edge, role), *member(x, owner), *member(y, filler))
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


def _same(one: int, other: int) -> tuple[Claim, ...]:
    return () if one == other else (Same(one, other),)
