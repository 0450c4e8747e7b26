"""Entailment of axioms: each axiom is tested on fresh individuals."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import combinations
from typing import Final

from semmap.nodes.kb_node.reasoner.entailment.expressions import Expression, Named, Or, Reader, Role
from semmap.nodes.kb_node.reasoner.entailment.prover import Prover
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.terms import DIFFERENT_FROM, TYPE, iri


class AxiomProver:
    """Proves axioms. `reader` reads the graph that states them.

    An axiom follows if its instance for fresh individuals follows. The graph has no facts about these, so the
    proof applies to all individuals (generalisation).
    """

    def __init__(self, prover: Prover, reader: Reader) -> None:
        self._prover = prover
        self._reader = reader
        self.relations: Final[dict[Term, Callable[[Term, Term], bool]]] = {
            iri("rdfs:subClassOf"): lambda c, d: self.sub_class(self._class(c), self._class(d)),
            iri("owl:equivalentClass"): lambda c, d: self.same_class(self._class(c), self._class(d)),
            iri("owl:disjointWith"): lambda c, d: self.disjoint_classes([self._class(c), self._class(d)]),
            iri("owl:disjointUnionOf"): self._disjoint_union,
            iri("rdfs:subPropertyOf"): lambda p, q: self.sub_property(self._role(p), self._role(q)),
            iri("owl:equivalentProperty"): lambda p, q: self.same_property(self._role(p), self._role(q)),
            iri("owl:inverseOf"): lambda p, q: self.same_property(self._role(p), _inverse(self._role(q))),
            iri("owl:propertyDisjointWith"): lambda p, q: self.disjoint_properties(
                [self._role(p), self._role(q)]
            ),
            iri("owl:propertyChainAxiom"): lambda p, head: self.chain(
                list(map(self._role, self._reader.members(head))), self._role(p)
            ),
            iri("rdfs:domain"): lambda p, c: self.domain(self._role(p), self._class(c)),
            iri("rdfs:range"): lambda p, c: self.domain(_inverse(self._role(p)), self._class(c)),
            iri("owl:hasKey"): lambda c, head: self.key(
                self._class(c), list(map(self._role, self._reader.members(head)))
            ),
        }
        """The test of an axiom by its predicate. The tests raise Unreadable."""
        self.characteristics: Final[dict[Term, Callable[[Role], bool]]] = {
            iri("owl:FunctionalProperty"): self.functional,
            iri("owl:InverseFunctionalProperty"): lambda p: self.functional(_inverse(p)),
            iri("owl:ReflexiveProperty"): self.reflexive,
            iri("owl:IrreflexiveProperty"): self.irreflexive,
            iri("owl:SymmetricProperty"): lambda p: self.sub_property(p, _inverse(p)),
            iri("owl:AsymmetricProperty"): lambda p: self.disjoint_properties([p, _inverse(p)]),
            iri("owl:TransitiveProperty"): lambda p: self.chain([p, p], p),
        }

    def _class(self, node: Term) -> Expression:
        return self._reader.expression(node)

    def _role(self, node: Term) -> Role:
        return self._reader.role(node)

    # Classes

    def sub_class(self, narrow: Expression, wide: Expression) -> bool:
        """Return whether a fresh member of one class is in the other."""
        x = self._prover.fresh()
        return self._prover.follows_from_each(
            self._prover.membership_alternatives(x, narrow), lambda: self._prover.member(x, wide)
        )

    def same_class(self, one: Expression, other: Expression) -> bool:
        """Return whether each class is a subclass of the other."""
        return self.sub_class(one, other) and self.sub_class(other, one)

    def disjoint_classes(self, classes: Sequence[Expression]) -> bool:
        """Return whether a fresh member of any two of the classes is a contradiction."""
        return all(self._never_both(one, other) for one, other in combinations(classes, 2))

    def _never_both(self, one: Expression, other: Expression) -> bool:
        x, prover = self._prover.fresh(), self._prover
        return prover.follows_from_each(
            prover.membership_alternatives(x, one),
            lambda: prover.follows_from_each(prover.membership_alternatives(x, other), lambda: False),
        )

    def _disjoint_union(self, whole: Term, head: Term) -> bool:
        parts = [self._class(part) for part in self._reader.members(head)]
        return self.disjoint_classes(parts) and self.same_class(Named(whole), Or(tuple(parts)))

    def key(self, cls: Expression, roles: Sequence[Role]) -> bool:
        """Return whether two fresh members with a common value of each property are the same."""
        x, y, prover = self._prover.fresh(), self._prover.fresh(), self._prover
        edges = [
            role.edge(member, value) for role in roles for value in [prover.fresh()] for member in (x, y)
        ]
        alternatives = [
            [*edges, *one, *other]
            for one in prover.membership_alternatives(x, cls)
            for other in prover.membership_alternatives(y, cls)
        ]
        return prover.follows_from_each(alternatives, lambda: prover.refutes((x, DIFFERENT_FROM, y)))

    # Properties

    def sub_property(self, narrow: Role, wide: Role) -> bool:
        """Return whether a fresh pair that is related by one property is related by the other."""
        x, y = self._prover.fresh(), self._prover.fresh()
        return self._prover.follows([narrow.edge(x, y)], lambda: self._prover.fact(wide.edge(x, y)))

    def same_property(self, one: Role, other: Role) -> bool:
        """Return whether each property is a subproperty of the other."""
        return self.sub_property(one, other) and self.sub_property(other, one)

    def disjoint_properties(self, roles: Sequence[Role]) -> bool:
        """Return whether a fresh pair that is related by any two of the properties is a contradiction."""
        return all(
            self._prover.refutes(one.edge(x, y), other.edge(x, y))
            for one, other in combinations(roles, 2)
            for x, y in [(self._prover.fresh(), self._prover.fresh())]
        )

    def chain(self, links: Sequence[Role], result: Role) -> bool:
        """Return whether the ends of a chain of fresh individuals are related by the result."""
        stops = [self._prover.fresh() for _ in range(len(links) + 1)]
        edges = [link.edge(stops[i], stops[i + 1]) for i, link in enumerate(links)]
        return self._prover.follows(edges, lambda: self._prover.fact(result.edge(stops[0], stops[-1])))

    def domain(self, role: Role, cls: Expression) -> bool:
        """Return whether the subject of a fresh edge is in the class."""
        x, y = self._prover.fresh(), self._prover.fresh()
        return self._prover.follows([role.edge(x, y)], lambda: self._prover.member(x, cls))

    def functional(self, role: Role) -> bool:
        """Return whether two different values of a fresh individual are a contradiction."""
        x, y, z = (self._prover.fresh() for _ in range(3))
        return self._prover.refutes(role.edge(x, y), role.edge(x, z), (y, DIFFERENT_FROM, z))

    def reflexive(self, role: Role) -> bool:
        """Return whether a fresh individual is related to itself."""
        x = self._prover.fresh()
        return self._prover.fact(role.edge(x, x))

    def irreflexive(self, role: Role) -> bool:
        """Return whether a fresh edge from an individual to itself is a contradiction."""
        x = self._prover.fresh()
        return self._prover.refutes(role.edge(x, x))

    # Individuals

    def all_different(self, members: Sequence[Term]) -> bool:
        """Return whether all members are pairwise different."""
        return all(self._prover.different(one, other) for one, other in combinations(members, 2))

    def never(self, edge: Triple) -> bool:
        """Return whether an edge is a contradiction (negative property assertion)."""
        return self._prover.refutes(edge)

    def is_used_as(self, term: Term, kind: Term) -> bool:
        """Return whether the graph uses a term as a class or property (RDF-Based Semantics)."""
        asserted = self._prover.asserted
        subject, object_ = _USES.get(kind, ((), ()))
        return (
            any(next(iter(asserted(term, iri(name), None)), None) for name in subject)
            or any(next(iter(asserted(None, iri(name), term)), None) for name in object_)
            or any(self._prover.holds((term, TYPE, iri(name))) for name in _NARROWER.get(kind, "").split())
            or (kind in _PROPERTIES and next(iter(asserted(None, term, None)), None) is not None)
        )


def _inverse(role: Role) -> Role:
    return Role(role.property, not role.backwards)


_AS_CLASS = (
    (
        "rdfs:subClassOf", "owl:equivalentClass", "owl:disjointWith", "owl:complementOf",
        "owl:intersectionOf", "owl:unionOf", "owl:oneOf", "owl:onProperty", "owl:hasKey",
    ),
    (
        "rdf:type", "rdfs:subClassOf", "owl:equivalentClass", "owl:disjointWith", "owl:complementOf",
        "rdfs:domain", "rdfs:range", "owl:someValuesFrom", "owl:allValuesFrom", "owl:onClass",
    ),
)  # fmt: skip
_AS_PROPERTY = (
    (
        "rdfs:subPropertyOf", "owl:equivalentProperty", "owl:inverseOf", "owl:propertyDisjointWith",
        "owl:propertyChainAxiom", "rdfs:domain", "rdfs:range",
    ),
    (
        "rdfs:subPropertyOf", "owl:equivalentProperty", "owl:inverseOf", "owl:propertyDisjointWith",
        "owl:onProperty", "owl:assertionProperty",
    ),
)  # fmt: skip
_OBJECT = (
    "owl:ObjectProperty owl:SymmetricProperty owl:AsymmetricProperty owl:TransitiveProperty "
    "owl:ReflexiveProperty owl:IrreflexiveProperty owl:InverseFunctionalProperty"
)
_NARROWER = {
    iri("owl:Class"): "rdfs:Class owl:Restriction",
    iri("rdfs:Class"): "owl:Class owl:Restriction rdfs:Datatype",
    iri("owl:ObjectProperty"): _OBJECT,
    iri("rdf:Property"): f"{_OBJECT} owl:DatatypeProperty owl:AnnotationProperty owl:FunctionalProperty",
}
"""Subclasses of the classes by which terms are declared."""
_CLASSES = {iri("owl:Class"), iri("rdfs:Class")}
_PROPERTIES = {iri("rdf:Property"), iri("owl:ObjectProperty")}
_USES = dict.fromkeys(_CLASSES, _AS_CLASS) | dict.fromkeys(_PROPERTIES, _AS_PROPERTY)
