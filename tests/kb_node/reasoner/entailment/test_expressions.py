"""Class expressions: their complements, their triples, and what follows from membership."""

import pytest

from semmap.nodes.kb_node.reasoner.entailment.assumptions import WIDEST, membership_alternatives
from semmap.nodes.kb_node.reasoner.entailment.expressions import (
    ANYTHING,
    And,
    AtLeast,
    AtMost,
    Has,
    Named,
    Not,
    OneOf,
    Only,
    Or,
    Reader,
    Role,
    Self,
    Unreadable,
    Writer,
    negated,
)
from semmap.nodes.kb_node.reasoner.rules.facts import Facts
from semmap.nodes.kb_node.reasoner.terms import DIFFERENT_FROM, SAME_AS, TYPE, iri

X, U, V, P = "<urn:x>", "<urn:u>", "<urn:v>", Role("<urn:p>")
A, B = Named("<urn:A>"), Named("<urn:B>")
BACK = Role("<urn:p>", backwards=True)


@pytest.mark.parametrize(
    ("expression", "complement"),
    [
        (A, Not(A)),
        (And((A, Not(B))), Or((Not(A), B))),
        (Or((A, B)), And((Not(A), Not(B)))),
        (OneOf((U,)), Not(OneOf((U,)))),
        (OneOf((U, V)), And((Not(OneOf((U,))), Not(OneOf((V,)))))),
        (Only(P, A), AtLeast(1, P, Not(A))),
        (AtLeast(2, P, A), AtMost(1, P, A)),
        (AtLeast(0, P, A), Not(ANYTHING)),
        (AtMost(0, P, A), AtLeast(1, P, A)),
        (Has(P, U), Not(Has(P, U))),
    ],
)
def test_the_complement_of_an_expression(expression, complement):
    assert negated(expression) == complement


@pytest.mark.parametrize(
    "expression",
    [
        Not(A),
        And((A, Not(B))),
        Or((A, And((A, B)))),
        OneOf((U, V)),
        Only(P, Not(A)),
        Has(BACK, U),
        AtLeast(1, P, A),
        AtLeast(2, BACK, Or((A, B))),
        AtMost(3, P, A),
    ],
)
def test_an_expression_is_read_as_it_was_written(expression):
    triples = []
    node = Writer().write(expression, triples)
    assert Reader(Facts(dict.fromkeys(triples)).match).expression(node) == expression
    assert Writer().write(A, []) == A.term
    with pytest.raises(Unreadable):
        Writer().write(Self(P), [])


NODE = "_:supposed.0"
WIDE = tuple(f"<urn:{number}>" for number in range(WIDEST + 1))


@pytest.mark.parametrize(
    ("expression", "alternatives"),
    [
        (A, [[(X, TYPE, A.term)]]),
        (ANYTHING, [[]]),
        (Not(ANYTHING), []),
        (And((A, B)), [[(X, TYPE, A.term), (X, TYPE, B.term)]]),
        (And((A, Or((A, B)))), [[(X, TYPE, A.term)] * 2, [(X, TYPE, A.term), (X, TYPE, B.term)]]),
        (OneOf((U, V)), [[(X, SAME_AS, U)], [(X, SAME_AS, V)]]),
        (OneOf(WIDE[1:]), [[(X, SAME_AS, term)] for term in WIDE[1:]]),
        (OneOf(WIDE), [[]]),
        (Or(tuple(map(Named, WIDE))), [[]]),
        (Has(P, U), [[(X, P.property, U)]]),
        (Has(BACK, U), [[(U, P.property, X)]]),
        (Self(P), [[(X, P.property, X)]]),
        (Not(OneOf((U,))), [[(X, DIFFERENT_FROM, U)]]),
        (AtLeast(1, P, ANYTHING), [[(X, P.property, NODE)]]),
        (
            AtLeast(1, BACK, Or((A, B))),
            [[(NODE, P.property, X), (NODE, TYPE, one.term)] for one in (A, B)],
        ),
        (
            AtLeast(2, P, ANYTHING),
            [
                [
                    (X, P.property, NODE),
                    (X, P.property, "_:supposed.1"),
                    (NODE, DIFFERENT_FROM, "_:supposed.1"),
                ]
            ],
        ),
        (AtLeast(1, P, OneOf(WIDE)), [[(X, P.property, NODE)]]),
        (
            Not(Has(P, '"1"')),
            [
                [
                    (NODE, TYPE, iri("owl:NegativePropertyAssertion")),
                    (NODE, iri("owl:sourceIndividual"), X),
                    (NODE, iri("owl:assertionProperty"), P.property),
                    (NODE, iri("owl:targetValue"), '"1"'),
                ]
            ],
        ),
        (Not(A), [[(NODE, iri("owl:complementOf"), A.term), (X, TYPE, NODE)]]),
    ],
)
def test_what_follows_from_membership(expression, alternatives):
    assert membership_alternatives(X, expression, Writer()) == alternatives
