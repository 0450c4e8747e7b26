"""Converts OWL expressions, properties and literals to RDF terms and triples."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

import pyhornedowl.model as m

from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term, Triple

_SWRL = "http://www.w3.org/2003/11/swrl#"
_FLOAT = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?[fF]")
_PLAIN_LITERAL = f"{v.RDF}PlainLiteral"


def owl(name: str) -> Term:
    """Return a term of the OWL vocabulary."""
    return v.iri(v.OWL + name)


def swrl(name: str) -> Term:
    """Return a term of the SWRL vocabulary."""
    return v.iri(_SWRL + name)


DATATYPE = v.iri(f"{v.RDFS}Datatype")
_RESTRICTION = owl("Restriction")
_DISTINGUISHED = (f"<{v.OWL}Thing>", f"<{v.RDFS}Literal>")

_COMBINED: dict[type, tuple[Term, Term]] = {
    m.ObjectIntersectionOf: (v.OWL_CLASS, owl("intersectionOf")),
    m.ObjectUnionOf: (v.OWL_CLASS, owl("unionOf")),
    m.ObjectOneOf: (v.OWL_CLASS, owl("oneOf")),
    m.DataIntersectionOf: (DATATYPE, owl("intersectionOf")),
    m.DataUnionOf: (DATATYPE, owl("unionOf")),
    m.DataOneOf: (DATATYPE, owl("oneOf")),
}
_COMPLEMENTS: dict[type, tuple[Term, Term]] = {
    m.ObjectComplementOf: (v.OWL_CLASS, owl("complementOf")),
    m.DataComplementOf: (DATATYPE, owl("datatypeComplementOf")),
}
_VALUES: dict[type, tuple[str, Term, str]] = {
    m.ObjectSomeValuesFrom: ("ope", owl("someValuesFrom"), "bce"),
    m.ObjectAllValuesFrom: ("ope", owl("allValuesFrom"), "bce"),
    m.ObjectHasValue: ("ope", owl("hasValue"), "i"),
    m.DataSomeValuesFrom: ("dp", owl("someValuesFrom"), "dr"),
    m.DataAllValuesFrom: ("dp", owl("allValuesFrom"), "dr"),
    m.DataHasValue: ("dp", owl("hasValue"), "l"),
}
_CARDINALITIES: dict[type, tuple[str, str, Term, str]] = {
    m.ObjectMinCardinality: ("ope", "min", owl("onClass"), "bce"),
    m.ObjectMaxCardinality: ("ope", "max", owl("onClass"), "bce"),
    m.ObjectExactCardinality: ("ope", "", owl("onClass"), "bce"),
    m.DataMinCardinality: ("dp", "min", owl("onDataRange"), "dr"),
    m.DataMaxCardinality: ("dp", "max", owl("onDataRange"), "dr"),
    m.DataExactCardinality: ("dp", "", owl("onDataRange"), "dr"),
}


class Expressions:
    """Collects triples. Blank nodes are `_:0`, `_:1` and so on."""

    def __init__(self) -> None:
        self.triples: list[Triple] = []
        self._blanks = 0

    def add(self, s: Term, p: Term, o: Term) -> list[Triple]:
        """Add a triple and return it in a list."""
        self.triples.append((s, p, o))
        return [(s, p, o)]

    def term(self, x: Any) -> Term:
        """Return the term of an entity, a literal or an expression; add the triples of an expression."""
        kind = type(x)
        if kind in _COMBINED:
            meta, predicate = _COMBINED[kind]
            return self._describe(meta, (predicate, self.list_of(map(self.term, x.first))))
        if kind in _COMPLEMENTS:
            meta, predicate = _COMPLEMENTS[kind]
            return self._describe(meta, (predicate, self.term(x.first)))
        if kind in _VALUES:
            on, predicate, value = _VALUES[kind]
            return self._restriction(getattr(x, on), (predicate, self.term(getattr(x, value))))
        if kind in _CARDINALITIES:
            return self._cardinality(x, *_CARDINALITIES[kind])
        if isinstance(x, m.ObjectHasSelf):
            return self._restriction(x.first, (owl("hasSelf"), v.literal("true", v.XSD_BOOLEAN)))
        if isinstance(x, m.DatatypeRestriction):
            facets = self.list_of([self._describe(None, self._facet(f)) for f in x.second])
            base = self.term(x.first)
            return self._describe(DATATYPE, (owl("onDatatype"), base), (owl("withRestrictions"), facets))
        if isinstance(x, m.InverseObjectProperty):
            return self._describe(None, (owl("inverseOf"), self.term(x.first)))
        if isinstance(x, m.Variable):
            variable = self.term(x.first)
            self.add(variable, v.RDF_TYPE, swrl("Variable"))
            return variable
        return _atomic(x)

    def _restriction(self, on: Any, *values: tuple[Term, Term]) -> Term:
        return self._describe(_RESTRICTION, (owl("onProperty"), self.term(on)), *values)

    def _cardinality(self, x: Any, on: str, bound: str, of: Term, filler: str) -> Term:
        """Return a cardinality restriction.

        With `owl:Thing` it is unqualified, as in the RDF of other tools.
        """
        number = v.literal(str(x.n), v.iri(f"{v.XSD}nonNegativeInteger"))
        kind = self.term(getattr(x, filler))
        if kind in _DISTINGUISHED:
            name = f"{bound}Cardinality" if bound else "cardinality"
            return self._restriction(getattr(x, on), (owl(name), number))
        name = f"{bound}QualifiedCardinality" if bound else "qualifiedCardinality"
        return self._restriction(getattr(x, on), (owl(name), number), (of, kind))

    def _facet(self, restriction: m.FacetRestriction) -> tuple[Term, Term]:
        name = str(restriction.f).rpartition(".")[2]
        space = v.RDF if name == "LangRange" else v.XSD
        return v.iri(space + name[0].lower() + name[1:]), self.term(restriction.l)

    def _describe(self, kind: Term | None, *values: tuple[Term, Term]) -> Term:
        node = self.new_blank_node(kind)
        for predicate, value in values:
            self.add(node, predicate, value)
        return node

    def new_blank_node(self, kind: Term | None) -> Term:
        """Return a new blank node, with a class if one is given."""
        node = f"_:{self._blanks}"
        self._blanks += 1
        if kind is not None:
            self.add(node, v.RDF_TYPE, kind)
        return node

    def list_of(self, members: Iterable[Term], kind: Term | None = None) -> Term:
        """Add an RDF list."""
        rest = v.RDF_NIL
        for member in reversed(list(members)):
            rest = self._describe(kind, (v.RDF_FIRST, member), (v.RDF_REST, rest))
        return rest


def _atomic(x: Any) -> Term:
    """Return the term of an entity, an IRI, an anonymous individual or a literal."""
    if isinstance(x, m.AnonymousIndividual):
        label = x.first.removeprefix("_:").encode().hex()  # the label may be invalid in RDF
        return f"_:a{label}"
    if isinstance(x, m.SimpleLiteral):
        return v.literal(x.literal)
    if isinstance(x, m.LanguageLiteral):
        return v.literal(x.literal, lang=x.lang)
    if isinstance(x, m.DatatypeLiteral):
        return _typed(x.literal, str(x.datatype_iri))
    return v.iri(str(x if isinstance(x, m.IRI) else x.first))


def _typed(text: str, datatype: str) -> Term:
    if datatype == _PLAIN_LITERAL:
        text, _, language = text.rpartition("@")
        return v.literal(text, lang=language or None)
    if datatype == f"{v.XSD}float" and _FLOAT.fullmatch(text):
        text = text[:-1]  # in the Manchester syntax floats end so, but not in RDF
    return v.literal(text, v.iri(datatype))
