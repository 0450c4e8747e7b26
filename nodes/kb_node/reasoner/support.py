"""Asserted triples that are enough for a claim, found by searching backwards, least deep first.

The result need not be minimal: `proof.prove` shrinks it. Facts of the schema are traced in its own closure.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from nodes.kb_node.reasoner.abox import ABox
from nodes.kb_node.reasoner.kinds import bits
from nodes.kb_node.reasoner.reasons import Claim, Edge, Member, Same
from nodes.kb_node.reasoner.schema import ANY, Axioms, Role
from nodes.kb_node.reasoner.store import ASSERTED, VALUE
from nodes.kb_node.reasoner.terms import SAME_AS, TYPE, iri
from schemas.explanations import Term, Triple

Found = frozenset[Triple]
_DEEPEST = 200
"""Rules one upon the other; no proof in a home comes near."""


class Support:
    """Backward search in an ABox as it stands."""

    def __init__(self, abox: ABox) -> None:
        self._abox = abox
        self._schema = abox.schema
        self._failed: dict[tuple[int, int], int] = {}
        self._found: dict[tuple[int, int], Found] = {}

    def of_clash(self, claims: Iterable[Claim]) -> Found:
        """Asserted triples that contradict each other as the claims of a Clash say."""
        claims = tuple(claims)
        return self.of(claims) | self._axioms_about(claims)

    def of_triple(self, triple: Triple) -> Found:
        """Asserted triples from which a triple follows that holds and is not of the schema."""
        s, p, o = triple
        store, schema = self._abox.store, self._schema
        subject, object_ = store.find(s), store.find(o)
        if p == TYPE:
            return self._claim(Member(_known(subject), _known(schema.find_class(o))))
        if p == SAME_AS:
            return self._same(_known(subject), _known(object_))
        return self.of_edge(_known(subject), _known(schema.find_property(p)), o)

    def of_edge(self, subject: int, predicate: int, object_: Term) -> Found:
        """Why a node is related to a term, or to another spelling of a literal."""
        abox = self._abox
        role = (predicate, False)
        for edge, here, there in abox.related(subject, abox.steps.group(role)):
            if abox.is_term(there, object_):
                implied = role if abox.store.subject[edge] == here else (predicate, True)
                node = abox.store.find(object_)
                ends = self._same(subject, here) | (frozenset() if node is None else self._same(there, node))
                return self._edge(edge, implied) | ends
        raise AssertionError(f"no edge to {object_}")

    def of(self, claims: Iterable[Claim]) -> Found:
        """Asserted triples, of the schema too, from which all claims follow."""
        found: set[Triple] = set()
        for claim in claims:
            found |= self._claim(claim)
        return frozenset(found)

    def _claim(self, claim: Claim) -> Found:
        if isinstance(claim, Edge):
            return self._edge(claim.edge, claim.role)
        if isinstance(claim, Same):
            return self._same(claim.one, claim.other)
        for depth in range(_DEEPEST):
            found = self._member(claim.node, claim.cls, depth)
            if found is not None:
                return found
        raise AssertionError(f"no proof of {claim}")

    # Edges and equality

    def _edge(self, edge: int, role: Role | None = None) -> Found:
        abox, store = self._abox, self._abox.store
        s, p, o = store.subject[edge], store.predicate[edge], store.object[edge]
        found: Found = frozenset()
        if role is not None:
            roles, turned = self._schema.roles(p), (role[0], not role[1])
            found = self._facts((*roles.get(role, ()), *roles.get(turned, ())))
        if store.source[edge] == ASSERTED:
            return found | {(store.terms[s], self._schema.axioms[p].term, store.terms[o])}
        if store.source[edge] != VALUE:
            result = self._schema.axioms[p]
            return found | self.of(abox.reasons[edge].claims) | self._chain_facts(result)
        for cls in store.kind[s].values:
            if self._schema.values[cls] == (p, store.terms[o]):
                return found | self._claim(Member(s, cls)) | self._restriction(cls)
        raise AssertionError(f"nothing gives {store.terms[s]} its {self._schema.axioms[p].term}")

    def _same(self, one: int, other: int) -> Found:
        """The links on the way from one node to the other."""
        if one == other or (equals := self._abox.equals.get(one)) is None:
            return frozenset()
        trail: dict[int, Found] = {one: frozenset()}
        pending = [one]
        while other not in trail:
            here = pending.pop(0)
            for link in equals.links:
                if link.link and here in link.link:
                    there = link.link[1] if link.link[0] == here else link.link[0]
                    if there not in trail:
                        trail[there] = trail[here] | self.of_clash(link.claims)
                        pending.append(there)
        return trail[other]

    # Classes

    def _member(self, node: int, cls: int, depth: int) -> Found | None:
        """Why a node is in a class, by at most `depth` edges and intersections; None if not by so few."""
        key = (node, cls)
        if key in self._found:
            return self._found[key]
        if self._failed.get(key, -1) >= depth:
            return None
        found = self._given(node, cls)
        if found is None and depth > 0:
            found = next(self._ways(node, cls, depth - 1), None)
        if found is None:
            self._failed[key] = depth
        else:
            self._found[key] = found
        return found

    def _given(self, node: int, cls: int) -> Found | None:
        """A given class of the node, or of one that is the same, that is a subclass."""
        store, schema = self._abox.store, self._schema
        for member in self._abox.members(node):
            for given in store.kind[member].given:
                if schema.supers[given] >> cls & 1:
                    told = self._told(member, given) | self._below(given, cls)
                    return told | self._same(node, member)
        return None

    def _told(self, node: int, given: int) -> Found:
        name = self._schema.classes[given]
        if name.startswith("{") or self._abox.is_literal(node):
            return frozenset()
        return frozenset({(self._abox.store.terms[node], TYPE, name)})

    def _ways(self, node: int, cls: int, depth: int) -> Iterator[Found]:
        """Derivations of a class that are not by subclass alone."""
        schema = self._schema
        for members, whole in schema.intersections:
            if schema.supers[whole] >> cls & 1:
                parts = [self._member(node, part, depth) for part in bits(members)]
                if None not in parts:
                    axiom = self._axiom(schema.classes[whole], "owl:intersectionOf")
                    yield frozenset().union(axiom, self._below(whole, cls), *(p for p in parts if p))
        store = self._abox.store
        for member in self._abox.members(node):
            same = self._same(node, member)
            for edge in (*store.out.all(member), *store.into.all(member)):
                if store.source[edge] == VALUE and not self._may_use(edge, depth):
                    continue
                for way in self._by_edge(edge, member, cls, depth):
                    yield same | way

    def _may_use(self, edge: int, depth: int) -> bool:
        """Whether the class that an edge comes with is found less deep, so that no proof rests on itself."""
        store = self._abox.store
        s, value = store.subject[edge], (store.predicate[edge], store.terms[store.object[edge]])
        return any(
            self._schema.values[cls] == value and self._member(s, cls, depth) is not None
            for cls in store.kind[s].values
        )

    def _by_edge(self, edge: int, node: int, cls: int, depth: int) -> Iterator[Found]:
        """What domains, ranges and restrictions say of one end of an edge."""
        store, schema = self._abox.store, self._schema
        s, p, o = store.subject[edge], store.predicate[edge], store.object[edge]
        for role in schema.roles(p):
            axioms = schema.axioms[role[0]]
            x, y = (o, s) if role[1] else (s, o)
            ends = ((x, axioms.domain, "rdfs:domain"), (y, axioms.range, "rdfs:range"))
            for end, mask, name in ends:
                for wider in bits(mask) if end == node else ():
                    if schema.supers[wider] >> cls & 1:
                        fact = (axioms.term, iri(name), schema.classes[wider])
                        yield self._edge(edge, role) | self._facts([fact]) | self._below(wider, cls)
            if x == node:
                for restriction, filler in axioms.some:
                    yield from self._through(edge, role, (restriction, cls), (y, filler), restriction, depth)
            if y == node:
                for restriction, filler in axioms.only:
                    yield from self._through(edge, role, (filler, cls), (x, restriction), restriction, depth)

    def _through(
        self, edge: int, role: Role, gained: tuple[int, int], needed: tuple[int, int], axiom: int, depth: int
    ) -> Iterator[Found]:
        """A restriction: gaining its class here needs a class at the other end."""
        narrow, cls = gained
        if not self._schema.supers[narrow] >> cls & 1:
            return
        far, wanted = needed
        there = frozenset() if wanted == ANY else self._member(far, wanted, depth)
        if there is not None:
            yield there | self._edge(edge, role) | self._restriction(axiom) | self._below(narrow, cls)

    # The schema

    def _below(self, narrow: int, wide: int) -> Found:
        """Why one class is a subclass of another; for a nominal, the axiom that mentions it."""
        schema = self._schema
        if narrow == wide:
            return frozenset()
        name, wider = schema.classes[narrow], schema.classes[wide]
        if not name.startswith("{"):
            return self._facts([(name, iri("rdfs:subClassOf"), wider)])
        member = name[1:-1]
        for fact in schema.closure.match(member, TYPE):
            if fact[2] == wider or (fact[2], iri("rdfs:subClassOf"), wider) in schema.closure.facts:
                return self._facts([fact]) | self._facts([(fact[2], iri("rdfs:subClassOf"), wider)])
        return frozenset()

    def _facts(self, facts: Iterable[Triple]) -> Found:
        """The asserted triples below facts of the schema's closure."""
        closure = self._schema.closure
        leaves: set[Triple] = set()
        for fact in facts:
            if fact in closure.facts:
                leaves.update(closure.leaves(fact))
        return frozenset(leaves)

    def _axiom(self, subject: Term, *names: str) -> Found:
        """All that the schema's closure says of a subject with some predicates, lists included."""
        closure = self._schema.closure
        found: set[Triple] = set()
        for name in names:
            for fact in closure.match(subject, iri(name)):
                found |= self._facts([fact])
                members = closure.members(fact[2])
                found.update(members[1] if members else ())
        return frozenset(found)

    def _restriction(self, cls: int) -> Found:
        return self._axiom(self._schema.classes[cls], *_RESTRICTION)

    def _axioms_about(self, claims: Iterable[Claim]) -> Found:
        """The axioms that may make claims a contradiction, or their nodes the same."""
        store, schema = self._abox.store, self._schema
        classes: set[int] = set()
        terms: set[Term] = set()
        found: set[Triple] = set()
        for claim in claims:
            if isinstance(claim, Edge):
                prop = store.predicate[claim.edge]
                terms.update(schema.axioms[q].term for q, _ in ((prop, False), claim.role or (prop, False)))
            elif isinstance(claim, Member) and claim.cls >= 0:
                classes.add(claim.cls)
        for cls in classes:
            name = schema.classes[cls]
            terms.add(name.strip("{}") if cls not in schema.negatives else name)
            found |= self._restriction(cls)
            if node := schema.negatives.get(cls):
                found |= self._axiom(node, *_NEGATIVE)
        for term in terms:
            found |= self._axiom(term, "rdf:type", *_BETWEEN)
            for axiom in schema.listed.get(term, ()):
                found |= self._axiom(axiom, "rdf:type", "owl:members", "owl:distinctMembers")
        return frozenset(found)

    def _chain_facts(self, result: Axioms) -> Found:
        transitive = (result.term, TYPE, iri("owl:TransitiveProperty"))
        return self._axiom(result.term, "owl:propertyChainAxiom") | self._facts([transitive])


def _known(number: int | None) -> int:
    assert number is not None
    return number


_BETWEEN = (
    "owl:disjointWith", "owl:complementOf", "owl:propertyDisjointWith", "owl:hasKey",
)  # fmt: skip
_NEGATIVE = (
    "owl:sourceIndividual", "owl:assertionProperty", "owl:targetIndividual", "owl:targetValue",
)  # fmt: skip
_RESTRICTION = (
    "owl:onProperty", "owl:onClass", "owl:someValuesFrom", "owl:allValuesFrom", "owl:hasValue",
    "owl:maxCardinality", "owl:maxQualifiedCardinality",
)  # fmt: skip
