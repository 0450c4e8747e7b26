"""Which triples belong to the schema, which of these say nothing, and which are beyond the compiled engine.

A triple about individuals is compared with the schema at every change, so the sets below are what the rules
read, and no more: all else of the reserved vocabulary (annotations of axioms, headers, reification) is data.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Final

from semmap.nodes.kb_node.reasoner import datatypes
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.rules.rule_table import ANNOTATIONS
from semmap.nodes.kb_node.reasoner.tbox.axioms import NotCompilable
from semmap.nodes.kb_node.reasoner.terms import (
    DIFFERENT_FROM,
    NIL,
    NOTHING,
    PREFIXES,
    SAME_AS,
    THING,
    TYPE,
    iri,
    iris,
    is_literal,
    is_reserved,
)  # fmt: skip

UNIVERSAL: Final = frozenset(iris("owl:topObjectProperty owl:topDataProperty"))
"""The properties that relate everything: a subproperty of theirs says nothing."""
_EXTREME = UNIVERSAL | frozenset(iris("owl:bottomObjectProperty owl:bottomDataProperty"))
_PLAIN_PREDICATES = _EXTREME | frozenset(
    {
        SAME_AS,
        DIFFERENT_FROM,
        *iris("owl:imports owl:versionIRI owl:annotatedSource owl:annotatedProperty owl:annotatedTarget"),
        *ANNOTATIONS,
    }
)
_SCHEMA_PREDICATES = frozenset(
    iris("rdfs:subClassOf rdfs:subPropertyOf rdfs:domain rdfs:range rdf:first rdf:rest")
)
"""Those that are not OWL's own, all of which are but the plain ones."""
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
"""The classes of classes and properties of which no rule draws anything about individuals."""


def is_schema(triple: Triple) -> bool:
    """Whether a triple belongs to the schema: it says something of classes, properties, lists or axioms."""
    _, p, o = triple
    return _is_schema_class(o) if p == TYPE else _is_schema_predicate(p)


@lru_cache(maxsize=4096)
def _is_schema_class(term: Term) -> bool:
    return is_reserved(term) and term not in _PLAIN_CLASSES and not is_datatype(term)


@lru_cache(maxsize=4096)
def _is_schema_predicate(term: Term) -> bool:
    return term in _SCHEMA_PREDICATES or (term.startswith(_OWL) and term not in _PLAIN_PREDICATES)


def is_datatype(term: Term) -> bool:
    """Whether a term names a datatype, be its values known here or not (`xsd:duration`)."""
    return term.startswith(_XSD) or datatypes.is_datatype(term)


def is_inert(triple: Triple) -> bool:
    """Whether a triple of the schema is outside of OWL 2 RL and says nothing there.

    It makes something a subproperty of what relates everything, or speaks of the classes of the
    vocabulary as if they were classes of individuals (`:Concept rdfs:subClassOf rdfs:Class`).
    """
    s, p, o = triple
    if p == TYPE:
        return False
    return o in UNIVERSAL or s in METACLASSES or o in METACLASSES


def check_compilable(triple: Triple) -> None:
    """Raise NotCompilable for a triple about the vocabulary itself, or that equates what is no individual."""
    s, p, o = triple
    if is_literal(s):
        raise NotCompilable(f"a literal has properties: {_told(triple)}")
    spoken_of = () if p == TYPE and o in METACLASSES else (s,) if p == TYPE else (s, o)
    if any(is_reserved(term) and not _may_be_described(term) for term in spoken_of):
        raise NotCompilable(f"the meaning of OWL's own vocabulary is changed: {_told(triple)}")
    if p in (SAME_AS, DIFFERENT_FROM) and is_literal(o):
        raise NotCompilable(f"an individual is compared with a value: {_told(triple)}")


def _told(triple: Triple) -> str:
    return " ".join(triple)


def _may_be_described(term: Term) -> bool:
    return (
        term in ANNOTATIONS
        or term in (THING, NOTHING, NIL, _RESOURCE)
        or term in _EXTREME
        or is_datatype(term)
    )


_RESOURCE = iri("rdfs:Resource")
_OWL, _XSD = f"<{PREFIXES['owl']}", f"<{PREFIXES['xsd']}"
