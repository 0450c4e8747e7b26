"""Converts OWL axioms to RDF triples by the W3C mapping of OWL 2 to RDF graphs.

`py-horned-owl` parses axioms, but its RDF output loses the identity of anonymous individuals. SWRL rules are
converted as in RDF/XML.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import pyhornedowl.model as m

from semmap.nodes.kb_node.documents.owl.expression_triples import DATATYPE, Expressions, owl, swrl
from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term, Triple

_AXIOM, _ANNOTATION = owl("Axiom"), owl("Annotation")
_DECLARATIONS: dict[type, Term] = {
    m.DeclareClass: v.OWL_CLASS,
    m.DeclareDatatype: DATATYPE,
    m.DeclareObjectProperty: v.OWL_OBJECT_PROPERTY,
    m.DeclareDataProperty: v.OWL_DATATYPE_PROPERTY,
    m.DeclareAnnotationProperty: v.OWL_ANNOTATION_PROPERTY,
    m.DeclareNamedIndividual: v.OWL_NAMED_INDIVIDUAL,
}
_CHARACTERISTICS: dict[type, Term] = {
    m.FunctionalObjectProperty: owl("FunctionalProperty"),
    m.FunctionalDataProperty: owl("FunctionalProperty"),
    m.InverseFunctionalObjectProperty: owl("InverseFunctionalProperty"),
    m.ReflexiveObjectProperty: owl("ReflexiveProperty"),
    m.IrreflexiveObjectProperty: owl("IrreflexiveProperty"),
    m.SymmetricObjectProperty: owl("SymmetricProperty"),
    m.AsymmetricObjectProperty: owl("AsymmetricProperty"),
    m.TransitiveObjectProperty: owl("TransitiveProperty"),
}
_OF_TWO: dict[type, tuple[str, Term, str]] = {
    m.SubClassOf: ("sub", v.RDFS_SUB_CLASS_OF, "sup"),
    m.SubDataPropertyOf: ("sub", v.RDFS_SUB_PROPERTY_OF, "sup"),
    m.SubAnnotationPropertyOf: ("sub", v.RDFS_SUB_PROPERTY_OF, "sup"),
    m.ObjectPropertyDomain: ("ope", v.RDFS_DOMAIN, "ce"),
    m.ObjectPropertyRange: ("ope", v.RDFS_RANGE, "ce"),
    m.DataPropertyDomain: ("dp", v.RDFS_DOMAIN, "ce"),
    m.DataPropertyRange: ("dp", v.RDFS_RANGE, "dr"),
    m.AnnotationPropertyDomain: ("ap", v.RDFS_DOMAIN, "iri"),
    m.AnnotationPropertyRange: ("ap", v.RDFS_RANGE, "iri"),
    m.InverseObjectProperties: ("first", owl("inverseOf"), "second"),
    m.DatatypeDefinition: ("kind", owl("equivalentClass"), "range"),
    m.ClassAssertion: ("i", v.RDF_TYPE, "ce"),
}
_CHAINED: dict[type, Term] = {
    m.EquivalentClasses: owl("equivalentClass"),
    m.EquivalentObjectProperties: owl("equivalentProperty"),
    m.EquivalentDataProperties: owl("equivalentProperty"),
    m.SameIndividual: v.OWL_SAME_AS,
}
_APART: dict[type, tuple[Term, Term]] = {
    m.DisjointClasses: (owl("disjointWith"), owl("AllDisjointClasses")),
    m.DisjointObjectProperties: (owl("propertyDisjointWith"), owl("AllDisjointProperties")),
    m.DisjointDataProperties: (owl("propertyDisjointWith"), owl("AllDisjointProperties")),
    m.DifferentIndividuals: (v.OWL_DIFFERENT_FROM, owl("AllDifferent")),
}
_ATOMS: dict[type, tuple[str, Term]] = {
    m.ClassAtom: ("ClassAtom", swrl("classPredicate")),
    m.DataRangeAtom: ("DataRangeAtom", swrl("dataRange")),
    m.ObjectPropertyAtom: ("IndividualPropertyAtom", swrl("propertyPredicate")),
    m.DataPropertyAtom: ("DatavaluedPropertyAtom", swrl("propertyPredicate")),
    m.BuiltInAtom: ("BuiltinAtom", swrl("builtin")),
    m.SameIndividualAtom: ("SameIndividualAtom", ""),
    m.DifferentIndividualsAtom: ("DifferentIndividualsAtom", ""),
}


def triples_of(components: Iterable[m.AnnotatedComponent]) -> list[Triple]:
    """Return the triples of an ontology; their order and blank nodes depend only on its axioms."""
    components = list(components)
    ontology = _ontology(components)
    parts = sorted({tuple(_Part(ontology).of(c).triples) for c in components})
    triples: list[Triple] = [] if ontology.startswith("<") else [(ontology, v.RDF_TYPE, v.OWL_ONTOLOGY)]
    for i, part in enumerate(parts):
        triples += [(_numbered(s, i), p, _numbered(o, i)) for s, p, o in part]
    return list(dict.fromkeys(triples))


def _ontology(components: Iterable[m.AnnotatedComponent]) -> Term:
    for c in components:
        if isinstance(c.component, m.OntologyID) and c.component.iri is not None:
            return v.iri(str(c.component.iri))
    return "_:ontology"


def _numbered(term: Term, part: int) -> Term:
    """Return a term with the part in the label of the mapping's own blank nodes, which begin with a digit."""
    return f"_:p{part}n{term[2:]}" if term.startswith("_:") and term[2].isdigit() else term


class _Part(Expressions):
    """The triples of one axiom."""

    def __init__(self, ontology: Term) -> None:
        super().__init__()
        self._ontology = ontology

    def of(self, annotated: m.AnnotatedComponent) -> _Part:
        """Add an axiom with its annotations."""
        axiom: Any = annotated.component
        about = self._map_axiom(axiom)
        for added in about:
            self._annotate(added, annotated.ann, _AXIOM)
        return self

    def _map_axiom(self, axiom: Any) -> Sequence[Triple | Term]:
        """Add an axiom. Return what its annotations are about: triples, or the blank node of the axiom."""
        kind = type(axiom)
        if kind in _DECLARATIONS:
            return self.add(self.term(axiom.first), v.RDF_TYPE, _DECLARATIONS[kind])
        if kind in _CHARACTERISTICS:
            return self.add(self.term(axiom.first), v.RDF_TYPE, _CHARACTERISTICS[kind])
        if kind in _OF_TWO:
            subject, predicate, value = _OF_TWO[kind]
            return self.add(self.term(getattr(axiom, subject)), predicate, self.term(getattr(axiom, value)))
        if kind in _CHAINED:
            terms = list(map(self.term, axiom.first))
            pairs = itertools.pairwise(terms)
            return [t for a, b in pairs for t in self.add(a, _CHAINED[kind], b)]
        if kind in _APART:
            return self._apart(axiom.first, *_APART[kind])
        return _OTHERS.get(kind, _Part._nothing)(self, axiom)

    def _apart(self, members: Sequence[Any], predicate: Term, kind: Term) -> Sequence[Triple | Term]:
        terms = list(map(self.term, members))
        if len(terms) == 2:
            return self.add(terms[0], predicate, terms[1])
        node = self.new_blank_node(kind)
        self.add(node, owl("members"), self.list_of(terms))
        return [node]

    def _annotate(
        self, about: Triple | Term, annotations: Iterable[m.Annotation], kind: Term = _ANNOTATION
    ) -> None:
        """Add the annotations of a node, or of a triple of a `kind`, and their own annotations."""
        added = sorted(
            (((self.term(a.ap), self.term(a.av)), a.ann) for a in annotations), key=lambda pair: pair[0]
        )
        if not added:
            return
        node = about if isinstance(about, str) else self._reified(about, kind)
        for (predicate, value), own in added:
            self._annotate(self.add(node, predicate, value)[0], own)

    def _reified(self, triple: Triple, kind: Term) -> Term:
        node = self.new_blank_node(kind)
        for name, term in zip(("Source", "Property", "Target"), triple, strict=True):
            self.add(node, owl(f"annotated{name}"), term)
        return node

    # Axioms with a mapping of their own

    def _nothing(self, _: Any) -> list[Triple]:
        return []

    def _identity(self, axiom: m.OntologyID) -> list[Triple]:
        if axiom.viri is not None:
            self.add(self._ontology, owl("versionIRI"), self.term(axiom.viri))
        return self.add(self._ontology, v.RDF_TYPE, v.OWL_ONTOLOGY)

    def _import(self, axiom: m.Import) -> list[Triple]:
        return self.add(self._ontology, v.OWL_IMPORTS, self.term(axiom.first))

    def _ontology_annotation(self, axiom: m.OntologyAnnotation) -> list[Triple]:
        self._annotate(self._ontology, [axiom.first])
        return []

    def _annotation_assertion(self, axiom: m.AnnotationAssertion) -> list[Triple]:
        added = self.add(self.term(axiom.subject), self.term(axiom.ann.ap), self.term(axiom.ann.av))
        self._annotate(added[0], axiom.ann.ann, _AXIOM)
        return added

    def _sub_object_property(self, axiom: m.SubObjectPropertyOf) -> list[Triple]:
        wider = self.term(axiom.sup)
        if isinstance(axiom.sub, list):
            return self.add(wider, owl("propertyChainAxiom"), self.list_of(map(self.term, axiom.sub)))
        return self.add(self.term(axiom.sub), v.RDFS_SUB_PROPERTY_OF, wider)

    def _disjoint_union(self, axiom: m.DisjointUnion) -> list[Triple]:
        whole = self.term(axiom.first)
        return self.add(whole, owl("disjointUnionOf"), self.list_of(map(self.term, axiom.second)))

    def _key(self, axiom: m.HasKey) -> list[Triple]:
        return self.add(self.term(axiom.ce), owl("hasKey"), self.list_of(map(self.term, axiom.vpe)))

    def _property_assertion(self, axiom: m.ObjectPropertyAssertion | m.DataPropertyAssertion) -> list[Triple]:
        p: Any = axiom.ope if isinstance(axiom, m.ObjectPropertyAssertion) else axiom.dp
        s, o = self.term(axiom.source), self.term(axiom.target)
        if isinstance(p, m.InverseObjectProperty):
            return self.add(o, self.term(p.first), s)
        return self.add(s, self.term(p), o)

    def _negative(
        self, axiom: m.NegativeObjectPropertyAssertion | m.NegativeDataPropertyAssertion
    ) -> list[Term]:
        of_objects = isinstance(axiom, m.NegativeObjectPropertyAssertion)
        p: Any = axiom.ope if isinstance(axiom, m.NegativeObjectPropertyAssertion) else axiom.dp
        node = self.new_blank_node(owl("NegativePropertyAssertion"))
        self.add(node, owl("sourceIndividual"), self.term(axiom.source))
        self.add(node, owl("assertionProperty"), self.term(p))
        self.add(node, owl("targetIndividual" if of_objects else "targetValue"), self.term(axiom.target))
        return [node]

    def _rule(self, axiom: m.Rule) -> list[Term]:
        node = self.new_blank_node(swrl("Imp"))
        for name, atoms in (("body", axiom.body), ("head", axiom.head)):
            self.add(node, swrl(name), self.list_of(map(self._atom, atoms), swrl("AtomList")))
        return [node]

    def _atom(self, atom: Any) -> Term:
        kind, predicate = _ATOMS[type(atom)]
        node = self.new_blank_node(swrl(kind))
        if isinstance(atom, (m.SameIndividualAtom, m.DifferentIndividualsAtom)):
            arguments = [atom.first, atom.second]
        else:
            self.add(node, predicate, self.term(atom.pred))
            arguments = atom.args if hasattr(atom, "args") else [atom.arg]
        terms = list(map(self.term, arguments))
        if isinstance(atom, m.BuiltInAtom):
            self.add(node, swrl("arguments"), self.list_of(terms))
        else:
            for number, term in enumerate(terms, start=1):
                self.add(node, swrl(f"argument{number}"), term)
        return node


_OTHERS: dict[type, Callable[[_Part, Any], Sequence[Triple | Term]]] = {
    m.OntologyID: _Part._identity,
    m.Import: _Part._import,
    m.OntologyAnnotation: _Part._ontology_annotation,
    m.AnnotationAssertion: _Part._annotation_assertion,
    m.SubObjectPropertyOf: _Part._sub_object_property,
    m.DisjointUnion: _Part._disjoint_union,
    m.HasKey: _Part._key,
    m.ObjectPropertyAssertion: _Part._property_assertion,
    m.DataPropertyAssertion: _Part._property_assertion,
    m.NegativeObjectPropertyAssertion: _Part._negative,
    m.NegativeDataPropertyAssertion: _Part._negative,
    m.Rule: _Part._rule,
}
