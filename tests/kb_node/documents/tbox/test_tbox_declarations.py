"""Prefixes, spatial roots and ignored statements are declared in the TBox and kept."""

import pytest

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.documents.tbox import tbox_notes
from semmap.nodes.kb_node.documents.tbox.tbox_declarations import with_declarations, with_spatial_roots_of
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.ontology import vocabulary as v
from semmap.schemas import errors

ZOO = """
@prefix z: <http://zoo.org/zoo#> . @prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
z:Animal a owl:Class ; rdfs:label "bestia"@it . z:Cat a owl:Class ; rdfs:subClassOf z:Animal .
z:Idea a owl:Class .
"""
ANIMAL = "<http://zoo.org/zoo#Animal>"


def triples(text=ZOO):
    return rdf.parse(text.encode(), "zoo")


def table(tbox):
    return ClassTable(Reasoner(tbox))


@pytest.mark.parametrize("word", ["Animal", "zoo:Animal", "http://zoo.org/zoo#Animal", ANIMAL, "bestia"])
def test_a_root_is_given_by_iri_or_name(word):
    tbox = with_declarations(triples(), spatial_root=[word])
    assert table(tbox).spatial_roots == (ANIMAL,)


def test_several_roots():
    assert len(table(with_declarations(triples(), spatial_root=["Cat", "Idea"])).spatial) == 2


def test_an_unknown_root_is_rejected():
    with pytest.raises(errors.UnknownClass, match=r"--spatial-root Anmal: .* did you mean Animal"):
        with_declarations(triples(), spatial_root=["Anmal"])


def test_the_prefix_of_a_file_is_kept():
    tbox = with_declarations(triples(), of_file=rdf.prefixes(ZOO.encode()))
    assert "z" in table(tbox).prefixes
    assert with_declarations(tbox) == tbox


@pytest.mark.parametrize(
    ("text", "prefixes"),
    [
        ("@prefix a: <http://a#> . a:x a a:y .", {"a": "http://a#"}),
        ("Prefix(a:=<http://a#>)\nPrefix(:=<http://b#>)\nOntology(<http://a>)", {"a": "http://a#", "": "http://b#"}),
        ("Prefix: a: <http://a#>\nOntology: <http://a>", {"a": "http://a#"}),
        (
            '<Ontology xmlns="http://www.w3.org/2002/07/owl#" ontologyIRI="http://a">'
            '<Prefix name="a" IRI="http://a#"/></Ontology>',
            {"a": "http://a#"},
        ),
        ("<http://a#x> <http://a#y> <http://a#z> .", {}),
    ],
)  # fmt: skip
def test_prefixes_are_read_from_every_syntax(text, prefixes):
    assert rdf.prefixes(text.encode()) == prefixes


def test_roots_stay_until_others_are_declared():
    before = table(with_declarations(triples(), spatial_root=["Animal"]))
    assert table(with_spatial_roots_of(triples(), before)).spatial_roots == (ANIMAL,)
    other = with_declarations(triples(), spatial_root=["Idea"])
    assert table(with_spatial_roots_of(other, before)).spatial_roots == ("<http://zoo.org/zoo#Idea>",)
    without = [t for t in triples() if ANIMAL not in t]
    assert table(with_spatial_roots_of(without, before)).spatial_roots == ()


def test_without_roots_the_consequence_is_reported():
    assert "load it again with --spatial-root CLASS" in tbox_notes.no_spatial_class_note(table(triples()))


SOMA = """
@prefix soma: <http://www.ease-crc.org/ont/SOMA.owl#> . @prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix dul: <http://www.ontologydesignpatterns.org/ont/dul/DUL.owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
dul:Region a owl:Class . dul:PhysicalAttribute a owl:Class ; rdfs:subClassOf dul:Region ;
    rdfs:subClassOf [ a owl:Restriction ; owl:onProperty dul:isRegionFor ;
        owl:allValuesFrom dul:PhysicalObject ] .
dul:PhysicalObject a owl:Class . soma:Color a owl:Class ; owl:disjointWith dul:PhysicalObject .
soma:ColorRegion a owl:Class ; rdfs:subClassOf dul:PhysicalAttribute .
dul:hasRegion a owl:ObjectProperty ; owl:inverseOf dul:isRegionFor . dul:isRegionFor a owl:ObjectProperty .
"""
REGION = "<http://www.ontologydesignpatterns.org/ont/dul/DUL.owl#Region>"
COLOR = (
    SOMA.partition("dul:Region a")[0] + "<http://x#c> a soma:Color ; dul:hasRegion [ a soma:ColorRegion ] ."
)


def test_statements_that_make_every_map_inconsistent_are_ignored_and_reported():
    region = "<http://www.ease-crc.org/ont/SOMA.owl#ColorRegion>"
    tbox = with_declarations(triples(SOMA))
    assert (region, v.RDFS_SUB_CLASS_OF, REGION) in tbox
    reasoner = Reasoner(tbox)
    reasoner.apply(insert=triples(COLOR))
    note = tbox_notes.ignored_statements_note(tbox)
    assert note.startswith(
        "ignored, because every map would be inconsistent with it: ColorRegion subClassOf PhysicalAtt"
    )
    assert with_declarations(tbox) == tbox
    assert tbox_notes.ignored_statements_note(triples()) == ""
