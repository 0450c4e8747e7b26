"""Saturation: forward chaining from new facts until nothing more follows or a contradiction is found."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from semmap.nodes.kb_node.reasoner.abox.abox import ABox
from semmap.nodes.kb_node.reasoner.abox.adjacency import NONE
from semmap.nodes.kb_node.reasoner.abox.equality import Equality
from semmap.nodes.kb_node.reasoner.abox.kinds import bits
from semmap.nodes.kb_node.reasoner.abox.rule_matching import Match, RuleMatching
from semmap.nodes.kb_node.reasoner.abox.steps import EdgeRules, Step
from semmap.nodes.kb_node.reasoner.abox.store import ASSERTED, COMPUTED, DERIVED, VALUE
from semmap.nodes.kb_node.reasoner.explain.reasons import Claim, Clash, Edge, Member, Same, member
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.rules import swrl
from semmap.nodes.kb_node.reasoner.rules.swrl import SwrlRule
from semmap.nodes.kb_node.reasoner.rules.time_limit import TimeLimit
from semmap.nodes.kb_node.reasoner.tbox.axioms import DIFFERENT, SAME, Chain, NotCompilable
from semmap.nodes.kb_node.reasoner.tbox.split import is_schema
from semmap.nodes.kb_node.reasoner.terms import TYPE


class Saturation:
    """Applies the rules to an ABox: `insert` adds facts, `run` draws conclusions.

    A Clash leaves the agenda unchanged, so that the caller can undo its changes and call `run` again.
    """

    def __init__(self, abox: ABox) -> None:
        self._abox = abox
        self._equality = Equality(abox)
        self._matching = RuleMatching(abox)
        self._store = abox.store
        self._steps = abox.steps

    def insert(self, triple: Triple, source: int = ASSERTED) -> bool:
        """Insert an asserted or computed triple; return whether it is new. `run` draws the conclusions.

        An asserted triple is not also computed.
        """
        s, p, o = triple
        store, schema = self._store, self._abox.schema
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
            before = store.source[edge]
            if before in (ASSERTED, source):
                return False
            if before == COMPUTED:
                self._abox.overlaid.append(triple)
            store.source[edge] = source
            if reason := self._abox.reasons.pop(edge, None):
                reason.alive = False
            return True
        self._abox.fresh.append(store.add(subject, predicate, object_, source))
        return True

    def run(self) -> None:
        """Draw all conclusions. Raises Clash at the first contradiction."""
        fresh, dirty = self._abox.fresh, self._abox.dirty
        node = edge = NONE
        try:
            while fresh or dirty:
                node = edge = NONE
                if dirty:
                    node, _ = dirty.popitem()
                    self._propagate(node)
                else:
                    edge = fresh.pop()
                    self._process_edge(edge)
        except (Clash, NotCompilable):
            if node == NONE:
                fresh.append(edge)
            else:
                dirty[node] = None
            raise

    def _first_use(self, term: Term, number: Callable[[Term], int]) -> int:
        """Return a new number for a class or property that the schema does not mention."""
        node = self._store.find(term)
        if node is not None and node in self._abox.equals:
            raise NotCompilable(f"{term} is the same as another class or property")
        return number(term)

    def _give(self, node: int, cls: int) -> bool:
        kind = self._store.kind[node]
        if cls in kind.given:
            return False
        wider = self._abox.kinds.add_given(kind, cls)
        self._abox.set_kind(node, wider)
        if wider.mask != kind.mask:
            self._abox.widen(node, wider.mask)
            if (
                wider.clash
                or wider.values
                or wider.mask & self._abox.schema.rule_classes
                or not self._store.is_bare(node)
            ):
                self._abox.dirty[node] = None
        return True

    def _propagate(self, node: int) -> None:
        """Apply the rules to a node whose kind grew, and to its neighbours."""
        kind = self._store.kind[node]
        if kind.clash and not (self._abox.is_literal(node) and self._store.is_bare(node)):
            one, other = kind.clash
            raise Clash(Member(node, one), Member(node, other))
        self.add_values(node)
        for cls in bits(kind.mask & self._abox.schema.rule_classes):
            for rule, at in self._abox.schema.rules_by_class[cls]:
                self._conclude(rule, self._matching.of_atom(rule, at, (node,), Member(node, cls)))
        for side in (self._store.out, self._store.into):
            for edge in side.all(node):
                if self._store.predicate[edge] > DIFFERENT:
                    self._step(edge)

    def add_values(self, node: int) -> None:
        """Add the edges that are implied by a node's classes (cls-hv1)."""
        is_new = self._store.is_bare(node) and node not in self._abox.equals
        for predicate, term in self._store.kind[node].values:
            value = self._store.node(term)
            if is_new or self._abox.find(node, (predicate, False), value) == NONE:
                self._abox.fresh.append(self._store.add(node, predicate, value, VALUE))

    def _process_edge(self, edge: int) -> None:
        """Apply all rules that a new edge may match."""
        store = self._store
        s, p, o = store.subject[edge], store.predicate[edge], store.object[edge]
        if p == NONE:
            return
        if p == SAME:
            self._equality.merge(s, o, Edge(edge))
            return
        if p == DIFFERENT:
            if self._abox.is_same(s, o):
                raise Clash(Edge(edge), Same(s, o))
            for rule, at in self._abox.schema.rules_by_property.get(DIFFERENT, ()):
                for nodes in ((s, o), (o, s)):
                    self._conclude(rule, self._matching.of_atom(rule, at, nodes, Edge(edge)))
            return
        if self._abox.has_unknown_equals and self._abox.is_literal(o):
            self._equality.merge_spellings(o)
        rules = self._step(edge).rules
        if rules is None or (
            rules.only_uniqueness and s not in self._abox.equals and store.out.is_alone(edge)
        ):
            return
        self._apply(rules, edge, s, o)

    def _step(self, edge: int) -> Step:
        store = self._store
        s, p, o = store.subject[edge], store.predicate[edge], store.object[edge]
        subject, object_ = store.kind[s], store.kind[o]
        step = self._steps.known.get((p, subject, object_)) or self._steps.step(p, subject, object_)
        if step.subject is not subject:
            self._abox.widen(s, step.subject.mask)
        if step.object is not object_:
            self._abox.widen(o, step.object.mask)
        if step.special and not (
            step.only_uniqueness and s not in self._abox.equals and store.out.is_alone(edge)
        ):
            self._check(step, edge, s, o)
        return step

    def _check(self, step: Step, edge: int, s: int, o: int) -> None:
        """Apply the parts of a step that concern several edges or that clash."""
        if self._store.kind[o].clash and self._abox.is_literal(o):
            self._clash_of_literal(edge, o)
        if step.clash:
            role, owner, filler = step.clash
            x, y = (o, s) if role[1] else (s, o)
            raise Clash(Edge(edge, role), *member(x, owner), *member(y, filler))
        for at_subject, limit in step.limits:
            self._equality.apply_limit(edge, *((s, o) if at_subject else (o, s)), limit)
        for at_subject, key in step.keys:
            self._equality.apply_key(s if at_subject else o, key)

    def _clash_of_literal(self, edge: int, node: int) -> None:
        one, other = self._store.kind[node].clash or (0, 0)
        if one < 0:
            raise Clash(Edge(edge))
        raise Clash(Member(node, one), Member(node, other))

    def _apply(self, rules: EdgeRules, edge: int, s: int, o: int) -> None:
        if rules.by_value and self._abox.is_literal(o):
            self._equality.merge_spellings(o)
        if rules.irreflexive and self._abox.is_same(s, o):
            raise Clash(Edge(edge, rules.irreflexive), Same(s, o))
        for at_subject, limit in rules.limits:
            self._equality.apply_limit(edge, *((s, o) if at_subject else (o, s)), limit)
        has_any = self._abox.has_any
        if rules.exclusive and has_any(s, rules.exclusive_group):
            for role, other in rules.exclusive:
                found = self._abox.find(s, other, o)
                if found != NONE:
                    raise Clash(
                        Edge(edge, role), Edge(found, other), *self._abox.equality_claims((edge, found))
                    )
        if rules.heads or rules.tails:
            continues = has_any(s, rules.beyond[0]), has_any(o, rules.beyond[1])
            for forwards, chain in rules.heads:
                if continues[forwards]:
                    self._chain_forwards(edge, *((s, o) if forwards else (o, s)), chain)
            for forwards, chain in rules.tails:
                if continues[not forwards]:
                    self._chain_backwards(edge, *((s, o) if forwards else (o, s)), chain)
        for forwards, rule, at in rules.triggers:
            role = (self._abox.schema.property(rule.body[at].predicate), False)
            ends = (s, o) if forwards else (o, s)
            self._conclude(rule, self._matching.of_atom(rule, at, ends, Edge(edge, role)))
        for role in rules.meanings:
            self._apply_meaning(role[0], *((o, s) if role[1] else (s, o)), Edge(edge, role))

    def _apply_meaning(self, prop: int, x: int, y: int, edge: Edge) -> None:
        """Apply the rules of owl:sameAs, owl:differentFrom or rdf:type to an edge of a subproperty.

        Classes of the vocabulary and literals are not used as classes.
        """
        if prop == SAME:
            self._equality.merge(x, y, edge)
        elif prop == DIFFERENT:
            if self._store.edge(x, DIFFERENT, y) == NONE:
                self._add_derived(x, DIFFERENT, y, edge)
        elif not self._abox.is_literal(y) and not is_schema(("", TYPE, cls := self._store.terms[y])):
            if self._abox.schema.find_class(cls) is None:
                self._first_use(cls, self._abox.schema.cls)
            self._derive(x, self._abox.schema.membership(cls), x, edge)

    def apply_rules(self) -> None:
        """Apply the SWRL rules to all facts."""
        for rule in self._abox.schema.rules:
            self._conclude(rule, list(self._matching.matches(rule)))

    def apply_rules_for(self, subject: int, predicate: int, object_: int) -> None:
        """Apply the SWRL rules that may imply an edge of a property."""
        for rule in self._abox.schema.rules_by_head.get(predicate, ()):
            self._conclude(rule, self._matching.of_head(rule, (subject, object_)))

    def matches(self, rule: SwrlRule, limit: TimeLimit) -> Iterator[tuple[int | Term, ...]]:
        """Yield the values of the variables of each match of a SWRL rule, with one of equal individuals."""
        members = self._abox.members
        for bound, _ in RuleMatching(self._abox, limit).matches(rule):
            yield tuple(members(v)[0] if isinstance(v, int) else v for v in bound.values())

    def _conclude(self, rule: SwrlRule, matches: list[Match]) -> None:
        """Add the conclusions of a SWRL rule."""
        for bound, claims in matches:
            if rule.head is None:
                raise Clash(*claims)
            nodes = [self._matching.node(argument, bound) for argument in rule.head.arguments]
            one, other = nodes[0], nodes[-1]
            conclusion = self._abox.schema.conclusion(rule.head)
            if rule.head.kind == swrl.SAME:
                self._equality.merge(one, other, *claims)
            elif conclusion is not None:
                self._derive(one, conclusion, other, *claims)
            for node in nodes:
                if node not in self._abox.equals:
                    self._store.release(node)

    def _chain_forwards(self, edge: int, x: int, y: int, chain: Chain) -> None:
        for other, end, z in list(self._abox.related(y, self._steps.group((chain.second, False)))):
            self.make_chain(chain, x, z, edge, other, *_same(y, end))

    def _chain_backwards(self, edge: int, y: int, z: int, chain: Chain) -> None:
        for other, end, x in list(self._abox.related(y, self._steps.group((chain.first, True)))):
            self.make_chain(chain, x, z, other, edge, *_same(y, end))

    def make_chain(self, chain: Chain, x: int, z: int, first: int, second: int, *same: Claim) -> None:
        """Derive an edge from two edges that meet (prp-spo2, prp-trp)."""
        edges = Edge(first, (chain.first, False)), Edge(second, (chain.second, False))
        self._derive(x, chain.result, z, *edges, *same)

    def _derive(self, subject: int, predicate: int, object_: int, *claims: Claim) -> None:
        """Add a derived edge unless another edge implies it."""
        if self._abox.find(subject, (predicate, False), object_) == NONE:
            self._add_derived(subject, predicate, object_, *claims)

    def _add_derived(self, subject: int, predicate: int, object_: int, *claims: Claim) -> None:
        if self._abox.is_literal(subject):
            return
        edge = self._store.add(subject, predicate, object_, DERIVED)
        self._abox.reasons[edge] = self._abox.conclude(claims, edge=edge)
        self._abox.fresh.append(edge)


def _same(one: int, other: int) -> tuple[Claim, ...]:
    return () if one == other else (Same(one, other),)
