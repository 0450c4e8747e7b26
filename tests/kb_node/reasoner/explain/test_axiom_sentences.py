"""Each kind of axiom as a clause."""

from __future__ import annotations

import pytest

from semmap.nodes.kb_node.reasoner.explain.axiom_sentences import AxiomVerbalizer
from semmap.nodes.kb_node.reasoner.explain.words import Words
from semmap.nodes.kb_node.reasoner.rules import swrl
from semmap.nodes.kb_node.reasoner.terms import TYPE
from tests.kb_node.reasoner.graphs import triples
from tests.kb_node.reasoner.swrl import graph

WORDS = Words.of(
    triples("""
:on a owl:ObjectProperty ; rdfs:label "is on" . :holds a owl:ObjectProperty ; rdfs:label "holds" .
:color a owl:ObjectProperty ; rdfs:label "has color" . :open a owl:DatatypeProperty ; rdfs:label "is open" .
:dmass a owl:DatatypeProperty ; rdfs:label "mass" .
:Cup rdfs:label "cup" . :Egg rdfs:label "egg" . :Milk rdfs:label "milk" . :Color rdfs:label "color" .
""")
)

CLAUSES = [
    (":Cup rdfs:subClassOf :Egg", "every cup is an egg"),
    (":Milk rdfs:subClassOf :Cup", "everything that is milk is a cup"),
    (":Cup rdfs:subClassOf owl:Nothing", "nothing is a cup"),
    (":Cup rdfs:subClassOf owl:Thing", "every cup is something"),
    (":Cup rdfs:subClassOf [ owl:onProperty :on ; owl:someValuesFrom :Egg ]", "every cup is on an egg"),
    (
        ":Cup rdfs:subClassOf [ owl:onProperty :color ; owl:someValuesFrom :Color ]",
        "every cup has a color that is a color",
    ),
    (
        ":Cup rdfs:subClassOf [ owl:onProperty :on ; owl:someValuesFrom owl:Thing ]",
        "every cup is on something",
    ),
    (
        ":Cup rdfs:subClassOf [ owl:onProperty :color ; owl:someValuesFrom owl:Thing ]",
        "every cup has a color",
    ),
    (
        ":Cup rdfs:subClassOf [ owl:onProperty :on ; owl:allValuesFrom :Egg ]",
        "every cup is on only something that is an egg",
    ),
    (
        ":Cup rdfs:subClassOf [ owl:onProperty :color ; owl:allValuesFrom :Color ]",
        "every cup has only something that is a color as color",
    ),
    (":Cup rdfs:subClassOf [ owl:onProperty :on ; owl:hasSelf true ]", "every cup is on itself"),
    (":Cup rdfs:subClassOf [ owl:onProperty :color ; owl:hasSelf true ]", "every cup has itself as color"),
    (
        ":Cup rdfs:subClassOf [ owl:onProperty [ owl:inverseOf :on ] ; owl:someValuesFrom :Egg ]",
        "every cup has an inverse of “is on” that is an egg",
    ),
    (
        ":Cup rdfs:subClassOf [ owl:onProperty [ owl:inverseOf :holds ] ; owl:hasValue :hand1 ]",
        "every cup has inverse of “holds” hand1",
    ),
    (":Cup rdfs:subClassOf [ owl:onProperty :on ; owl:hasValue :table1 ]", "every cup is on table1"),
    (":Cup rdfs:subClassOf [ owl:onProperty :open ; owl:hasValue false ]", "every cup is not open"),
    (":Cup rdfs:subClassOf [ owl:onProperty :dmass ; owl:hasValue 3 ]", "every cup has mass 3"),
    (
        ':Cup rdfs:subClassOf [ owl:onProperty :on ; owl:maxCardinality "0"^^xsd:nonNegativeInteger ]',
        "every cup is on nothing",
    ),
    (
        ':Cup rdfs:subClassOf [ owl:onProperty :on ; owl:maxCardinality "1"^^xsd:nonNegativeInteger ]',
        "every cup is on at most one thing",
    ),
    (
        ':Cup rdfs:subClassOf [ owl:onProperty :color ; owl:maxCardinality "2"^^xsd:nonNegativeInteger ]',
        "every cup has at most 2 color",
    ),
    (
        ':Cup rdfs:subClassOf [ owl:onProperty :on ; owl:minCardinality "1"^^xsd:nonNegativeInteger ]',
        "every cup is on at least one thing",
    ),
    (
        ':Cup rdfs:subClassOf [ owl:onProperty :color ; owl:minCardinality "3"^^xsd:nonNegativeInteger ]',
        "every cup has at least 3 color",
    ),
    (
        ':Cup rdfs:subClassOf [ owl:onProperty :on ; owl:cardinality "1"^^xsd:nonNegativeInteger ]',
        "every cup is on at most one thing",
    ),
    (
        (
            ":Cup rdfs:subClassOf [ owl:onProperty :on ; owl:maxQualifiedCardinality "
            '"1"^^xsd:nonNegativeInteger ; owl:onClass :Egg ]'
        ),
        "every cup is on at most one egg",
    ),
    (
        (
            ":Cup rdfs:subClassOf [ owl:onProperty :color ; owl:minQualifiedCardinality "
            '"2"^^xsd:nonNegativeInteger ; owl:onClass :Egg ]'
        ),
        "every cup has at least 2 color that is an egg",
    ),
    (
        (
            ":Cup rdfs:subClassOf [ owl:onProperty :holds ; owl:maxQualifiedCardinality "
            '"0"^^xsd:nonNegativeInteger ; owl:onClass [ owl:complementOf :Egg ] ]'
        ),
        "every cup holds no thing that is not an egg",
    ),
    (
        (
            ":Cup rdfs:subClassOf [ owl:onProperty :dmass ; owl:qualifiedCardinality "
            '"1"^^xsd:nonNegativeInteger ; owl:onDataRange xsd:float ]'
        ),
        "every cup has at most one mass that is a float",
    ),
    (":Cup rdfs:subClassOf [ owl:unionOf ( :Egg :Milk ) ]", "every cup is an egg or milk"),
    (
        ":Cup rdfs:subClassOf [ owl:unionOf ( :Egg [ owl:onProperty :on ; owl:hasValue :table1 ] ) ]",
        "every cup is an egg or is on table1",
    ),
    (
        ":Cup rdfs:subClassOf [ owl:intersectionOf ( :Egg :Milk :Color ) ]",
        "every cup is an egg, milk and a color",
    ),
    (
        (
            ":Cup rdfs:subClassOf [ owl:intersectionOf ( :Egg [ owl:onProperty :on ; owl:hasValue "
            ":table1 ] ) ]"
        ),
        "every cup is an egg and is on table1",
    ),
    (":Cup rdfs:subClassOf [ owl:oneOf ( :cup1 :cup2 ) ]", "every cup is one of cup1 and cup2"),
    (":Cup rdfs:subClassOf [ owl:complementOf :Egg ]", "every cup is not an egg"),
    (
        ":Cup rdfs:subClassOf [ owl:complementOf [ owl:complementOf :Egg ] ]",
        "every cup is not something that is not an egg",
    ),
    (":Cup rdfs:subClassOf [ a owl:Class ]", "every cup belongs to an anonymous class"),
    ("[ owl:unionOf ( :Egg :Milk ) ] rdfs:subClassOf :Cup", "everything that is an egg or milk is a cup"),
    (":Cup owl:equivalentClass :Egg", "every cup is an egg, and vice versa"),
    (
        ":Cup owl:equivalentClass [ owl:onProperty :on ; owl:hasValue :table1 ]",
        "a cup is by definition something that is on table1",
    ),
    (
        "[ owl:onProperty :on ; owl:hasValue :table1 ] owl:equivalentClass :Cup",
        "a cup is by definition something that is on table1",
    ),
    (":Cup owl:disjointWith :Egg", "nothing is both a cup and an egg"),
    (":Cup owl:complementOf :Egg", "a cup is by definition something that is not an egg"),
    (":Cup owl:intersectionOf ( :Egg :Milk )", "a cup is by definition something that is an egg and milk"),
    (":Cup owl:unionOf ( :Egg :Milk )", "a cup is by definition something that is an egg or milk"),
    (
        ":Cup owl:disjointUnionOf ( :Egg :Milk )",
        "a cup is by definition something that is either an egg or milk",
    ),
    (":Cup owl:oneOf ( :cup1 :cup2 )", "a cup is one of cup1 and cup2"),
    (
        ":Cup owl:hasKey ( :color :on :holds )",
        (
            "no two things that are each a cup have the same color, are on the same thing and hold "
            "the same thing"
        ),
    ),
    (
        "[ owl:onProperty :on ; owl:hasValue :table1 ] owl:hasKey ( :color )",
        "no two things that are each something that is on table1 have the same color",
    ),
    (":on rdfs:subPropertyOf :holds", "everything that is on something holds it"),
    (":color rdfs:subPropertyOf :on", "everything that has something as color is on it"),
    (":on owl:equivalentProperty :holds", "everything that is on something holds it, and vice versa"),
    (":on owl:propertyDisjointWith :holds", "nothing that is on something holds it"),
    (":on owl:inverseOf :holds", "if one thing is on another, the other holds it"),
    (
        ":on owl:propertyChainAxiom ( :holds :color )",
        "everything that holds something that has something as color is on the latter",
    ),
    (":on rdfs:domain :Cup", "everything that is on something is a cup"),
    (":color rdfs:domain :Cup", "everything that has a color is a cup"),
    (":open rdfs:domain :Cup", "everything that has a value for “is open” is a cup"),
    (":on rdfs:range :Cup", "everything that something is on is a cup"),
    (":color rdfs:range :Color", "everything that something has as color is a color"),
    (":color rdfs:range :Cup", "every color is a cup"),
    (":holds rdfs:range :Cup", "everything that something holds is a cup"),
    (
        (
            ":dmass rdfs:range [ a rdfs:Datatype ; owl:onDatatype xsd:integer ; owl:withRestrictions ("
            " [ xsd:minInclusive 0 ] [ xsd:maxInclusive 100 ] ) ]"
        ),
        "every mass is an integer from 0 to 100",
    ),
    (":on a owl:FunctionalProperty", "nothing is on more than one thing"),
    (":color a owl:FunctionalProperty", "nothing has more than one color"),
    (":open a owl:FunctionalProperty", "“is open” has at most one value"),
    (":on a owl:InverseFunctionalProperty", "no two things are on the same thing"),
    (":color a owl:InverseFunctionalProperty", "no two things have the same color"),
    (":on a owl:IrreflexiveProperty", "nothing is on itself"),
    (":color a owl:ReflexiveProperty", "everything has itself as color"),
    (":on a owl:SymmetricProperty", "if one thing is on another, the other is on it"),
    (
        ":color a owl:AsymmetricProperty",
        "if one thing has another as color, the other does not have it as color",
    ),
    (":holds a owl:AsymmetricProperty", "if one thing holds another, the other does not hold it"),
    (":on a owl:TransitiveProperty", "everything that is on something that is on something is on the latter"),
    ("[] a owl:AllDifferent ; owl:distinctMembers ( :a :b )", "a and b are different"),
    ("[] a owl:AllDifferent ; owl:members ( :a :b :c )", "a, b and c are all different"),
    ("[] a owl:AllDisjointClasses ; owl:members ( :Cup :Egg )", "nothing is both a cup and an egg"),
    (
        "[] a owl:AllDisjointClasses ; owl:members ( :Cup :Egg :Milk )",
        "nothing is more than one of a cup, an egg and milk",
    ),
    ("[] a owl:AllDisjointProperties ; owl:members ( :on :holds )", "nothing that is on something holds it"),
    (
        "[] a owl:AllDisjointProperties ; owl:members ( :on :holds :color )",
        (
            "one thing never relates to another in more than one of these ways: is on another, holds "
            "another or has another as color"
        ),
    ),
    (":Cup a owl:Class", "a cup is a class"),
]


@pytest.mark.parametrize(("axiom", "clause"), CLAUSES)
def test_an_axiom_has_a_clause(axiom, clause):
    given = triples(f"{axiom} .")
    verbalizer = AxiomVerbalizer(given, WORDS)
    assert clause in {verbalizer.axiom_clause(triple) for triple in given if verbalizer.is_axiom(triple)}


@pytest.mark.parametrize("fact", [":cup1 a :Cup", ":cup1 :on :table1", ":cup1 owl:sameAs :cup2"])
def test_a_fact_is_not_an_axiom(fact):
    (given,) = triples(f"{fact} .")
    verbalizer = AxiomVerbalizer([given], WORDS)
    assert not verbalizer.is_axiom(given)
    assert verbalizer.axiom_clause(given) is None


@pytest.mark.parametrize(
    ("mentioned", "clause"),
    [
        (":x a :Egg , :Milk .", "nothing is both an egg and milk"),
        (":x a :Egg .", "nothing is more than one of a cup, an egg and milk"),
    ],
)
def test_of_a_long_list_only_the_classes_of_the_proof_are_named(mentioned, clause):
    given = triples(f"[] a owl:AllDisjointClasses ; owl:members ( :Cup :Egg :Milk ) . {mentioned}")
    verbalizer = AxiomVerbalizer(given, WORDS)
    assert clause in {verbalizer.axiom_clause(triple) for triple in given}


def test_a_list_that_returns_to_itself_ends():
    given = triples(":Cup owl:oneOf _:a . _:a rdf:first :a ; rdf:rest _:a .")
    (axiom,) = (triple for triple in given if "oneOf" in triple[1])
    assert AxiomVerbalizer(given, WORDS).axiom_clause(axiom) == "a cup is one of a, a, a and a"


RULES = {
    "Cup(x), on(x, y) -> Table(y)": "if x is a cup and x is on y, then y is a Table",
    "on(x, table1) -> Cup(x), Egg(x)": "if x is on table1, then x is a cup and x is an egg",
    "on(x, y), sameAs(x, y) -> ": "it is never true that x is on y and x is the same as y",
    "Cup(x), Cup(y), differentFrom(x, y) -> on(x, y)": (
        "if x is a cup, y is a cup and x is different from y, then x is on y"
    ),
    "dmass(x, v), b.greaterThan(v, 3) -> Cup(x)": "if x has mass v and v > 3, then x is a cup",
    "dmass(x, v), b.add(w, v, 3), b.lessThan(w, 9) -> Cup(x)": (
        "if x has mass v, w = v + 3 and w < 9, then x is a cup"
    ),
}


@pytest.mark.parametrize(("text", "sentence"), RULES.items(), ids=RULES)
def test_a_rule_is_a_sentence(text, sentence):
    given = graph(text)
    (node,) = (s for s, _, o in given if o.endswith("#Imp>"))
    clause = AxiomVerbalizer(given, WORDS).axiom_clause((node, TYPE, swrl.RULE))
    assert clause == f"because of the rule “{sentence}”"
