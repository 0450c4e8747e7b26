"""Which triples belong to the schema, and which are beyond the compiled engine."""

from __future__ import annotations

from functools import lru_cache

from nodes.kb_node.reasoner import datatypes
from nodes.kb_node.reasoner.rules.rule_table import ANNOTATIONS
from nodes.kb_node.reasoner.tbox.axioms import NotCompilable
from nodes.kb_node.reasoner.terms import (
    DIFFERENT_FROM,
    NIL,
    NOTHING,
    SAME_AS,
    THING,
    TYPE,
    iri,
    is_literal,
    is_reserved,
)  # fmt: skip
from schemas.explanations import Term, Triple

_PLAIN_PREDICATES = frozenset({SAME_AS, DIFFERENT_FROM, iri("owl:imports"), *ANNOTATIONS})
_PLAIN_CLASSES = frozenset({THING, NOTHING, iri("owl:NamedIndividual"), iri("owl:Ontology")})


def is_schema(triple: Triple) -> bool:
    """Whether a triple belongs to the schema: it says something of classes, properties, lists or axioms."""
    _, p, o = triple
    return _is_schema_class(o) if p == TYPE else _is_schema_predicate(p)


@lru_cache
def _is_schema_class(term: Term) -> bool:
    return is_reserved(term) and term not in _PLAIN_CLASSES and not datatypes.is_datatype(term)


@lru_cache
def _is_schema_predicate(term: Term) -> bool:
    return is_reserved(term) and term not in _PLAIN_PREDICATES


def check_compilable(triple: Triple) -> None:
    """Raise NotCompilable for a triple about the vocabulary itself, or that equates what is no individual."""
    s, p, o = triple
    spoken_of = (s,) if p == TYPE else (s, o)
    if any(is_reserved(term) and not _may_be_spoken_of(term) for term in spoken_of) or is_literal(s):
        raise NotCompilable(f"an axiom about the vocabulary: {triple}")
    if p in (SAME_AS, DIFFERENT_FROM) and is_literal(o):
        raise NotCompilable(f"an individual compared to a value: {triple}")


def _may_be_spoken_of(term: Term) -> bool:
    return term in ANNOTATIONS or term in (THING, NOTHING, NIL) or datatypes.is_datatype(term)
