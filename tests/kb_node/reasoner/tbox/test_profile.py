"""Which parts of an axiom are counted as outside the profile, at each place where an expression may be."""

from collections import Counter

import pytest

from semmap.nodes.kb_node.reasoner.tbox.profile import outside_rl
from tests.kb_node.reasoner.graphs import triples

SOME = "[ owl:onProperty :p ; owl:someValuesFrom :B ]"
ONLY = "[ owl:onProperty :p ; owl:allValuesFrom :B ]"
ONE, NONE = ('"1"^^xsd:nonNegativeInteger', '"0"^^xsd:nonNegativeInteger')
CASES = {
    f":A owl:disjointWith {ONLY}": ["universal restriction as a subclass"],
    f"{ONLY} owl:disjointWith :A": ["universal restriction as a subclass"],
    f":A owl:complementOf {ONLY}": ["universal restriction as a subclass"],
    f":A rdfs:subClassOf [ owl:complementOf {ONLY} ]": ["universal restriction as a superclass"],
    f"{ONLY} owl:hasKey ( :p )": ["universal restriction as a subclass"],
    f":p rdfs:domain {SOME}": ["existential restriction as a superclass"],
    f":p rdfs:range {SOME}": ["existential restriction as a superclass"],
    f":p rdfs:domain {ONLY}": [],
    f":A rdfs:subClassOf [ owl:intersectionOf ( :C {SOME} ) ]": ["existential restriction as a superclass"],
    f":A rdfs:subClassOf [ owl:onProperty :q ; owl:allValuesFrom {SOME} ]": [
        "existential restriction as a superclass"
    ],
    f":A rdfs:subClassOf [ owl:onProperty :q ; owl:maxQualifiedCardinality {ONE} ; owl:onClass {ONLY} ]": [
        "universal restriction as a superclass"
    ],
    f":A rdfs:subClassOf [ owl:onProperty :q ; owl:maxQualifiedCardinality {ONE} ; owl:onClass {SOME} ]": [],
    f":A rdfs:subClassOf [ owl:onProperty :q ; owl:cardinality {ONE} ]": [
        "minimum cardinality as a superclass"
    ],
    f":A rdfs:subClassOf [ owl:onProperty :q ; owl:cardinality {NONE} ]": [],
    f"[ owl:onProperty :q ; owl:maxCardinality {ONE} ] rdfs:subClassOf :A": [
        "cardinality restriction as a subclass"
    ],
    f"[ owl:intersectionOf ( :C {ONLY} ) ] rdfs:subClassOf :A": ["universal restriction as a subclass"],
    f"[ owl:unionOf ( :C {ONLY} ) ] rdfs:subClassOf :A": ["universal restriction as a subclass"],
    f"[ owl:onProperty :q ; owl:someValuesFrom {ONLY} ] rdfs:subClassOf :A": [
        "universal restriction as a subclass"
    ],
    f"{SOME} rdfs:subClassOf {ONLY}": [],
    f"{ONLY} rdfs:subClassOf {SOME}": [
        "universal restriction as a subclass",
        "existential restriction as a superclass",
    ],
    f":A owl:equivalentClass {ONLY}": ["universal restriction in an equivalence"],
    f"{SOME} owl:equivalentClass :A": ["existential restriction in an equivalence"],
    ":A owl:oneOf ( :a )": ["enumeration in an equivalence"],
    f":A owl:intersectionOf ( :B {SOME} )": [],
    ":A rdfs:subClassOf [ owl:onProperty :p ; owl:hasSelf true ]": ["self restriction"],
    "rdf:type rdfs:domain rdfs:Resource": ["axiom about a term of the vocabulary"],
    ":d rdfs:range [ a rdfs:Datatype ; owl:oneOf ( 1 2 ) ]": [],
    ":d rdfs:range xsd:integer": [],
    ":p owl:propertyChainAxiom ( :q :r )": [],
    ":A owl:hasKey ( :p )": [],
}


@pytest.mark.parametrize(("axiom", "kinds"), CASES.items(), ids=CASES)
def test_what_is_outside_the_profile(axiom, kinds):
    assert outside_rl(triples(axiom + " .")) == Counter(kinds)
