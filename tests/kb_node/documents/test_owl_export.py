import pytest

from semmap.nodes.kb_node.documents import owl_export, rdf
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from tests.kb_node.graphs import canonical

SYNTAXES = ["functional", "manchester"]
HEAD = f"""@prefix : <http://e.org/m#> . @prefix e: <http://e.org/dm#> . @prefix owl: <{v.OWL}> .
@prefix rdf: <{v.RDF}> . @prefix rdfs: <{v.RDFS}> . @prefix xsd: <{v.XSD}> .
"""
TBOX = """e:p a owl:ObjectProperty . e:see a rdf:Property . e:d a owl:DatatypeProperty .
e:Cup a owl:Class . e:Old a owl:Class ."""
MAP = """<http://e.org/m> a owl:Ontology ; owl:versionInfo "1" .
:a a e:Cup ; e:p :b , [ a e:Cup ; e:d 6 ; e:p :a ] ; e:d 5 , "0005"^^xsd:integer , "INF"^^xsd:float ,
    "1e5"^^xsd:double , "caffè"@it , "a\\\\b\\"c\\nd" ; rdfs:label "hi"@en ;
    owl:sameAs <http://x.org/Mug_(cup)> .
:b a e:Cup ; e:p <http://e.org/m#a%20b> . <http://e.org/m#9.x> a e:Cup .
[] a owl:NegativePropertyAssertion ; owl:sourceIndividual :b ; owl:assertionProperty e:p ;
    owl:targetIndividual :a .
[] a owl:Axiom ; owl:annotatedSource :a ; owl:annotatedProperty rdf:type ; owl:annotatedTarget e:Cup ;
    rdfs:comment "sure" .
"""


def parsed(turtle):
    return rdf.parse((HEAD + turtle).encode(), "f")


def exported(turtle, syntax, prefixes=None):
    triples = parsed(turtle)
    stated = {*triples, *owl_export.declarations(triples, parsed(TBOX))}
    return stated, owl_export.write(stated, syntax, prefixes or {})


@pytest.mark.parametrize("syntax", SYNTAXES)
def test_a_written_map_is_read_back(syntax):
    stated, document = exported(MAP, syntax)
    assert (document.lost, document.notes) == (0, ())
    read = rdf.parse(document.content, "f")
    named = {t for t in read if t[2] == v.OWL_NAMED_INDIVIDUAL}  # Manchester syntax declares them
    assert canonical(set(read) - named) == canonical(stated)
    assert rdf.syntax_of(document.content) == syntax


@pytest.mark.parametrize("syntax", SYNTAXES)
def test_what_the_map_uses_of_the_tbox_is_declared(syntax):
    stated, _ = exported(MAP, syntax)
    assert {s for s, _, o in stated if o in (v.OWL_CLASS, *v.PROPERTY_KINDS)} == {
        f"<http://e.org/dm#{name}>" for name in ("p", "d", "Cup")
    }


@pytest.mark.parametrize("syntax", SYNTAXES)
def test_properties_that_nothing_declares_are_annotations(syntax):
    _, document = exported(':a a e:Cup ; e:alias "Tasse"@de ; e:see :b .', syntax)
    assert document.lost == 0
    text = document.content.decode()
    assert "AnnotationProperty" in text
    assert "DataProperty" not in text


@pytest.mark.parametrize("syntax", SYNTAXES)
def test_prefixes_are_used_where_names_allow_it(syntax):
    prefixes = {"m": "http://e.org/m#", "e": "http://e.org/dm#"}
    _, document = exported(MAP, syntax, prefixes)
    text = document.content.decode()
    assert "e:Cup" in text
    assert "m:" not in text.replace("http:", "")  # because of 9.x
    assert document.lost == 0


@pytest.mark.parametrize("syntax", SYNTAXES)
def test_triples_that_are_not_axioms_are_counted(syntax):
    _, document = exported(":a e:route ( :b ) .", syntax)
    assert document.lost == 2
    assert document.notes == ("left out: 2 triples that OWL cannot express (first: 1 and rest: 1)",)


@pytest.mark.parametrize("syntax", SYNTAXES)
def test_the_header_of_another_ontology_is_no_loss(syntax):
    _, document = exported("<http://e.org/one> a owl:Ontology . <http://e.org/two> a owl:Ontology .", syntax)
    assert (document.lost, document.notes) == (0, ())


def test_language_tags_have_their_usual_case():
    _, document = exported(':a rdfs:label "x"@en-GB .', "functional")
    assert b'"x"@en-GB' in document.content
    assert document.lost == 0


def test_an_axiom_of_classes_declares_them():
    red = ":Red owl:equivalentClass [ a owl:Restriction ; owl:onProperty e:p ; owl:hasValue :b ] ."
    _, document = exported(red, "functional")
    assert b"EquivalentClasses(<http://e.org/m#Red>" in document.content


def test_a_map_that_cannot_be_converted_is_rejected():
    undeclared = parsed(
        ":Red owl:equivalentClass [ a owl:Restriction ; owl:onProperty e:p ; owl:hasValue :b ] ."
    )
    with pytest.raises(errors.Refused, match=r"^OWL cannot express the map: .*; export as Turtle instead$"):
        owl_export.write(undeclared, "functional", {})
