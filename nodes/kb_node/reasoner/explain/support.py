"""Asserted triples that entail a claim, found by backward search with iterative deepening.

The result need not be minimal: `proof.Prover` shrinks it. Facts of the schema are traced in its own closure.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import inf
from typing import TypeVar

from semmap.nodes.kb_node.reasoner.abox.abox import ABox
from semmap.nodes.kb_node.reasoner.abox.kinds import bits
from semmap.nodes.kb_node.reasoner.abox.store import DERIVED, GIVEN
from semmap.nodes.kb_node.reasoner.explain.reasons import Applied, Claim, Edge, Member, Reason, Same
from semmap.nodes.kb_node.reasoner.explain.schema_support import Found, SchemaSupport, union
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.tbox.axioms import ANY, Role
from semmap.nodes.kb_node.reasoner.terms import SAME_AS, TYPE, iri

_T = TypeVar("_T")
_DEEPEST = 200
"""Maximum depth of a proof. Proofs about a home are far below it."""


class Support:
    """Backward search in the current state of an ABox."""

    def __init__(self, abox: ABox, schema_support: SchemaSupport, before: float = inf) -> None:
        """Search an ABox. Only conclusions with an order below `before` are used."""
        self._abox = abox
        self._before = before
        self._schema = abox.schema
        self._schema_support = schema_support
        self._failed: dict[tuple[int, int], int] = {}
        self._found: dict[tuple[int, int], Found] = {}

    def of_clash(self, claims: Iterable[Claim]) -> Found:
        """Return the asserted triples behind the claims of a Clash, which contradict each other."""
        claims = tuple(claims)
        return self.of(claims) | self._axioms_about(claims)

    def of_triple(self, triple: Triple) -> Found:
        """Return asserted triples that entail a triple. It must hold and not be an axiom."""
        s, p, o = triple
        store, schema = self._abox.store, self._schema
        subject, object_ = store.find(s), store.find(o)
        if p == TYPE:
            return self._claim(Member(_require(subject), _require(schema.find_class(o))))
        if p == SAME_AS:
            return _require(self._same(_require(subject), _require(object_)))
        return self.of_edge(_require(subject), _require(schema.find_property(p)), o)

    def of_edge(self, subject: int, predicate: int, object_: Term) -> Found:
        """Return why a node is related to a term, or to another spelling of a literal."""
        abox = self._abox
        role = (predicate, False)
        for edge, here, there in abox.related(subject, abox.steps.group(role)):
            if (node := abox.named(there, object_)) is not None:
                implied = role if abox.store.subject[edge] == here else (predicate, True)
                same = self._same(subject, here), self._same(there, node)
                return union(self._edge(edge, implied), *(ends for ends in same if ends))
        for chained in self._schema.transitive_roles(predicate):
            if (found := self._of_chain(subject, chained, object_)) is not None:
                return found
        raise AssertionError(f"no edge to {object_}")

    def _of_chain(self, subject: int, role: Role, object_: Term) -> Found | None:
        """Return the steps of a transitive role from a node to a term."""
        abox = self._abox
        reached = abox.reached(subject, role)
        last = next((end for _, _, end in reached.values() if abox.named(end, object_) is not None), None)
        if last is None:
            return None
        found = self._schema_support.transitive(role[0]) | (
            self._same(last, _require(abox.named(last, object_))) or {}
        )
        here, is_first = last, True
        while is_first or not abox.is_same(here, subject):
            edge, start, end = reached[abox.members(here)[0]]
            implied = role if abox.store.subject[edge] == start else (role[0], not role[1])
            found |= self._edge(edge, implied) | (self._same(end, here) or {})
            here, is_first = start, False
        return found | (self._same(subject, here) or {})

    def of(self, claims: Iterable[Claim]) -> Found:
        """Return the asserted triples, including axioms, from which all claims follow."""
        return union(*map(self._claim, claims))

    def _claim(self, claim: Claim) -> Found:
        if isinstance(claim, Edge):
            return self._edge(claim.edge, claim.role)
        if isinstance(claim, Applied):
            return dict.fromkeys(claim.rule.triples)
        if isinstance(claim, Same):
            return self._same(claim.one, claim.other) or {}
        for depth in range(_DEEPEST):
            found = self._member(claim.node, claim.cls, depth)
            if found is not None:
                return found
        raise AssertionError(f"no proof of {claim}")

    def _axioms_about(self, claims: Iterable[Claim]) -> Found:
        """Return the axioms by which claims may contradict each other or equate their nodes."""
        found: Found = {}
        for claim in claims:
            if isinstance(claim, Edge):
                prop = self._abox.store.predicate[claim.edge]
                for q, _ in dict.fromkeys(((prop, False), claim.role or (prop, False))):
                    found |= self._schema_support.about(self._schema.axioms[q].term)
            elif isinstance(claim, Member) and claim.cls >= 0:
                found |= self._schema_support.about_class(claim.cls)
        return found

    # Edges and equality

    def _edge(self, edge: int, role: Role | None = None) -> Found:
        abox, store = self._abox, self._abox.store
        s, p, o = store.subject[edge], store.predicate[edge], store.object[edge]
        found: Found = {}
        if role is not None:
            roles, turned = self._schema.roles(p), (role[0], not role[1])
            found = self._schema_support.facts((*roles.get(role, ()), *roles.get(turned, ())))
        if store.source[edge] in GIVEN:
            return found | {(store.terms[s], self._schema.axioms[p].term, store.terms[o]): None}
        if store.source[edge] == DERIVED:
            reason = abox.reasons[edge]
            return (
                found
                | self._earlier(reason).of(reason.claims)
                | self._schema_support.chains(self._schema.axioms[p])
            )
        found_before = [cls for cls in self._value_classes(edge) if (s, cls) in self._found]
        for cls in found_before or self._value_classes(edge):
            return found | self._claim(Member(s, cls)) | self._schema_support.restriction(cls)
        raise AssertionError(f"no class implies {self._schema.axioms[p].term} of {store.terms[s]}")

    def _value_classes(self, edge: int) -> Iterator[int]:
        """Return the classes of a subject that may imply its edge (owl:hasValue)."""
        store = self._abox.store
        mask = store.kind[store.subject[edge]].mask
        value = (store.predicate[edge], store.terms[store.object[edge]])
        return (cls for cls, known in self._schema.values.items() if known == value and mask >> cls & 1)

    def _earlier(self, reason: Reason) -> Support:
        """Return a search limited to facts before a conclusion, so that no proof depends on itself."""
        return Support(self._abox, self._schema_support, reason.order)

    def _same(self, one: int, other: int) -> Found | None:
        """Return the support of the links between two nodes; None if they are not linked yet."""
        if one == other or (equals := self._abox.equals.get(one)) is None:
            return {}
        links = [link for link in equals.links if link.order < self._before]
        trail: dict[int, Found] = {one: {}}
        pending = [one]
        while pending and other not in trail:
            here = pending.pop(0)
            for link in links:
                if link.link and here in link.link:
                    there = link.link[1] if link.link[0] == here else link.link[0]
                    if there not in trail:
                        trail[there] = trail[here] | self._earlier(link).of_clash(link.claims)
                        pending.append(there)
        return trail.get(other)

    # Classes

    def _member(self, node: int, cls: int, depth: int) -> Found | None:
        """Return why a node is in a class, by at most `depth` edges and intersections; None if not found."""
        key = (node, cls)
        if key in self._found:
            return self._found[key]
        if self._failed.get(key, -1) >= depth:
            return None
        found = self._given(node, cls)
        if found is None and depth > 0:
            found = next(self._derivations(node, cls, depth - 1), None)
        if found is None:
            self._failed[key] = depth
        else:
            self._found[key] = found
        return found

    def _given(self, node: int, cls: int) -> Found | None:
        """Return the support from a given subclass of the node, or of an equal node."""
        store, schema = self._abox.store, self._schema
        for member in self._abox.members(node):
            for given in store.kind[member].given:
                if schema.supers[given] >> cls & 1:
                    same = self._same(node, member)
                    if same is not None:
                        return self._type_fact(member, given) | self._schema_support.below(given, cls) | same
        return None

    def _type_fact(self, node: int, given: int) -> Found:
        name = self._schema.classes[given]
        if self._abox.is_literal(node):
            return self._schema_support.data_range(given) | self._mention(node)
        if name.startswith("{"):
            return {}
        return {(self._abox.store.terms[node], TYPE, name): None}

    def _mention(self, node: int) -> Found:
        """Return an asserted triple with a literal, which makes its value part of the graph."""
        store = self._abox.store
        edges = [edge for edge in store.into.all(node) if store.source[edge] in GIVEN]
        return self._edge(edges[0]) if edges else {}

    def _derivations(self, node: int, cls: int, depth: int) -> Iterator[Found]:
        """Yield derivations of a class that use more than subclass axioms."""
        schema = self._schema
        for members, whole in schema.intersections:
            if schema.supers[whole] >> cls & 1:
                parts = [self._member(node, part, depth) for part in bits(members)]
                if None not in parts:
                    axiom = self._schema_support.axiom(schema.classes[whole], "owl:intersectionOf")
                    yield union(
                        axiom, self._schema_support.below(whole, cls), *(part for part in parts if part)
                    )
        store = self._abox.store
        for member in self._abox.members(node):
            same = self._same(node, member)
            for edge in (*store.out.all(member), *store.into.all(member)):
                if same is None or not self._may_use(edge, depth):
                    continue
                for derivation in self._by_edge(edge, member, cls, depth):
                    yield same | derivation

    def _may_use(self, edge: int, depth: int) -> bool:
        """Return whether an edge exists independently of the conclusion to be proved."""
        store = self._abox.store
        if store.source[edge] in GIVEN:
            return True
        if store.source[edge] == DERIVED:
            return self._abox.reasons[edge].order < self._before
        return any(
            self._member(store.subject[edge], cls, depth) is not None for cls in self._value_classes(edge)
        )

    def _by_edge(self, edge: int, node: int, cls: int, depth: int) -> Iterator[Found]:
        """Yield derivations of a class of one end of an edge by domains, ranges and restrictions."""
        store, schema = self._abox.store, self._schema
        s, p, o = store.subject[edge], store.predicate[edge], store.object[edge]
        for role in schema.roles(p):
            axioms = schema.axioms[role[0]]
            x, y = (o, s) if role[1] else (s, o)
            chained = self._schema_support.transitive(role[0]) if role[0] in schema.virtual else {}
            ends = ((x, axioms.domain, "rdfs:domain"), (y, axioms.range, "rdfs:range"))
            for end, mask, name in ends:
                for wider in bits(mask) if end == node else ():
                    if schema.supers[wider] >> cls & 1:
                        fact = (axioms.term, iri(name), schema.classes[wider])
                        yield (
                            self._edge(edge, role)
                            | self._schema_support.facts([fact])
                            | self._schema_support.below(wider, cls)
                        )
            if x == node:
                for restriction, filler in axioms.some:
                    for derivation in self._through(
                        edge, role, (restriction, cls), (y, filler), restriction, depth
                    ):
                        yield derivation | chained
            if y == node:
                for restriction, filler in axioms.only:
                    for derivation in self._through(
                        edge, role, (filler, cls), (x, restriction), restriction, depth
                    ):
                        yield derivation | chained

    def _through(
        self, edge: int, role: Role, gained: tuple[int, int], needed: tuple[int, int], axiom: int, depth: int
    ) -> Iterator[Found]:
        """Yield derivations by a restriction, which requires a class at the other end."""
        narrow, cls = gained
        if not self._schema.supers[narrow] >> cls & 1:
            return
        far, wanted = needed
        there = {} if wanted == ANY else self._member(far, wanted, depth)
        if there is not None:
            yield (
                there
                | self._edge(edge, role)
                | self._schema_support.restriction(axiom)
                | self._schema_support.below(narrow, cls)
            )


def _require(value: _T | None) -> _T:
    if value is None:
        raise LookupError("a conclusion has no reason")
    return value
