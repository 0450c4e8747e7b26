"""Which axioms follow, and which similar ones do not."""

import pytest

from tests.kb_node.reasoner.entailment.cases import cases, follows

FOLLOWS = """
a disjoint union: the union, and its parts are disjoint
    :U owl:equivalentClass [ owl:unionOf (:A :B) ] . :A owl:disjointWith :B
    :U owl:disjointUnionOf (:A :B)
inverse functional because its inverse is functional
    :p owl:inverseOf :q . :q a owl:FunctionalProperty
    :p a owl:InverseFunctionalProperty
reflexive because the one below is
    :knows a owl:ReflexiveProperty ; rdfs:subPropertyOf :meets
    :meets a owl:ReflexiveProperty
a subproperty by inverses
    :p owl:inverseOf :q . :r rdfs:subPropertyOf :q . :s owl:inverseOf :r
    :s rdfs:subPropertyOf :p
three properties that are disjoint in pairs
    :p owl:propertyDisjointWith :q , :r . :q owl:propertyDisjointWith :r
    [] a owl:AllDisjointProperties ; owl:members (:r :p :q)
a key with one more property
    :Person owl:hasKey (:number)
    :Person owl:hasKey (:number :name)
an enumeration in another order
    :C owl:equivalentClass [ owl:oneOf (:a :b) ]
    :C owl:oneOf (:b :a)
the complement of an equivalent class
    :C owl:complementOf :D . :D owl:equivalentClass :E
    :C owl:complementOf :E
a union in another order, with a repeated part
    :C owl:unionOf (:A :B)
    :C owl:unionOf (:B :A :B)
different by their values, also in a list
    :a :p 1 , 2
    [] a owl:AllDifferent ; owl:members (1 2)
a value differs from an individual in a class without values
    :p rdfs:range xsd:integer . :A owl:disjointWith xsd:integer . :a a :A . :b :p 1
    [] a owl:AllDifferent ; owl:members (1 :a)
used as a class by a member
    :a a :A
    :A a owl:Class
used as a class by a restriction
    :A rdfs:subClassOf SOME(:p :B)
    :B a rdfs:Class
used as a property by an edge
    :a :p :b
    :p a rdf:Property , owl:ObjectProperty
used as a property by a restriction
    :A rdfs:subClassOf SOME(:p :B)
    :p a owl:ObjectProperty
used as a property above another
    :p rdfs:subPropertyOf :q
    :q a rdf:Property
a data property is a property
    :d a owl:DatatypeProperty
    :d a rdf:Property
a datatype is a class of RDF Schema
    :T a rdfs:Datatype
    :T a rdfs:Class
"""

DOES_NOT = """
a union whose parts may have common members
    :U owl:equivalentClass [ owl:unionOf (:A :B) ]
    :U owl:disjointUnionOf (:A :B)
a part of a disjoint union
    :U owl:equivalentClass [ owl:unionOf (:A :B :C) ] . :A owl:disjointWith :B
    :U owl:disjointUnionOf (:A :B)
inverse functional because it is functional itself
    :p owl:inverseOf :q . :p a owl:FunctionalProperty
    :p a owl:InverseFunctionalProperty
three properties of which two are not disjoint
    :p owl:propertyDisjointWith :q , :r
    [] a owl:AllDisjointProperties ; owl:members (:r :p :q)
three classes of which two are not disjoint
    :A owl:disjointWith :B , :C
    [] a owl:AllDisjointClasses ; owl:members (:C :B :A)
a key with one property less
    :Person owl:hasKey (:number :name)
    :Person owl:hasKey (:number)
a chain in another order
    :s owl:propertyChainAxiom (:q :r)
    :s owl:propertyChainAxiom (:r :q)
a chain with one step more
    :s owl:propertyChainAxiom (:q :r)
    :s owl:propertyChainAxiom (:q :r :r)
an enumeration that leaves one out
    :C owl:equivalentClass [ owl:oneOf (:a :b :c) ]
    :C owl:oneOf (:b :a)
a union that has further members
    :C rdfs:subClassOf [ owl:unionOf (:A :B) ]
    :C owl:unionOf (:B :A)
different in spelling only
    :a :p 1 , "1.0"^^xsd:decimal
    [] a owl:AllDifferent ; owl:members (1 "1.0"^^xsd:decimal)
a value that is not known may be any
    :a :p 1 , "x"^^:unknown
    [] a owl:AllDifferent ; owl:members (1 "x"^^:unknown)
an individual is not used as a class
    :a :p :b
    :a a owl:Class
an individual is not used as a property
    :a :p :b
    :b a rdf:Property
a class is not used as a property
    :A rdfs:subClassOf :B
    :A a rdf:Property
a property is not used as a class
    :p rdfs:subPropertyOf :q
    :p a owl:Class
a functional property may be a data property
    :p a owl:FunctionalProperty
    :p a owl:ObjectProperty
"""


@pytest.mark.parametrize(("premise", "conclusion"), cases(FOLLOWS))
def test_an_axiom_follows(premise, conclusion):
    assert follows(premise, conclusion)


@pytest.mark.parametrize(("premise", "conclusion"), cases(DOES_NOT))
def test_an_axiom_does_not_follow(premise, conclusion):
    assert not follows(premise, conclusion)
