"""Small graphs for the tests, written in Turtle."""

from pathlib import Path

import pyoxigraph

PREFIXES = """
@prefix : <http://example.org/> .
@prefix dm: <http://www.semanticweb.org/ontologies/2016/1/semantic_mapping_domain_model#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix xsd: <http://www.w3.org/2001/XMLSchema#> .
"""

EVERYTHING = """
:A a owl:Class . :B a owl:Class ; rdfs:subClassOf :A . :C a owl:Class ; rdfs:subClassOf :B .
:D a owl:Class ; owl:equivalentClass :E . :F a owl:Class .
:U a owl:Class ; owl:unionOf ( :C :D ) . :I a owl:Class ; owl:intersectionOf ( :A :F ) .
:N a owl:Class ; owl:complementOf :D2 . :X owl:disjointWith :Y .
[] a owl:AllDisjointClasses ; owl:members ( :X :Z :W ) .
:O a owl:Class ; owl:oneOf ( :i0 :i1 ) .

:p a owl:ObjectProperty ; rdfs:domain :A ; rdfs:range :F . :q a owl:ObjectProperty ; rdfs:subPropertyOf :p .
:inv a owl:ObjectProperty ; owl:inverseOf :q .
:sym a owl:ObjectProperty , owl:SymmetricProperty ; rdfs:subPropertyOf :p2 .
:tra a owl:ObjectProperty , owl:TransitiveProperty . :subtra rdfs:subPropertyOf :tra .
:fun a owl:ObjectProperty , owl:FunctionalProperty . :subfun rdfs:subPropertyOf :fun .
:ifp a owl:ObjectProperty , owl:InverseFunctionalProperty .
:irr a owl:ObjectProperty , owl:IrreflexiveProperty . :asy a owl:ObjectProperty , owl:AsymmetricProperty .
:eq1 owl:equivalentProperty :eq2 . :dis1 owl:propertyDisjointWith :dis2 .
[] a owl:AllDisjointProperties ; owl:members ( :adp1 :adp2 :adp3 ) .
:chain owl:propertyChainAxiom ( :q :tra ) . :long owl:propertyChainAxiom ( :p :inv :fun ) .

:Some a owl:Class ; owl:onProperty :tra ; owl:someValuesFrom :C .
:SomeThing a owl:Class ; owl:onProperty :dis1 ; owl:someValuesFrom owl:Thing .
:Only a owl:Class ; owl:onProperty :tra ; owl:allValuesFrom :G .
:Has a owl:Class ; owl:onProperty :p ; owl:hasValue :i2 . :Has rdfs:subClassOf :H . :K2 rdfs:subClassOf :Has .
:HasData a owl:Class ; owl:onProperty :data ; owl:hasValue "1.0"^^xsd:float .
:Max0 owl:onProperty :m0 ; owl:maxCardinality "0"^^xsd:nonNegativeInteger .
:Max1 owl:onProperty :m1 ; owl:maxCardinality "1"^^xsd:nonNegativeInteger .
:MaxQ0 owl:onProperty :m0 ; owl:maxQualifiedCardinality "0"^^xsd:nonNegativeInteger ; owl:onClass :F .
:MaxQ1 owl:onProperty :m1 ; owl:maxQualifiedCardinality "1"^^xsd:nonNegativeInteger ; owl:onClass :C .
:Exactly1 owl:onProperty :m1 ; owl:qualifiedCardinality "1"^^xsd:nonNegativeInteger ; owl:onClass :B .
:K owl:hasKey ( :key1 :key2 ) . :subkey rdfs:subPropertyOf :key1 .

:data a owl:DatatypeProperty ; rdfs:range xsd:float ; rdfs:domain :A .
:fundata a owl:DatatypeProperty , owl:FunctionalProperty .
:key2 a owl:DatatypeProperty . :int rdfs:range xsd:nonNegativeInteger . :ifd a owl:InverseFunctionalProperty .
:DataSome owl:onProperty :int ; owl:someValuesFrom xsd:byte .

[] a owl:NegativePropertyAssertion ; owl:sourceIndividual :i0 ;
    owl:assertionProperty :p ; owl:targetIndividual :i3 .
[] a owl:NegativePropertyAssertion ; owl:sourceIndividual :i1 ;
    owl:assertionProperty :fundata ; owl:targetValue "2"^^xsd:integer .
[] a owl:AllDifferent ; owl:distinctMembers ( :i4 :i5 ) .
"""
"""A schema with every construct of OWL 2 RL."""


def _names(text):
    return text.split()


CLASSES = _names(
    "A B C D E F U I N D2 X Y Z W O G Some SomeThing Only Has K2 HasData Max0 Max1 MaxQ0 MaxQ1 "
    "Exactly1 K DataSome"
)
OBJECT_PROPERTIES = _names(
    "p q inv sym tra subtra fun subfun ifp irr asy eq1 eq2 dis1 dis2 adp1 adp2 chain long m0 m1 "
    "key1 subkey free"
)
DATA_PROPERTIES = _names("data fundata key2 int ifd")
LITERALS = (
    '"1.0"^^xsd:float', '"1.00"^^xsd:float', '"0.0"^^xsd:float', '"-0.0"^^xsd:float', '"2"^^xsd:integer',
    '"2.0"^^xsd:decimal', '"300"^^xsd:integer', '"-1"^^xsd:integer', '"a"', '"a"@en', '"abc"^^xsd:float',
    '"x"^^:unknown',
)  # fmt: skip


def household():
    """Return the household TBox."""
    path = Path(__file__).parents[3] / "ontology" / "household.ttl"
    quads = pyoxigraph.parse(path=str(path), format=pyoxigraph.RdfFormat.TURTLE)
    return [(str(quad.subject), str(quad.predicate), str(quad.object)) for quad in quads]


def triples(turtle):
    """Parse Turtle with the usual prefixes."""
    quads = pyoxigraph.parse(PREFIXES + turtle, format=pyoxigraph.RdfFormat.TURTLE)
    return [(str(quad.subject), str(quad.predicate), str(quad.object)) for quad in quads]


def triple(turtle):
    """Parse Turtle that has one triple."""
    [found] = triples(turtle + " .")
    return found
