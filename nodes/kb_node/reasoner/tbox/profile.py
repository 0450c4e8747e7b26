"""Axioms beyond the OWL 2 RL profile (OWL 2 Profiles, section 4.2).

Such axioms are allowed, but the rules use them only partially or not at all. They are counted by kind, so
that the user can be warned.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator

from semmap.nodes.kb_node.reasoner import datatypes
from semmap.nodes.kb_node.reasoner.data_ranges import read_range
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.rules.facts import Facts
from semmap.nodes.kb_node.reasoner.rules.rule_table import NUMBERS
from semmap.nodes.kb_node.reasoner.tbox.split import METACLASSES, UNIVERSAL, describes_vocabulary, is_datatype
from semmap.nodes.kb_node.reasoner.terms import TYPE, iri, iris

_SUBCLASS, _SUPERCLASS, _BOTH = "as a subclass", "as a superclass", "in an equivalence"
_CARDINALITIES = iris(
    "owl:maxCardinality owl:maxQualifiedCardinality owl:cardinality owl:qualifiedCardinality"
)
_MINIMA = iris("owl:minCardinality owl:minQualifiedCardinality")
_PREDICATES = {
    iri("owl:disjointUnionOf"): "disjoint union",
    iri("owl:hasSelf"): "self restriction",
    iri("owl:onProperties"): "restriction of several properties",
}
_CLASSES = {iri("owl:ReflexiveProperty"): "reflexive property"}


def outside_rl(schema: Iterable[Triple]) -> Counter[str]:
    """Return the number of axioms that the rules do not use fully, by kind."""
    facts = Facts(dict.fromkeys(schema))
    found: Counter[str] = Counter()
    for s, p, o in facts.facts:
        found.update(_axiom(facts, s, p, o))
    return found


def _axiom(facts: Facts, s: Term, p: Term, o: Term) -> Iterator[str]:
    if p == TYPE and o in _CLASSES:
        yield _CLASSES[o]
    elif p in _PREDICATES:
        yield _PREDICATES[p]
    elif p != TYPE and (s in METACLASSES or o in METACLASSES):
        yield "class of the vocabulary as a class"
    elif describes_vocabulary((s, p, o)):
        yield "axiom about a term of the vocabulary"
    elif o in UNIVERSAL and p == iri("rdfs:subPropertyOf"):
        yield "universal property as a superproperty"
    elif p == iri("rdfs:subClassOf"):
        yield from _below(facts, s, _SUBCLASS)
        yield from _above(facts, o, _SUPERCLASS)
    elif p == iri("owl:equivalentClass"):
        for side in (s, o):
            yield from dict.fromkeys((*_below(facts, side, _BOTH), *_above(facts, side, _BOTH)))
    elif p in iris("owl:disjointWith owl:complementOf"):
        if s[0] == "<" or p != iri("owl:complementOf"):
            yield from _below(facts, s, _SUBCLASS)
            yield from _below(facts, o, _SUBCLASS)
    elif p in iris("rdfs:domain rdfs:range"):
        if is_datatype(o) and not datatypes.is_datatype(o):
            yield f"datatype {o.rpartition('#')[2].rstrip('>')}"
        else:
            yield from _above(facts, o, _SUPERCLASS)
    elif p == iri("owl:hasKey"):
        if not _members(facts, o):
            yield "key without properties"
        yield from _below(facts, s, _SUBCLASS)
    elif p == iri("owl:propertyChainAxiom"):
        if len(_members(facts, o)) < 2:
            yield "property chain of less than two properties"
    elif s[0] == "<" and p in iris("owl:intersectionOf owl:unionOf owl:oneOf"):
        yield from _above(facts, s, _BOTH) if p != iri("owl:intersectionOf") else ()


def _below(facts: Facts, cls: Term, where: str) -> Iterator[str]:
    """Yield what an expression has beyond the allowed subclasses (`subClassExpression`)."""
    if cls[0] == "<" or read_range(cls, facts.match) is not None:
        return
    for _, p, o in facts.match(cls):
        if p in iris("owl:intersectionOf owl:unionOf"):
            for member in _members(facts, o):
                yield from _below(facts, member, where)
        elif p == iri("owl:someValuesFrom"):
            yield from _below(facts, o, where)
        elif (kind := _kind(p)) is not None and p not in iris("owl:oneOf owl:hasValue"):
            yield f"{kind} {where}"


def _above(facts: Facts, cls: Term, where: str) -> Iterator[str]:
    """Yield what an expression has beyond the allowed superclasses (`superClassExpression`)."""
    if read_range(cls, facts.match) is not None:
        return
    for _, p, o in facts.match(cls):
        if p == iri("owl:intersectionOf"):
            for member in _members(facts, o) if cls[0] != "<" else ():
                yield from _above(facts, member, where)
        elif cls[0] == "<":
            if where == _BOTH and p in iris("owl:unionOf owl:oneOf"):
                yield f"{_kind(p)} {where}"
        elif p == iri("owl:allValuesFrom"):
            yield from _above(facts, o, where)
        elif p == iri("owl:complementOf"):
            yield from _below(facts, o, where)
        elif p in _CARDINALITIES and datatypes.canonical(o) in map(datatypes.canonical, NUMBERS):
            for name in iris("owl:onClass owl:onDataRange"):
                for _, _, filler in facts.match(cls, name):
                    yield from _below(facts, filler, where)
            if p in _CARDINALITIES[2:] and datatypes.canonical(o) == datatypes.canonical(NUMBERS[1]):
                yield f"{_KINDS[iri('owl:minCardinality')]} {where}"  # minimum is ignored
        elif (kind := _kind(p)) is not None and p != iri("owl:hasValue"):
            yield f"{kind} {where}"


def _kind(p: Term) -> str | None:
    return _KINDS.get(p)


def _members(facts: Facts, head: Term) -> list[Term]:
    found = facts.members(head)
    return found[0] if found else []


_KINDS = {
    iri("owl:unionOf"): "union",
    iri("owl:oneOf"): "enumeration",
    iri("owl:complementOf"): "complement",
    iri("owl:someValuesFrom"): "existential restriction",
    iri("owl:allValuesFrom"): "universal restriction",
    iri("owl:hasValue"): "value restriction",
    **dict.fromkeys(_CARDINALITIES, "cardinality restriction"),
    **dict.fromkeys(_MINIMA, "minimum cardinality"),
}
