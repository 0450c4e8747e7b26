"""Class membership as triples, with names for values that must exist."""

from __future__ import annotations

from itertools import combinations, islice, product

from semmap.nodes.kb_node.reasoner.entailment.expressions import (
    ANYTHING,
    And,
    AtLeast,
    Expression,
    Has,
    Named,
    Not,
    OneOf,
    Or,
    Role,
    Self,
    Unreadable,
    Writer,
)
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.terms import DIFFERENT_FROM, SAME_AS, THING, TYPE, iri, is_literal

WIDEST = 24
"""Maximum number of alternatives. With more, nothing is assumed, which is sound."""

Alternatives = list[list[Triple]]
"""Sets of triples of which one holds. An empty list is a contradiction."""


def membership_alternatives(x: Term, expression: Expression, writer: Writer) -> Alternatives:
    """Return the alternatives that x is a member of a class, with names for values that must exist."""
    match expression:
        case Named(term):
            return [[]] if term == THING else [[(x, TYPE, term)]]
        case And(parts):
            choices = islice(
                product(*(membership_alternatives(x, part, writer) for part in parts)), WIDEST + 1
            )
            whole = [[triple for part in choice for triple in part] for choice in choices]
            return whole if len(whole) <= WIDEST else [[]]
        case Or(parts):
            whole = [one for part in parts for one in membership_alternatives(x, part, writer)]
            return whole if len(whole) <= WIDEST else [[]]
        case OneOf(terms):
            return [[(x, SAME_AS, term)] for term in terms] if len(terms) <= WIDEST else [[]]
        case AtLeast(number, role, filler) if number <= WIDEST:
            return _value_alternatives(x, number, role, filler, writer)
        case Has(role, value):
            return [[role.edge(x, value)]]
        case Self(role):
            return [[role.edge(x, x)]]
        case Not(OneOf((term,))):
            return [[(x, DIFFERENT_FROM, term)]]
        case Not(Has(role, value)):
            return [_negative_assertion(role.edge(x, value), writer)]
        case Not(Self(role)):
            return [_negative_assertion(role.edge(x, x), writer)]
        case Not(Named(term)) if term == THING:
            return []
    triples: list[Triple] = []
    try:
        node = writer.write(expression, triples)
    except Unreadable:
        return [[]]
    return [[*triples, (x, TYPE, node)]]


def _value_alternatives(x: Term, number: int, role: Role, filler: Expression, writer: Writer) -> Alternatives:
    values = [writer.fresh() for _ in range(number)]
    triples = [role.edge(x, y) for y in values]
    triples += [(one, DIFFERENT_FROM, other) for one, other in combinations(values, 2)]
    if filler == ANYTHING:
        return [triples]
    choices = list(islice(product(*(membership_alternatives(y, filler, writer) for y in values)), WIDEST + 1))
    if len(choices) > WIDEST:
        return [triples]
    return [[*triples, *(triple for part in choice for triple in part)] for choice in choices]


def _negative_assertion(edge: Triple, writer: Writer) -> list[Triple]:
    s, p, o = edge
    node = writer.fresh()
    target = "owl:targetValue" if is_literal(o) else "owl:targetIndividual"
    return [
        (node, TYPE, iri("owl:NegativePropertyAssertion")),
        (node, iri("owl:sourceIndividual"), s),
        (node, iri("owl:assertionProperty"), p),
        (node, iri(target), o),
    ]
