"""Classification of triples: schema or data, inert axioms, and triples beyond the compiled engine.

A change of the schema is expensive. So only triples that the rules read as axioms count as schema. All other
triples with the reserved vocabulary (annotated axioms, headers, reification) are data.
"""

from __future__ import annotations

from collections.abc import Collection
from functools import lru_cache
from typing import Final

from semmap.nodes.kb_node.reasoner import datatypes
from semmap.nodes.kb_node.reasoner.data_ranges import FACETS
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.rules import swrl
from semmap.nodes.kb_node.reasoner.rules.rule_table import ANNOTATIONS
from semmap.nodes.kb_node.reasoner.tbox.axioms import PROPERTIES_WITH_MEANING, NotCompilable
from semmap.nodes.kb_node.reasoner.terms import (
    DIFFERENT_FROM,
    FIRST,
    NIL,
    NOTHING,
    PREFIXES,
    REST,
    SAME_AS,
    THING,
    TYPE,
    iri,
    iris,
    is_literal,
    is_reserved,
)  # fmt: skip

UNIVERSAL: Final = frozenset(iris("owl:topObjectProperty owl:topDataProperty"))
"""The properties that relate everything. To be a subproperty of them is trivial."""
_EXTREME = UNIVERSAL | frozenset(iris("owl:bottomObjectProperty owl:bottomDataProperty"))
_PLAIN_PREDICATES = _EXTREME | frozenset(
    {
        SAME_AS,
        DIFFERENT_FROM,
        *iris("owl:imports owl:versionIRI owl:annotatedSource owl:annotatedProperty owl:annotatedTarget"),
        *iris("rdf:subject rdf:predicate rdf:object rdf:value rdfs:member"),
        *ANNOTATIONS,
    }
)
_SCHEMA_PREDICATES = frozenset(
    (*iris("rdfs:subClassOf rdfs:subPropertyOf rdfs:domain rdfs:range rdf:first rdf:rest"), *FACETS)
)
"""Schema predicates outside the OWL namespace. Those in it are schema unless they are plain."""
_PLAIN_CLASSES = frozenset(
    {
        THING,
        NOTHING,
        *iris("owl:NamedIndividual owl:Ontology owl:Axiom owl:Annotation rdfs:Resource rdfs:Container"),
        *iris("rdf:Statement rdf:Bag rdf:Seq rdf:Alt"),
    }
)
METACLASSES: Final = frozenset(
    iris(
        "rdfs:Class rdf:Property rdfs:Datatype owl:Class owl:DataRange owl:DeprecatedClass owl:Restriction "
        "owl:ObjectProperty owl:DatatypeProperty owl:AnnotationProperty owl:OntologyProperty "
        "owl:DeprecatedProperty rdfs:ContainerMembershipProperty rdf:List"
    )
)
"""Classes of classes and properties from which no rule derives facts about individuals."""


def is_schema(triple: Triple) -> bool:
    """Return whether a triple belongs to the schema (classes, properties, lists, axioms)."""
    _, p, o = triple
    return _is_schema_class(o) if p == TYPE else _is_schema_predicate(p)


@lru_cache(maxsize=4096)
def _is_schema_class(term: Term) -> bool:
    if swrl.is_in_vocabulary(term):
        return True
    return is_reserved(term) and term not in _PLAIN_CLASSES and not is_datatype(term)


@lru_cache(maxsize=4096)
def _is_schema_predicate(term: Term) -> bool:
    if term in _SCHEMA_PREDICATES or swrl.is_in_vocabulary(term):
        return True
    return term.startswith(_OWL) and term not in _PLAIN_PREDICATES


def is_datatype(term: Term) -> bool:
    """Return whether a term names a datatype, supported or not (such as `xsd:duration`)."""
    return term.startswith(_XSD) or datatypes.is_datatype(term)


def is_inert(triple: Triple) -> bool:
    """Return whether an axiom is outside OWL 2 RL and has no consequences.

    It declares a subproperty of a universal property, uses classes of the vocabulary as classes of
    individuals (`:Concept rdfs:subClassOf rdfs:Class`), or describes terms of the vocabulary
    (`rdf:type rdfs:domain rdfs:Resource`). Or it is a part of a SWRL rule, which `swrl` reads.
    """
    s, p, o = triple
    if swrl.is_of_rule(triple):
        return True
    if p != TYPE and (o in UNIVERSAL or s in METACLASSES or o in METACLASSES):
        return True
    return describes_vocabulary(triple)


def describes_vocabulary(triple: Triple) -> bool:
    """Return whether a triple is a description of a term of the vocabulary, which is inert."""
    return triple[1] in _DESCRIPTIONS and changes_vocabulary(triple)


def check_all_compilable(schema: Collection[Triple]) -> None:
    """Raise NotCompilable for a schema that redefines the vocabulary.

    Members of a list that no axiom refers to, such as `sh:ignoredProperties ( rdf:type )`, may be of the
    vocabulary.
    """
    rest = {s: o for s, p, o in schema if p == REST}
    used: set[Term] = set()
    for head in (o for _, p, o in schema if p not in (FIRST, REST) and o in rest):
        while head in rest and head not in used:
            used.add(head)
            head = rest[head]
    for triple in schema:
        if triple[1] != FIRST or triple[0] in used:
            check_compilable(triple)


def changes_vocabulary(triple: Triple) -> bool:
    """Return whether a triple is an axiom about a term of the vocabulary that has a meaning in the rules."""
    s, p, o = triple
    if p == TYPE:
        return o not in METACLASSES and _has_meaning(s)
    return _has_meaning(s) or (_has_meaning(o) and not (p == _SUB_PROPERTY and o in PROPERTIES_WITH_MEANING))


def check_compilable(triple: Triple) -> None:
    """Raise NotCompilable if a triple redefines the vocabulary or equates something with a value."""
    s, p, o = triple
    if is_literal(s):
        raise NotCompilable(f"a literal has properties: {_text(triple)}")
    if changes_vocabulary(triple):
        raise NotCompilable(f"the meaning of OWL's own vocabulary is changed: {_text(triple)}")
    if p in (SAME_AS, DIFFERENT_FROM) and is_literal(o):
        raise NotCompilable(f"an individual is compared with a value: {_text(triple)}")


def _text(triple: Triple) -> str:
    return " ".join(triple)


def _has_meaning(term: Term) -> bool:
    return is_reserved(term) and term not in _DESCRIBABLE and not is_datatype(term)


_DESCRIBABLE = (_PLAIN_CLASSES | _PLAIN_PREDICATES | {NIL}) - PROPERTIES_WITH_MEANING
"""The terms of the vocabulary that axioms may be about."""
_SUB_PROPERTY = iri("rdfs:subPropertyOf")
_DESCRIPTIONS = frozenset((TYPE, _SUB_PROPERTY, *iris("rdfs:subClassOf rdfs:domain rdfs:range")))
"""The predicates of axioms that are inert for terms of the vocabulary."""
_OWL, _XSD = f"<{PREFIXES['owl']}", f"<{PREFIXES['xsd']}"
