"""The OWL syntaxes are equivalent, recognised by content, and report errors with a line."""

from __future__ import annotations

import pytest

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.documents.blank_nodes import relabel_like
from semmap.ontology import vocabulary as v
from semmap.schemas import errors

FUNCTIONAL = """# a kitchen
Prefix(:=<http://k.org/kitchen#>)
Ontology(<http://k.org/kitchen> <http://k.org/kitchen/2>
  Import(<http://k.org/things>)
  Annotation(rdfs:comment "what a kitchen has")
  Declaration(Class(:Fridge)) Declaration(Class(:Drink)) Declaration(Class(:Cold))
  Declaration(ObjectProperty(:holds)) Declaration(DataProperty(:degrees))
  Declaration(NamedIndividual(:f1))
  AnnotationAssertion(rdfs:label :Fridge "Kühlschrank"@de)
  SubClassOf(:Fridge ObjectAllValuesFrom(:holds ObjectUnionOf(:Drink :Cold)))
  SubClassOf(:Drink DataSomeValuesFrom(:degrees
    DatatypeRestriction(xsd:integer xsd:maxInclusive "9"^^xsd:integer)))
  EquivalentClasses(:Cold ObjectIntersectionOf(:Drink ObjectSomeValuesFrom(ObjectInverseOf(:holds) :Fridge)))
  DisjointClasses(:Fridge :Drink)
  FunctionalDataProperty(:degrees)
  ClassAssertion(:Fridge :f1)
  DataPropertyAssertion(:degrees :f1 "4"^^xsd:integer)
)
"""
MANCHESTER = """# a kitchen
Prefix: : <http://k.org/kitchen#>
Ontology: <http://k.org/kitchen> <http://k.org/kitchen/2>
Import: <http://k.org/things>
Annotations: rdfs:comment "what a kitchen has"

ObjectProperty: holds
DataProperty: degrees
    Characteristics: Functional
Class: Fridge
    Annotations: rdfs:label "Kühlschrank"@de
    SubClassOf: holds only (Drink or Cold)
    DisjointWith: Drink
Class: Drink
    SubClassOf: degrees some xsd:integer[<= 9]
Class: Cold
    EquivalentTo: Drink that inverse (holds) some Fridge
Individual: f1
    Types: Fridge
    Facts: degrees 4
"""
OWL_XML = """<?xml version="1.0"?>
<!DOCTYPE Ontology [
  <!ENTITY k "http://k.org/kitchen">
  <!ENTITY xsd "http://www.w3.org/2001/XMLSchema#">
]>
<Ontology xmlns="http://www.w3.org/2002/07/owl#" xml:base="&k;"
    ontologyIRI="&k;" versionIRI="&k;/2">
  <Prefix name="" IRI="http://k.org/kitchen#"/>
  <Prefix name="rdfs" IRI="http://www.w3.org/2000/01/rdf-schema#"/>
  <Import>http://k.org/things</Import>
  <Annotation><AnnotationProperty abbreviatedIRI="rdfs:comment"/>
    <Literal>what a kitchen has</Literal></Annotation>
  <Declaration><Class IRI="#Fridge"/></Declaration>
  <Declaration><Class abbreviatedIRI=":Drink"/></Declaration>
  <Declaration><Class IRI="&k;#Cold"/></Declaration>
  <Declaration><ObjectProperty IRI="#holds"/></Declaration>
  <Declaration><DataProperty IRI="#degrees"/></Declaration>
  <Declaration><NamedIndividual IRI="#f1"/></Declaration>
  <AnnotationAssertion><AnnotationProperty abbreviatedIRI="rdfs:label"/><IRI>#Fridge</IRI>
    <Literal xml:lang="de">Kühlschrank</Literal></AnnotationAssertion>
  <SubClassOf><Class IRI="#Fridge"/><ObjectAllValuesFrom><ObjectProperty IRI="#holds"/>
    <ObjectUnionOf><Class IRI="#Drink"/><Class IRI="#Cold"/></ObjectUnionOf></ObjectAllValuesFrom>
  </SubClassOf>
  <SubClassOf><Class IRI="#Drink"/><DataSomeValuesFrom><DataProperty IRI="#degrees"/>
    <DatatypeRestriction><Datatype IRI="&xsd;integer"/><FacetRestriction facet="&xsd;maxInclusive">
      <Literal datatypeIRI="&xsd;integer">9</Literal></FacetRestriction></DatatypeRestriction>
  </DataSomeValuesFrom></SubClassOf>
  <EquivalentClasses><Class IRI="#Cold"/><ObjectIntersectionOf><Class IRI="#Drink"/><ObjectSomeValuesFrom>
    <ObjectInverseOf><ObjectProperty IRI="#holds"/></ObjectInverseOf><Class IRI="#Fridge"/>
  </ObjectSomeValuesFrom></ObjectIntersectionOf></EquivalentClasses>
  <DisjointClasses><Class IRI="#Fridge"/><Class IRI="#Drink"/></DisjointClasses>
  <FunctionalDataProperty><DataProperty IRI="#degrees"/></FunctionalDataProperty>
  <ClassAssertion><Class IRI="#Fridge"/><NamedIndividual IRI="#f1"/></ClassAssertion>
  <DataPropertyAssertion><DataProperty IRI="#degrees"/><NamedIndividual IRI="#f1"/>
    <Literal datatypeIRI="&xsd;integer">4</Literal></DataPropertyAssertion>
</Ontology>
"""
TURTLE = """@prefix : <http://k.org/kitchen#> . @prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> . @prefix xsd: <http://www.w3.org/2001/XMLSchema#> .
<http://k.org/kitchen> a owl:Ontology; owl:versionIRI <http://k.org/kitchen/2>;
  owl:imports <http://k.org/things>; rdfs:comment "what a kitchen has" .
:Fridge a owl:Class; rdfs:label "Kühlschrank"@de; owl:disjointWith :Drink; rdfs:subClassOf
  [ a owl:Restriction; owl:onProperty :holds;
    owl:allValuesFrom [ a owl:Class; owl:unionOf (:Drink :Cold) ] ] .
:Drink a owl:Class; rdfs:subClassOf [ a owl:Restriction; owl:onProperty :degrees; owl:someValuesFrom
  [ a rdfs:Datatype; owl:onDatatype xsd:integer; owl:withRestrictions ([ xsd:maxInclusive 9 ]) ] ] .
:Cold a owl:Class; owl:equivalentClass [ a owl:Class; owl:intersectionOf (:Drink
  [ a owl:Restriction; owl:onProperty [ owl:inverseOf :holds ]; owl:someValuesFrom :Fridge ]) ] .
:holds a owl:ObjectProperty . :degrees a owl:DatatypeProperty, owl:FunctionalProperty .
:f1 a owl:NamedIndividual, :Fridge; :degrees 4 .
"""
SYNTAXES = {"functional": FUNCTIONAL, "manchester": MANCHESTER, "owlxml": OWL_XML}


@pytest.mark.parametrize("syntax", SYNTAXES)
def test_all_syntaxes_give_the_same_triples(syntax):
    read = rdf.parse(SYNTAXES[syntax].encode(), "kitchen", label_prefix="r")
    expected = rdf.parse(TURTLE.encode(), "kitchen.ttl", label_prefix="x")
    assert relabel_like(read, expected) == frozenset(expected)


@pytest.mark.parametrize(
    ("content", "syntax"),
    [
        *((text, syntax) for syntax, text in SYNTAXES.items()),
        ("Ontology( )", "functional"),
        ("\n# x\n  Prefix ( a:=<urn:a> )", "functional"),
        ("Ontology:\n", "manchester"),
        ("Ontology: k:kitchen\n", "manchester"),
        ("Prefix: k: <urn:k>\n", "manchester"),
        ('<owl:Ontology xmlns:owl="http://www.w3.org/2002/07/owl#" ontologyIRI="urn:o"/>', "owlxml"),
        (
            '<owl:Ontology xmlns:owl="http://www.w3.org/2002/07/owl#"'
            ' xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#" rdf:about="urn:o"/>',
            "rdfxml",
        ),
        ("PREFIX k: <urn:k>\nk:a k:b k:c .", "turtle"),
        ("@prefix Ontology: <urn:k> .\nOntology:a a Ontology:b .", "turtle"),
        ("# Ontology(\n<urn:a> <urn:b> <urn:c> .", "turtle"),
    ],
)
def test_the_syntax_is_recognised_by_the_content(content, syntax):
    assert rdf.syntax_of(content.encode()) == syntax


@pytest.mark.parametrize(
    ("content", "text"),
    [
        (
            FUNCTIONAL.replace("DisjointClasses(", "DisjointClases("),
            "f is not valid OWL functional syntax: line 14 cannot be read, where ontology axiom is expected:"
            " 'DisjointClases(:Fridge :Drink)'",
        ),
        (FUNCTIONAL.replace("(:Fridge :f1)", "(z:Fridge :f1)"), "line 16: undefined prefix (z:Fridge)"),
        (FUNCTIONAL.rstrip(")\n"), "line 17 cannot be read"),
        (
            FUNCTIONAL.replace("(:Fridge :f1)", "(<Fridge> :f1)"),
            "line 16 cannot be read, where absolute IRI is expected",
        ),
        (
            MANCHESTER.replace("degrees some", "degrees som"),
            "not valid Manchester syntax: line 15 cannot be read: 'SubClassOf: degrees som xsd:integer",
        ),
        (MANCHESTER.replace("Types: Fridge", "Types: z:Fridge"), "line 19: undefined prefix (z:Fridge)"),
        (
            OWL_XML.replace("<DisjointClasses>", "<Disjoint>"),
            "f is not valid OWL/XML: mismatched tag: line 31",
        ),
        (OWL_XML.replace("FunctionalData", "FunctionalDat"), "line 32: Unexpected tag: found FunctionalDat"),
        (OWL_XML.replace('":Drink"', '"z:Drink"'), "line 14: undefined prefix (z:Drink)"),
        (
            OWL_XML.replace("<IRI>#Fridge</IRI>", "<AbbreviatedIRI> z:Fridge</AbbreviatedIRI>"),
            "line 19: undefined prefix (z:Fridge)",
        ),
        (
            OWL_XML.replace('"http://k.org/kitchen">', 'SYSTEM "file:///etc/passwd">'),
            "is not allowed",
        ),
    ],
)
def test_an_error_has_its_line(content, text):
    with pytest.raises(errors.BadFile) as caught:
        rdf.parse(content.encode(), "f")
    assert text in caught.value.text
    assert "\n" not in caught.value.text


def test_the_standard_prefixes_of_owl_xml_need_no_declaration():
    declaration = '<Prefix name="rdfs" IRI="http://www.w3.org/2000/01/rdf-schema#"/>'
    assert declaration in OWL_XML
    iri = OWL_XML.replace("<IRI>#Fridge</IRI>", f"<IRI>{v.RDFS}label</IRI>")
    name = iri.replace(declaration, "").replace(
        f"<IRI>{v.RDFS}label</IRI>", "<AbbreviatedIRI> rdfs:label </AbbreviatedIRI>"
    )
    read, expected = (rdf.parse(text.encode(), "f", label_prefix="x") for text in (name, iri))
    assert set(read) == set(expected)


def test_text_that_looks_like_a_keyword_is_not_changed():
    content = MANCHESTER.replace("what a kitchen has", "all that a # kitchen &k; has")
    assert '"all that a # kitchen &k; has"' in {o for _, _, o in rdf.parse(content.encode(), "f")}


def test_the_f_of_floats_is_removed():
    content = "Prefix: : <urn:k:>\nOntology: <urn:o>\nDataProperty: d\nIndividual: i\n    Facts: d 2.5f\n"
    assert ("<urn:k:i>", "<urn:k:d>", v.literal("2.5", v.XSD_FLOAT)) in rdf.parse(content.encode(), "f")


def test_anonymous_individuals_of_two_documents_are_different():
    content = b"Ontology(ClassAssertion(<urn:A> _:x) ObjectPropertyAssertion(<urn:p> _:x _:x))"
    a, b = ({s for s, _, o in rdf.parse(content, "f", label_prefix=p) if o == s} for p in ("a", "b"))
    assert len(a) == len(b) == 1
    assert a != b
