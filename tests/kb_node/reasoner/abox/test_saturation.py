"""The conclusions of each kind of axiom, also over equal individuals, do not depend on the order of facts."""

import pytest

from tests.kb_node.reasoner.graphs import triples
from tests.kb_node.reasoner.orders import check_in_any_order

ONE, NONE = ('"1"^^xsd:nonNegativeInteger', '"0"^^xsd:nonNegativeInteger')
CONSISTENT = {
    "one value of equal owners": (
        ":f a owl:FunctionalProperty",
        ":a :f :x . :b :f :y . :a owl:sameAs :b . :y a :C",
    ),
    "one owner of equal values": (
        ":f a owl:InverseFunctionalProperty",
        ":x :f :a . :y :f :b . :a owl:sameAs :b . :y a :C",
    ),
    "one owner by the inverse": (
        ":f a owl:FunctionalProperty . :g owl:inverseOf :f",
        ":x :g :a . :y :g :a . :a :f :z",
    ),
    "one value by a property below": (
        ":e rdfs:subPropertyOf :f . :f a owl:FunctionalProperty",
        ":a :e :x . :a :f :y . :y :p :z",
    ),
    "three equal values, of which each pair has its own reason": (
        ":f a owl:FunctionalProperty",
        ":a :f :x . :a :f :y . :b :f :y . :b :f :z . :x a :C",
    ),
    "one value in a class for members of a class": (
        f":O rdfs:subClassOf [ owl:onProperty :p ; owl:maxQualifiedCardinality {ONE} ; owl:onClass :C ]",
        ":a a :O . :a :p :x . :a :p :y . :a :p :z . :x a :C . :y a :C",
    ),
    "one value of an owner that is equal to a member": (
        f":O rdfs:subClassOf [ owl:onProperty :p ; owl:maxCardinality {ONE} ]",
        ":b a :O . :a :p :x . :b :p :y . :a owl:sameAs :b",
    ),
    "a key with equal values in two spellings": (
        ":C owl:hasKey ( :k :d )",
        ':a a :C . :b a :C . :a :k :x . :b :k :y . :a :d 1 . :b :d "1.0"^^xsd:decimal . :x owl:sameAs :y',
    ),
    "a chain over equal individuals": (
        ":r owl:propertyChainAxiom ( :p :q )",
        ":a :p :x . :y :q :b . :x owl:sameAs :y . :b owl:sameAs :c",
    ),
    "a chain of three with an inverse": (
        ":r owl:propertyChainAxiom ( :p :q :p ) . :o owl:inverseOf :q",
        ":a :p :b . :c :o :b . :c :p :d . :b :q :e . :e :p :d",
    ),
    "two chains to one conclusion": (
        ":r owl:propertyChainAxiom ( :p :q ) , ( :q :p )",
        ":a :p :b . :b :q :c . :a :q :d . :d :p :c",
    ),
    "a symmetric and transitive property": (
        ":t a owl:TransitiveProperty , owl:SymmetricProperty",
        ":a :t :b . :c :t :b . :c :t :d . :d owl:sameAs :e",
    ),
    "a transitive property of which the pairs are needed": (
        ":t a owl:TransitiveProperty . :r owl:propertyChainAxiom ( :t :p )",
        ":a :t :b . :b :t :c . :c :p :d . :b :t :c2 . :c2 :t :c",
    ),
    "a value of a class, also of equal individuals": (
        ":C rdfs:subClassOf [ owl:onProperty :p ; owl:hasValue :v ] . :p rdfs:domain :D ; rdfs:range :E",
        ":a a :C . :a owl:sameAs :b . :v owl:sameAs :w . :b :p :w",
    ),
    "a class by a value, also an equal one": (
        ":S owl:equivalentClass [ owl:onProperty :p ; owl:hasValue :v ]",
        ":a :p :w . :w owl:sameAs :v . :b a :S",
    ),
    "a class by a value in another": (
        ":S owl:equivalentClass [ owl:onProperty :p ; owl:someValuesFrom :C ]",
        ":a :p :x . :y a :C . :x owl:sameAs :y . :b :p :x . :b owl:sameAs :c",
    ),
    "the class of all values": (
        ":O rdfs:subClassOf [ owl:onProperty :p ; owl:allValuesFrom :O ]",
        ":a a :O . :b :p :x . :a owl:sameAs :b . :x :p :y . :y :p :x",
    ),
    "an intersection of what equal individuals have": (
        ":I owl:intersectionOf ( :A :B [ owl:onProperty :p ; owl:someValuesFrom owl:Thing ] )",
        ":a a :A . :b a :B . :c :p :x . :a owl:sameAs :b . :b owl:sameAs :c",
    ),
    "an enumerated individual and an equal one": (
        ":One owl:equivalentClass [ owl:oneOf ( :i ) ] ; rdfs:subClassOf :C",
        ":j owl:sameAs :i . :j :p :x . :i a :D",
    ),
    "equality by another name": (
        ":eq rdfs:subPropertyOf owl:sameAs . :alias owl:inverseOf :eq",
        ":a :eq :b . :c :alias :b . :a :p :x . :c a :C",
    ),
    "difference by another name": (
        ":ne rdfs:subPropertyOf owl:differentFrom . :other rdfs:subPropertyOf :ne",
        ":a :ne :b . :a :other :b . :a owl:differentFrom :b",
    ),
    "a class by another name": (
        ":isA rdfs:subPropertyOf rdf:type . :C rdfs:subClassOf :D . :isA owl:propertyChainAxiom ( :p :isA )",
        ":a :isA :C . :b :p :a . :b a :C . :b owl:sameAs :c",
    ),
    "spellings of a value and a value that is not known": (
        ":d a owl:FunctionalProperty",
        ':a :d "x"^^:unknown . :a :d 1 . :b :e "1.0"^^xsd:decimal . :c :e "01"^^xsd:integer',
    ),
    "a class by a literal": (
        ":S owl:equivalentClass [ owl:onProperty :d ; owl:someValuesFrom xsd:byte ] . :d rdfs:domain :D",
        ":a :d 5 . :a :d 500 . :b :d 500",
    ),
    "a class and a property that are new": ("", ":a a :New . :a :new :b . :b owl:sameAs :c . :c a :New"),
}
CONTRADICTORY = {
    "different values of equal owners": (
        ":f a owl:FunctionalProperty",
        ":a :f :x . :b :f :y . :a owl:sameAs :b . :y owl:differentFrom :x",
    ),
    "no value": (
        f":O rdfs:subClassOf [ owl:onProperty :p ; owl:maxCardinality {NONE} ]",
        ":a a :O . :b :p :x . :a owl:sameAs :b",
    ),
    "no value in a class": (
        f":O rdfs:subClassOf [ owl:onProperty :p ; owl:maxQualifiedCardinality {NONE} ; owl:onClass :C ]",
        ":a a :O . :a :p :x . :y a :C . :x owl:sameAs :y",
    ),
    "disjoint properties of equal individuals": (
        ":p owl:propertyDisjointWith :q",
        ":a :p :x . :b :q :y . :a owl:sameAs :b . :x owl:sameAs :y",
    ),
    "disjoint properties, one by a chain": (
        ":t a owl:TransitiveProperty ; owl:propertyDisjointWith :q",
        ":a :t :b . :b :t :c . :a :q :c",
    ),
    "asymmetric over equal individuals": (
        ":p a owl:AsymmetricProperty",
        ":a :p :b . :b :p :c . :a owl:sameAs :c",
    ),
    "irreflexive over equal individuals": (
        ":p a owl:IrreflexiveProperty",
        ":a :p :b . :a owl:sameAs :c . :b owl:sameAs :c",
    ),
    "disjoint classes of equal individuals": (
        ":A owl:disjointWith :B . :p rdfs:range :B",
        ":a a :A . :x :p :b . :a owl:sameAs :b",
    ),
    "a negative assertion of an equal individual": (
        "[] a owl:NegativePropertyAssertion ; owl:sourceIndividual :a ; owl:assertionProperty :p ;"
        " owl:targetIndividual :b",
        ":x :p :y . :x owl:sameAs :a . :y owl:sameAs :b",
    ),
    "members of a list of different individuals": (
        "[] a owl:AllDifferent ; owl:members ( :a :b :c )",
        ":a owl:sameAs :x . :c owl:sameAs :y . :x owl:sameAs :y",
    ),
    "equal and different by other names": (
        ":eq rdfs:subPropertyOf owl:sameAs . :ne rdfs:subPropertyOf owl:differentFrom",
        ":a :eq :b . :b :eq :c . :a :ne :c",
    ),
    "a value of another datatype": (
        ":d rdfs:range xsd:byte",
        ":a :d 5 . :a :d 500",
    ),
}


@pytest.mark.parametrize(("axioms", "facts"), CONSISTENT.values(), ids=CONSISTENT)
def test_conclusions_equal_those_of_the_rules(axioms, facts):
    assert check_in_any_order(triples(f"{axioms} ." if axioms else ""), triples(f"{facts} .")) == 0


@pytest.mark.parametrize(("axioms", "facts"), CONTRADICTORY.values(), ids=CONTRADICTORY)
def test_the_fact_that_completes_a_contradiction_is_rejected(axioms, facts):
    assert check_in_any_order(triples(f"{axioms} ."), triples(f"{facts} .")) == 2
