"""Prefixes, spatial roots and ignored statements are declared in the TBox and kept."""

from pathlib import Path

import pytest

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.documents.tbox import tbox_notes
from semmap.nodes.kb_node.documents.tbox.tbox_declarations import (
    find_extension,
    with_declarations,
    with_spatial_roots_of,
)
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
    tbox = with_declarations(triples(), spatial_root=[word])
    assert table(tbox).spatial_roots == (ANIMAL,)


def test_several_roots():
    assert len(table(with_declarations(triples(), spatial_root=["Cat", "Idea"])).spatial) == 2


def test_an_unknown_root_is_rejected():
    with pytest.raises(errors.UnknownClass, match=r"--spatial-root Anmal: .* did you mean Animal"):
        with_declarations(triples(), spatial_root=["Anmal"])


def test_the_prefix_of_a_file_is_kept():
    tbox = with_declarations(triples(), of_file=rdf.read(ZOO.encode(), "x").prefixes)
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
    assert rdf.read(text.encode(), "x").prefixes == prefixes


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


HOME = f"""
@prefix dm: <{v.TBOX}> . @prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
dm:Physical_Thing a owl:Class . dm:Cup a owl:Class ; rdfs:subClassOf dm:Physical_Thing .
"""


def extended(present, new, **fields):
    present = frozenset(present)
    return table(present | frozenset(find_extension(new, present, table(present), **fields)))


def test_an_extension_leaves_the_spatial_classes():
    after = extended(triples(HOME), triples(), spatial_root=["Animal"])
    assert {after.names[c] for c in after.spatial} == {"Physical_Thing", "Cup", "Animal", "Cat"}


def test_spatial_roots_of_another_vocabulary_are_added_to_those_declared():
    after = extended(with_declarations(triples(), spatial_root=["Animal"]), triples(HOME))
    assert {"Animal", "Cat"} <= {after.names[c] for c in after.spatial}


def test_an_extension_by_the_household_s_words_leaves_the_roots_of_an_alignment():
    thing = "<http://www.ontologydesignpatterns.org/ont/dul/DUL.owl#PhysicalObject>"
    present = rdf.parse(f"{thing} a <http://www.w3.org/2002/07/owl#Class> .".encode(), "dul")
    after = extended(present, triples(HOME))
    assert {after.names[c] for c in after.spatial} == {"PhysicalObject", "Physical_Thing", "Cup"}


def test_an_extension_leaves_the_prefixes():
    present = with_declarations(triples(), of_file={"z": "http://zoo.org/zoo#"})
    other = triples(ZOO.replace("zoo.org", "a.org"))
    for declares in ({"z": "http://a.org/zoo#"}, {"a": "http://zoo.org/zoo#"}, {}):
        after = extended(present, other, of_file=declares)
        assert after.prefixes["z"] == "http://zoo.org/zoo#"
        assert set(after.names.values()) >= {"z:Cat", "z:Animal"}
    kept = with_declarations(other, of_file={"z": "http://a.org/zoo#"})  # as a client sends several files
    assert extended(present, kept).prefixes["z"] == "http://zoo.org/zoo#"


def test_what_is_there_extends_nothing():
    present = frozenset(
        with_declarations(triples(), of_file={"z": "http://zoo.org/zoo#"}, spatial_root=["Cat"])
    )
    again = {"of_file": {"z": "http://zoo.org/zoo#"}, "spatial_root": ["Cat"]}
    assert find_extension(triples(), present, table(present), **again) == []


def test_the_household_s_things_remain_in_space_beside_declared_roots():
    files = [HOUSEHOLD_TTL, Path("zoo.ttl")]
    both = [*triples(HOME), *triples()]
    spatial = table(with_declarations(both, spatial_root=["Animal"], files=files)).spatial_roots
    assert set(spatial) == {ANIMAL, v.PHYSICAL_THING}
    alone = table(with_declarations(triples(HOME), spatial_root=["Cup"], files=files[:1]))
    assert alone.spatial_roots == (v.dm("Cup"),)
