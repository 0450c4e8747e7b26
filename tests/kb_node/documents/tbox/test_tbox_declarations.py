"""Prefixes, spatial roots, and what is set aside: told of a TBox, kept in it."""

from pathlib import Path

import pytest

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.documents.tbox import tbox_notes
from semmap.nodes.kb_node.documents.tbox.tbox_declarations import declared, extension, keeping_roots
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.ontology import HOUSEHOLD_TTL
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
    tbox = declared(triples(), spatial_root=[word])
    assert table(tbox).spatial_roots == (ANIMAL,)


def test_several_roots():
    assert len(table(declared(triples(), spatial_root=["Cat", "Idea"])).spatial) == 2


def test_a_root_that_there_is_not_is_refused():
    with pytest.raises(errors.UnknownClass, match=r"--spatial-root Anmal: .* did you mean Animal"):
        declared(triples(), spatial_root=["Anmal"])


def test_the_prefix_of_a_file_is_kept():
    tbox = declared(triples(), of_file=rdf.prefixes(ZOO.encode()))
    assert "z" in table(tbox).prefixes
    assert declared(tbox) == tbox


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
    before = table(declared(triples(), spatial_root=["Animal"]))
    assert table(keeping_roots(triples(), before)).spatial_roots == (ANIMAL,)
    other = declared(triples(), spatial_root=["Idea"])
    assert table(keeping_roots(other, before)).spatial_roots == ("<http://zoo.org/zoo#Idea>",)
    without = [t for t in triples() if ANIMAL not in t]
    assert table(keeping_roots(without, before)).spatial_roots == ()


def test_without_roots_it_is_told_what_that_means():
    assert "load it again with --spatial-root CLASS" in tbox_notes.not_in_space(table(triples()))


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


def test_what_no_map_could_be_kept_with_is_set_aside_and_told():
    region = "<http://www.ease-crc.org/ont/SOMA.owl#ColorRegion>"
    tbox = declared(triples(SOMA))
    assert (region, v.RDFS_SUB_CLASS_OF, REGION) in tbox
    reasoner = Reasoner(tbox)
    reasoner.apply(insert=triples(COLOR))
    note = tbox_notes.set_aside(tbox)
    assert note.startswith(
        "ignored, because no map could be kept with it: ColorRegion subClassOf PhysicalAtt"
    )
    assert declared(tbox) == tbox
    assert tbox_notes.set_aside(triples()) == ""


HOME = f"""
@prefix dm: <{v.TBOX}> . @prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
dm:Physical_Thing a owl:Class . dm:Cup a owl:Class ; rdfs:subClassOf dm:Physical_Thing .
"""


def extended(present, new, **fields):
    present = frozenset(present)
    return table(present | frozenset(extension(new, present, table(present), **fields)))


def test_an_extension_leaves_the_spatial_classes():
    after = extended(triples(HOME), triples(), spatial_root=["Animal"])
    assert {after.names[c] for c in after.spatial} == {"Physical_Thing", "Cup", "Animal", "Cat"}


def test_spatial_roots_of_another_vocabulary_are_added_to_those_declared():
    after = extended(declared(triples(), spatial_root=["Animal"]), triples(HOME))
    assert {"Animal", "Cat"} <= {after.names[c] for c in after.spatial}


def test_an_extension_by_the_household_s_words_leaves_the_roots_of_an_alignment():
    thing = "<http://www.ontologydesignpatterns.org/ont/dul/DUL.owl#PhysicalObject>"
    present = rdf.parse(f"{thing} a <http://www.w3.org/2002/07/owl#Class> .".encode(), "dul")
    after = extended(present, triples(HOME))
    assert {after.names[c] for c in after.spatial} == {"PhysicalObject", "Physical_Thing", "Cup"}


def test_an_extension_leaves_the_prefixes():
    present = declared(triples(), of_file={"z": "http://zoo.org/zoo#"})
    other = triples(ZOO.replace("zoo.org", "a.org"))
    for declares in ({"z": "http://a.org/zoo#"}, {"a": "http://zoo.org/zoo#"}, {}):
        after = extended(present, other, of_file=declares)
        assert after.prefixes["z"] == "http://zoo.org/zoo#"
        assert set(after.names.values()) >= {"z:Cat", "z:Animal"}
    kept = declared(other, of_file={"z": "http://a.org/zoo#"})  # as a client sends several files
    assert extended(present, kept).prefixes["z"] == "http://zoo.org/zoo#"


def test_what_is_there_extends_nothing():
    present = frozenset(declared(triples(), of_file={"z": "http://zoo.org/zoo#"}, spatial_root=["Cat"]))
    again = {"of_file": {"z": "http://zoo.org/zoo#"}, "spatial_root": ["Cat"]}
    assert extension(triples(), present, table(present), **again) == []


def test_the_household_s_things_remain_in_space_beside_declared_roots():
    files = [HOUSEHOLD_TTL, Path("zoo.ttl")]
    both = [*triples(HOME), *triples()]
    spatial = table(declared(both, spatial_root=["Animal"], files=files)).spatial_roots
    assert set(spatial) == {ANIMAL, v.PHYSICAL_THING}
    alone = table(declared(triples(HOME), spatial_root=["Cup"], files=files[:1]))
    assert alone.spatial_roots == (v.dm("Cup"),)
