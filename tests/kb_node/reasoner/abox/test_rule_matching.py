"""The conclusions of SWRL rules, also over equal individuals, do not depend on the order of facts."""

import pytest

from tests.kb_node.reasoner.graphs import triples
from tests.kb_node.reasoner.orders import check_in_any_order
from tests.kb_node.reasoner.swrl import graph

APART = "[] a owl:AllDifferent ; owl:members ( :i :j :k ) ."
CASES = {
    "an individual in the body": (["p(x, i) -> C(x)"], "", ":a :p :j . :j owl:sameAs :i . :i :p :i"),
    "an individual in the head": (["C(x) -> q(x, i)"], "", ":a a :C . :i owl:sameAs :b . :a owl:sameAs :c"),
    "a class of an individual in the body": (
        ["C(i), D(x) -> E(x)"],
        "",
        ":a a :D . :b a :C . :b owl:sameAs :i",
    ),
    "a fact without a condition": (["-> C(i)", "-> q(i, j)"], "", ":i owl:sameAs :a . :b :p :i"),
    "both ends the same": (["p(x, x) -> C(x)"], "", ":a :p :b . :a owl:sameAs :c . :c owl:sameAs :b"),
    "two classes": (["C(x), D(y) -> q(x, y)"], "", ":a a :C . :b a :D . :a a :D . :a owl:sameAs :c"),
    "a join from either end": (
        ["p(x, y), q(y, z) -> r(x, z)"],
        "",
        ":a :p :b . :c :q :d . :b owl:sameAs :c . :b :q :e",
    ),
    "a join of a property below and an inverse": (
        ["p(x, y), q(z, y) -> r(x, z)"],
        ":e rdfs:subPropertyOf :p . :o owl:inverseOf :q .",
        ":a :e :b . :b :o :c . :d :q :b",
    ),
    "two ways to one conclusion": (
        ["p(x, y) -> C(x)", "D(x) -> C(x)"],
        "",
        ":a :p :b . :a a :D . :a :p :c . :a a :C",
    ),
    "a rule after a rule": (
        ["C(x) -> D(x)", "D(x), p(x, y) -> C(y)"],
        "",
        ":a a :C . :a :p :b . :b :p :a . :b a :D",
    ),
    "equal individuals in the body": (
        ["C(x), D(y), sameAs(x, y) -> E(x)"],
        "",
        ":a a :C . :b a :D . :a owl:sameAs :b . :c a :C",
    ),
    "asserted difference": (
        ["C(x), C(y), differentFrom(x, y) -> r(x, y)"],
        "",
        ":a a :C . :b a :C . :b owl:differentFrom :c . :a owl:sameAs :c",
    ),
    "difference of a list": (
        ["C(x), C(y), differentFrom(x, y) -> r(x, y)"],
        APART,
        ":i a :C . :j a :C . :a a :C . :a owl:sameAs :k",
    ),
    "difference by another name": (
        ["p(x, y), differentFrom(x, y) -> C(x)"],
        ":ne rdfs:subPropertyOf owl:differentFrom .",
        ":a :p :b . :a :ne :b . :b owl:differentFrom :a",
    ),
    "equality as a conclusion": (
        ["p(x, y), C(y) -> sameAs(x, y)"],
        "",
        ":a :p :b . :b a :C . :a :q :c . :b :p :d . :d a :C",
    ),
    "difference as a conclusion": (
        ["p(x, y) -> differentFrom(x, y)"],
        "",
        ":a :p :b . :c :p :a . :a owl:differentFrom :b",
    ),
    "a comparison": (
        ["d(x, v), b.greaterThan(v, 2) -> E(x)"],
        "",
        ":a :d 1 . :a :d 3 . :b :d 2 . :b owl:sameAs :a",
    ),
    "a calculation": (["d(x, v), b.add(w, v, 1) -> dd(x, w)"], "", ":a :d 1 . :a :dd 2 . :b :d 1 . :b :d 3"),
    "a calculated value in the body": (
        ["d(x, v), dd(x, w), b.add(w, v, 1) -> C(x)"],
        "",
        ':a :d 1 . :a :dd 2 . :b :d 1 . :b :dd 3 . :b :dd "2.0"^^xsd:decimal',
    ),
    "a value in the body": (
        ["d(x, 3) -> C(x)"],
        "",
        ':a :d 3 . :b :d "3.0"^^xsd:decimal . :c :d 4 . :a :d 03',
    ),
    "values that agree": (
        ["d(x, v), d(y, v) -> s(x, y)"],
        "",
        ':a :d 3 . :b :d "3.0"^^xsd:decimal . :c :d 4',
    ),
    "an edge and a value of a class": (
        ["p(x, y) -> C(y)"],
        ":D rdfs:subClassOf [ owl:onProperty :p ; owl:hasValue :v ] .",
        ":a a :D . :a :p :v . :v owl:sameAs :w",
    ),
    "a chain that a rule continues": (
        ["t(x, y), C(y) -> D(x)"],
        ":t a owl:TransitiveProperty .",
        ":a :t :b . :b :t :c . :c a :C . :a :t :c",
    ),
    "an edge of which a rule and a chain are reasons": (
        ["p(x, y) -> r(x, y)"],
        ":r owl:propertyChainAxiom ( :q :q ) .",
        ":a :p :c . :a :q :b . :b :q :c . :a :r :c",
    ),
}
REJECTED = {
    "a condition that must not hold": (
        ["C(x), p(x, y), D(y) -> "],
        "",
        ":a a :C . :a :p :b . :c a :D . :b owl:sameAs :c",
    ),
    "a conclusion that contradicts another": (
        ["p(x, y) -> differentFrom(x, y)"],
        "",
        ":a :p :b . :a owl:sameAs :c . :b owl:sameAs :c",
    ),
    "a class that excludes another": (
        ["p(x, y) -> A(x)"],
        ":A owl:disjointWith :B .",
        ":a :p :b . :c a :B . :a owl:sameAs :c",
    ),
}


@pytest.mark.parametrize(("rules", "axioms", "facts"), CASES.values(), ids=CASES)
def test_conclusions_equal_those_of_the_rules(rules, axioms, facts):
    assert check_in_any_order(graph(*rules, axioms=axioms), triples(f"{facts} .")) == 0


@pytest.mark.parametrize(("rules", "axioms", "facts"), REJECTED.values(), ids=REJECTED)
def test_the_fact_that_completes_a_contradiction_is_rejected(rules, axioms, facts):
    assert check_in_any_order(graph(*rules, axioms=axioms), triples(f"{facts} .")) == 2
