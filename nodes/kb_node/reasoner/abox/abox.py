"""The state of the ABox: stored facts, conclusions, and the agenda of the rules.

It stores the asserted edges, the kind of each node, and the conclusions that do not follow from these alone:
edges implied by chains or values, and which nodes are the same. The agenda has the new edges, and the nodes
whose kind grew.

Nodes that are the same individual share one `Equals`. Queries about one of them are answered for all.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import combinations, count

from semmap.nodes.kb_node.reasoner import datatypes
from semmap.nodes.kb_node.reasoner.abox.adjacency import NONE
from semmap.nodes.kb_node.reasoner.abox.kinds import Kind, Kinds
from semmap.nodes.kb_node.reasoner.abox.steps import Steps
from semmap.nodes.kb_node.reasoner.abox.store import DERIVED, Store
from semmap.nodes.kb_node.reasoner.explain.reasons import Applied, Claim, Edge, Member, Reason, Same
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.lexical_forms import Value
from semmap.nodes.kb_node.reasoner.tbox.axioms import DIFFERENT, Group, Role
from semmap.nodes.kb_node.reasoner.tbox.schema import Schema
from semmap.nodes.kb_node.reasoner.terms import is_literal

MANY = 16
"""Number of node pairs above which edges are searched from one end only."""


class Equals:
    """Nodes that are the same individual, and the links that make them equal."""

    __slots__ = ("links", "members")

    def __init__(self, member: int) -> None:
        self.members = [member]
        self.links: list[Reason] = []


class ABox:
    """The state shared by all rules: columns, kinds, equalities, reasons, and the agenda."""

    def __init__(self, schema: Schema) -> None:
        self.schema = schema
        self.kinds = Kinds(schema)
        self.steps = Steps(schema, self.kinds)
        self.store = Store(self.kinds)
        self.equals: dict[int, Equals] = {}
        self.regrouped: set[int] = set()
        """The individuals whose equals changed since `settle`."""
        self.reasons: dict[int, Reason] = {}
        self.changed_kinds: dict[int, Kind] = {}
        """The nodes whose kind changed since `settle`, with their previous kind."""
        self.reasons_by_edge: dict[int, list[Reason]] = {}
        self.reasons_by_node: dict[int, list[Reason]] = {}
        self._order = count()
        self.spellings: dict[Value, list[int]] = {}
        self.has_unknown_equals = False
        """Whether a literal without a known value was ever equal to another. Then spellings are compared."""
        self.overlaid: list[Triple] = []
        """Computed triples that were asserted since `settle`."""
        self.fresh: list[int] = []
        self.dirty: dict[int, None] = {}
        for term in schema.nominals:
            if not is_literal(term):
                self.dirty[self.store.node(term)] = (
                    None  # the schema alone may state their classes and values
                )

    def members(self, node: int) -> list[int]:
        """Return all nodes that are the same as a node, including itself."""
        equals = self.equals.get(node)
        return [node] if equals is None else equals.members

    def is_same(self, one: int, other: int) -> bool:
        """Return whether two nodes are the same individual or value."""
        if one == other:
            return True
        equals = self.equals.get(one)
        if equals is not None and equals is self.equals.get(other):
            return True
        return self.value(one) is not None and self.value(one) == self.value(other)

    def named(self, node: int, term: Term) -> int | None:
        """Return the node of a term among the nodes equal to `node`. Literals match in any spelling."""
        found, members = self.store.find(term), self.members(node)
        if found is not None and found in members:
            return found
        value = datatypes.value(term) if is_literal(term) else None
        return None if value is None else next((m for m in members if self.value(m) == value), None)

    def is_literal(self, node: int) -> bool:
        """Return whether a node is a literal."""
        return self.store.kind[node].excluded is not None

    def value(self, node: int) -> Value | None:
        """Return the value of a literal; None for an individual."""
        if not self.is_literal(node):
            return None
        return datatypes.value(self.store.terms[node])

    def related(self, node: int, group: Group) -> Iterator[tuple[int, int, int]]:
        """Return the edges along a role from a node: (edge, near end, far end)."""
        store = self.store
        if group.is_wide:
            yield from self._among_all(node, group)
            return
        for member in self.members(node) if self.equals else (node,):
            for edge in store.out.among(member, group.out):
                yield edge, member, store.object[edge]
            for edge in store.into.among(member, group.into):
                yield edge, member, store.subject[edge]

    def has_any(self, node: int, group: Group) -> bool:
        """Return whether a node has an edge of a group, that is, whether `related` returns any."""
        out, into = self.store.out, self.store.into
        if not self.equals:
            return out.has_any(node, group.out) or into.has_any(node, group.into)
        return any(
            out.has_any(member, group.out) or into.has_any(member, group.into)
            for member in self.members(node)
        )

    def _among_all(self, node: int, group: Group) -> Iterator[tuple[int, int, int]]:
        store, out, into = self.store, frozenset(group.out), frozenset(group.into)
        predicate = store.predicate
        for member in self.members(node):
            for edge in store.out.all(member):
                if predicate[edge] in out:
                    yield edge, member, store.object[edge]
            for edge in store.into.all(member):
                if predicate[edge] in into:
                    yield edge, member, store.subject[edge]

    def reached(self, node: int, role: Role) -> dict[int, tuple[int, int, int]]:
        """Return the nodes reached from a node by one or more steps of a role: the last edge and its ends.

        Equal nodes are represented by the first of their `members`.
        """
        group, found = self.steps.group(role), dict[int, tuple[int, int, int]]()
        pending = [node]
        for here in pending:
            for edge, start, end in self.related(here, group):
                if (one := self.members(end)[0]) not in found:
                    found[one] = (edge, start, end)
                    pending.append(end)
        return found

    def find(self, one: int, role: Role, other: int) -> int:
        """Return an edge that implies a role between two nodes or their equals, or NONE."""
        group, store = self.steps.group(role), self.store
        if not self.equals and not group.is_wide:
            edge = store.edge_of(one, group.out, other)
            return store.edge_of(other, group.into, one) if edge == NONE else edge
        if group.is_wide or len(self.members(one)) * len(self.members(other)) > MANY:
            there = self.related(other, Group(group.into, group.out))
            for (edge, _, end), (back, _, start) in zip(self.related(one, group), there, strict=False):
                if self.is_same(end, other):
                    return edge
                if self.is_same(start, one):
                    return back
            return NONE
        for x in self.members(one):
            for y in self.members(other):
                edge = store.edge_of(x, group.out, y)
                if edge == NONE:
                    edge = store.edge_of(y, group.into, x)
                if edge != NONE:
                    return edge
        return NONE

    def is_plain(self, edge: int) -> bool:
        """Return whether an edge implies no more than the kinds that its ends already have."""
        store = self.store
        s, p, o = store.subject[edge], store.predicate[edge], store.object[edge]
        if p <= DIFFERENT or store.source[edge] == DERIVED:
            return False
        step = self.steps.step(p, store.kind[s], store.kind[o])
        rules = step.rules
        if step.special or rules is not None:
            only_uniqueness = (step.only_uniqueness or not step.special) and (
                rules is None or rules.only_uniqueness
            )
            return only_uniqueness and store.out.is_alone(edge)
        return True

    def equality_claims(self, edges: Iterable[int], *nodes: int) -> list[Claim]:
        """Return the equality claims between the given nodes and ends of edges."""
        store = self.store
        ends = {node for edge in edges for node in (store.subject[edge], store.object[edge])}
        pairs = combinations(sorted(ends.union(nodes)), 2)
        return [Same(one, other) for one, other in pairs if self.equals and self.is_same(one, other)]

    def set_kind(self, node: int, kind: Kind) -> None:
        """Set the kind of a node."""
        self.changed_kinds.setdefault(node, self.store.kind[node])
        self.store.kind[node] = kind

    def widen(self, node: int, mask: int) -> None:
        """Add classes to a node and all equal nodes."""
        for member in self.members(node):
            kind = self.store.kind[member]
            wider = self.kinds.widen(kind, mask)
            if wider is not kind:
                self.set_kind(member, wider)
                self.dirty[member] = None

    def conclude(
        self, claims: tuple[Claim, ...], *, edge: int | None = None, link: tuple[int, int] | None = None
    ) -> Reason:
        """Create a reason for an edge or link, indexed by the facts that it depends on."""
        reason = Reason(next(self._order), claims, edge=edge, link=link)
        for claim in reason.claims:
            if isinstance(claim, Applied):
                continue
            if isinstance(claim, Edge):
                rest = self.reasons_by_edge.setdefault(claim.edge, [])
            else:
                node = claim.node if isinstance(claim, Member) else claim.one
                rest = self.reasons_by_node.setdefault(node, [])
            if len(rest) >= MANY and len(rest) & (len(rest) - 1) == 0:
                rest[:] = [other for other in rest if other.alive]
            rest.append(reason)
        return reason

    def settle(self) -> None:
        """Update the lists of individuals by kind. Call it at the end of a transaction."""
        for node, before in self.changed_kinds.items():
            if before.excluded is None:
                self.store.list_under_kind(node, before, self.store.kind[node])
        self.changed_kinds.clear()
        self.overlaid.clear()
        self.regrouped.clear()

    def forget_spelling(self, literal: int) -> None:
        """Remove an unused literal from the spellings of its value."""
        value = self.value(literal)
        if value in self.spellings:
            self.spellings[value] = [other for other in self.spellings[value] if other != literal]
            if not self.spellings[value]:
                del self.spellings[value]
