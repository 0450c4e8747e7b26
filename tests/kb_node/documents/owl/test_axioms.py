"""Each OWL construct in functional syntax, compared with the triples of the W3C mapping."""

from __future__ import annotations

import pyhornedowl
import pyoxigraph
import pytest

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.documents.blank_nodes import relabel_like
from tests.data import data_folder

HEAD = "Prefix(:=<urn:t:>)\nOntology(<urn:t>\n"
TURTLE = """
@prefix : <urn:t:> . @prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix xsd: <http://www.w3.org/2001/XMLSchema#> . @prefix swrl: <http://www.w3.org/2003/11/swrl#> .
<urn:t> a owl:Ontology .
"""


def some(members: str) -> str:
    return f"[ a owl:Restriction; owl:onProperty :p; {members} ]"


def number(kind: str, n: int) -> str:
    return f'owl:{kind}Cardinality "{n}"^^xsd:nonNegativeInteger'


CONSTRUCTS = [
    ("Declaration(Class(:A))", ":A a owl:Class ."),
    ("Declaration(Datatype(:A))", ":A a rdfs:Datatype ."),
    ("Declaration(ObjectProperty(:p))", ":p a owl:ObjectProperty ."),
    ("Declaration(DataProperty(:p))", ":p a owl:DatatypeProperty ."),
    ("Declaration(AnnotationProperty(:p))", ":p a owl:AnnotationProperty ."),
    ("Declaration(NamedIndividual(:i))", ":i a owl:NamedIndividual ."),
    ("SubClassOf(:A :B)", ":A rdfs:subClassOf :B ."),
    ("SubClassOf(:A owl:Nothing)", ":A rdfs:subClassOf owl:Nothing ."),
    ("EquivalentClasses(:A :B :C)", ":A owl:equivalentClass :B . :B owl:equivalentClass :C ."),
    ("DisjointClasses(:A :B)", ":A owl:disjointWith :B ."),
    ("DisjointClasses(:A :B :C)", "[] a owl:AllDisjointClasses; owl:members (:A :B :C) ."),
    ("DisjointUnion(:A :B :C)", ":A owl:disjointUnionOf (:B :C) ."),
    (
        "SubClassOf(:A ObjectIntersectionOf(:B :C))",
        ":A rdfs:subClassOf [ a owl:Class; owl:intersectionOf (:B :C) ] .",
    ),
    ("SubClassOf(ObjectUnionOf(:B :C) :A)", "[ a owl:Class; owl:unionOf (:B :C) ] rdfs:subClassOf :A ."),
    ("SubClassOf(:A ObjectComplementOf(:B))", ":A rdfs:subClassOf [ a owl:Class; owl:complementOf :B ] ."),
    ("SubClassOf(:A ObjectOneOf(:i :j))", ":A rdfs:subClassOf [ a owl:Class; owl:oneOf (:i :j) ] ."),
    ("SubClassOf(:A ObjectSomeValuesFrom(:p :B))", f":A rdfs:subClassOf {some('owl:someValuesFrom :B')} ."),
    ("SubClassOf(:A ObjectAllValuesFrom(:p :B))", f":A rdfs:subClassOf {some('owl:allValuesFrom :B')} ."),
    ("SubClassOf(:A ObjectHasValue(:p :i))", f":A rdfs:subClassOf {some('owl:hasValue :i')} ."),
    ("SubClassOf(:A ObjectHasSelf(:p))", f":A rdfs:subClassOf {some('owl:hasSelf true')} ."),
    (
        "SubClassOf(:A ObjectMinCardinality(2 :p :B))",
        f":A rdfs:subClassOf {some(number('minQualified', 2) + '; owl:onClass :B')} .",
    ),
    (
        "SubClassOf(:A ObjectMaxCardinality(1 :p))",
        f""":A rdfs:subClassOf {some('owl:maxCardinality "1"^^xsd:nonNegativeInteger')} .""",
    ),
    (
        "SubClassOf(:A ObjectExactCardinality(1 :p :B))",
        f":A rdfs:subClassOf {some(number('qualified', 1) + '; owl:onClass :B')} .",
    ),
    (
        "SubClassOf(:A DataSomeValuesFrom(:p xsd:int))",
        f":A rdfs:subClassOf {some('owl:someValuesFrom xsd:int')} .",
    ),
    (
        "SubClassOf(:A DataAllValuesFrom(:p xsd:int))",
        f":A rdfs:subClassOf {some('owl:allValuesFrom xsd:int')} .",
    ),
    (
        'SubClassOf(:A DataHasValue(:p "1"^^xsd:integer))',
        f":A rdfs:subClassOf {some('owl:hasValue 1')} .",
    ),
    (
        "SubClassOf(:A DataMaxCardinality(1 :p xsd:int))",
        f""":A rdfs:subClassOf {
            some('owl:maxQualifiedCardinality "1"^^xsd:nonNegativeInteger; owl:onDataRange xsd:int')
        } .""",
    ),
    (
        "SubClassOf(:A DataExactCardinality(3 :p))",
        f""":A rdfs:subClassOf {some('owl:cardinality "3"^^xsd:nonNegativeInteger')} .""",
    ),
    (
        "SubClassOf(:A DataMinCardinality(3 :p))",
        f""":A rdfs:subClassOf {some('owl:minCardinality "3"^^xsd:nonNegativeInteger')} .""",
    ),
    (
        "SubClassOf(:A ObjectSomeValuesFrom(ObjectInverseOf(:p) :B))",
        ":A rdfs:subClassOf [ a owl:Restriction; owl:onProperty [ owl:inverseOf :p ];"
        " owl:someValuesFrom :B ] .",
    ),
    ("SubObjectPropertyOf(:p :q)", ":p rdfs:subPropertyOf :q ."),
    ("SubObjectPropertyOf(ObjectPropertyChain(:p :q) :r)", ":r owl:propertyChainAxiom (:p :q) ."),
    ("EquivalentObjectProperties(:p :q)", ":p owl:equivalentProperty :q ."),
    ("DisjointObjectProperties(:p :q)", ":p owl:propertyDisjointWith :q ."),
    ("DisjointObjectProperties(:p :q :r)", "[] a owl:AllDisjointProperties; owl:members (:p :q :r) ."),
    ("InverseObjectProperties(:p :q)", ":p owl:inverseOf :q ."),
    ("ObjectPropertyDomain(:p :A)", ":p rdfs:domain :A ."),
    ("ObjectPropertyRange(:p :A)", ":p rdfs:range :A ."),
    ("FunctionalObjectProperty(:p)", ":p a owl:FunctionalProperty ."),
    ("InverseFunctionalObjectProperty(:p)", ":p a owl:InverseFunctionalProperty ."),
    ("ReflexiveObjectProperty(:p)", ":p a owl:ReflexiveProperty ."),
    ("IrreflexiveObjectProperty(:p)", ":p a owl:IrreflexiveProperty ."),
    ("SymmetricObjectProperty(:p)", ":p a owl:SymmetricProperty ."),
    ("AsymmetricObjectProperty(:p)", ":p a owl:AsymmetricProperty ."),
    ("TransitiveObjectProperty(:p)", ":p a owl:TransitiveProperty ."),
    ("SubDataPropertyOf(:p :q)", ":p rdfs:subPropertyOf :q ."),
    ("EquivalentDataProperties(:p :q)", ":p owl:equivalentProperty :q ."),
    ("DisjointDataProperties(:p :q)", ":p owl:propertyDisjointWith :q ."),
    ("DataPropertyDomain(:p :A)", ":p rdfs:domain :A ."),
    ("DataPropertyRange(:p xsd:int)", ":p rdfs:range xsd:int ."),
    ("FunctionalDataProperty(:p)", ":p a owl:FunctionalProperty ."),
    (
        'DataPropertyRange(:p DataOneOf("a" "b"@en))',
        ':p rdfs:range [ a rdfs:Datatype; owl:oneOf ("a" "b"@en) ] .',
    ),
    (
        "DataPropertyRange(:p DataUnionOf(xsd:int DataComplementOf(xsd:string)))",
        ":p rdfs:range [ a rdfs:Datatype; owl:unionOf "
        "(xsd:int [ a rdfs:Datatype; owl:datatypeComplementOf xsd:string ]) ] .",
    ),
    (
        "DataPropertyRange(:p DataIntersectionOf(xsd:int xsd:long))",
        ":p rdfs:range [ a rdfs:Datatype; owl:intersectionOf (xsd:int xsd:long) ] .",
    ),
    (
        'DatatypeDefinition(:D DatatypeRestriction(xsd:integer xsd:minInclusive "5"^^xsd:integer'
        ' xsd:length "1"^^xsd:int))',
        ":D owl:equivalentClass [ a rdfs:Datatype; owl:onDatatype xsd:integer; owl:withRestrictions "
        '([ xsd:minInclusive 5 ] [ xsd:length "1"^^xsd:int ]) ] .',
    ),
    ("HasKey(:A (:p) (:d))", ":A owl:hasKey (:p :d) ."),
    ("SameIndividual(:i :j)", ":i owl:sameAs :j ."),
    ("DifferentIndividuals(:i :j)", ":i owl:differentFrom :j ."),
    ("DifferentIndividuals(:i :j :k)", "[] a owl:AllDifferent; owl:members (:i :j :k) ."),
    ("ClassAssertion(:A :i)", ":i a :A ."),
    ("ObjectPropertyAssertion(:p :i :j)", ":i :p :j ."),
    ("ObjectPropertyAssertion(ObjectInverseOf(:p) :i :j)", ":j :p :i ."),
    (
        "NegativeObjectPropertyAssertion(:p :i :j)",
        "[] a owl:NegativePropertyAssertion; owl:sourceIndividual :i; owl:assertionProperty :p;"
        " owl:targetIndividual :j .",
    ),
    (
        'NegativeDataPropertyAssertion(:p :i "x")',
        "[] a owl:NegativePropertyAssertion; owl:sourceIndividual :i; owl:assertionProperty :p;"
        ' owl:targetValue "x" .',
    ),
    ('DataPropertyAssertion(:p :i "a \\"b\\" \\\\"@EN-gb)', ':i :p "a \\"b\\" \\\\"@en-gb .'),
    ('DataPropertyAssertion(:p :i "x@de"^^rdf:PlainLiteral)', ':i :p "x"@de .'),
    ('DataPropertyAssertion(:p :i "x@"^^rdf:PlainLiteral)', ':i :p "x" .'),
    (
        "ClassAssertion(:A _:x) ObjectPropertyAssertion(:p _:x _:y) ClassAssertion(:B _:y)",
        "_:x a :A; :p _:y . _:y a :B .",
    ),
    ('AnnotationAssertion(rdfs:label :A "a"@en)', ':A rdfs:label "a"@en .'),
    ("AnnotationAssertion(rdfs:seeAlso :A <http://x>)", ":A rdfs:seeAlso <http://x> ."),
    ("SubAnnotationPropertyOf(:p :q)", ":p rdfs:subPropertyOf :q ."),
    ("AnnotationPropertyDomain(:p :A)", ":p rdfs:domain :A ."),
    ("AnnotationPropertyRange(:p :A)", ":p rdfs:range :A ."),
    ("Import(<urn:other>)", "<urn:t> owl:imports <urn:other> ."),
    ('Annotation(rdfs:comment "c")', '<urn:t> rdfs:comment "c" .'),
    (
        'SubClassOf(Annotation(Annotation(:q "why") rdfs:comment "c") :A :B)',
        ":A rdfs:subClassOf :B . _:x a owl:Axiom; owl:annotatedSource :A;"
        ' owl:annotatedProperty rdfs:subClassOf; owl:annotatedTarget :B; rdfs:comment "c" .'
        " [] a owl:Annotation; owl:annotatedSource _:x; owl:annotatedProperty rdfs:comment;"
        ' owl:annotatedTarget "c"; :q "why" .',
    ),
    (
        'DisjointClasses(Annotation(rdfs:comment "c") :A :B :C)',
        '[] a owl:AllDisjointClasses; owl:members (:A :B :C); rdfs:comment "c" .',
    ),
    (
        'AnnotationAssertion(Annotation(:q "who") rdfs:label :A "a")',
        ':A rdfs:label "a" . [] a owl:Axiom; owl:annotatedSource :A; owl:annotatedProperty rdfs:label;'
        ' owl:annotatedTarget "a"; :q "who" .',
    ),
    (
        "DLSafeRule(Body(ClassAtom(:A Variable(<urn:x>))) Head(ObjectPropertyAtom(:p Variable(<urn:x>) :i)))",
        "<urn:x> a swrl:Variable . [] a swrl:Imp; swrl:body [ a swrl:AtomList; rdf:rest (); rdf:first"
        " [ a swrl:ClassAtom; swrl:classPredicate :A; swrl:argument1 <urn:x> ] ];"
        " swrl:head [ a swrl:AtomList; rdf:rest (); rdf:first [ a swrl:IndividualPropertyAtom;"
        " swrl:propertyPredicate :p; swrl:argument1 <urn:x>; swrl:argument2 :i ] ] .",
    ),
]


@pytest.mark.parametrize(("axiom", "turtle"), CONSTRUCTS, ids=lambda text: text.partition("(")[0][:40])
def test_a_construct_becomes_the_triples_of_the_mapping(axiom, turtle):
    read = rdf.parse((HEAD + axiom + ")").encode(), "o.ofn", label_prefix="r")
    expected = rdf.parse((TURTLE + turtle).encode(), "expected.ttl", label_prefix="x")
    assert relabel_like(read, expected) == frozenset(expected)
    assert len(read) == len(set(read)) == len(expected)


def test_the_triples_do_not_depend_on_the_run():
    axioms = "".join(
        axiom for axiom, _ in CONSTRUCTS if "Import" not in axiom and "Annotation(rdfs" not in axiom
    )
    content = (HEAD + axioms + ")").encode()
    assert rdf.parse(content, "o") == rdf.parse(content, "o")


def test_an_ontology_may_have_no_name():
    read = rdf.parse(b"Ontology(Declaration(Class(<urn:A>)))", "o", label_prefix="r")
    assert ("_:rontology", "<http://www.w3.org/1999/02/22-rdf-syntax-ns#type>") in {t[:2] for t in read}


@pytest.mark.parametrize("file", ["SOMA.owl", "DUL.owl"])
def test_another_parser_finds_the_same_axioms_in_the_triples(file):
    """Compare with the library's own RDF reader."""
    path = data_folder() / "ontologies" / "soma" / file
    if not path.exists():
        pytest.skip(f"there is no {path}")
    content = path.read_bytes()
    triples = rdf.parse(content, file)
    quads = pyoxigraph.parse(rdf.serialise(triples, "ntriples"), pyoxigraph.RdfFormat.N_TRIPLES)
    xml = pyoxigraph.serialize(quads, format=pyoxigraph.RdfFormat.RDF_XML)
    assert xml is not None
    back = pyhornedowl.open_ontology_from_string(xml.decode(), serialization="rdf")
    before = pyhornedowl.open_ontology_from_string(content.decode(), serialization="ofn")
    kinds = [sorted(type(axiom.component).__name__ for axiom in o.get_axioms()) for o in (before, back)]
    assert kinds[0] == kinds[1]
