import re

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.documents.tbox import tbox_notes
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.ontology import HOUSEHOLD_TTL
from semmap.ontology import vocabulary as v
from tests.kb_node import home


def notes(text: str = ""):
    prefix = f"@prefix : <{v.ABOX}> ."
    return notes_of(rdf.parse((home.TBOX_TURTLE + prefix + text).encode(), "tbox", label_prefix="t"))


def notes_of(tbox):
    reasoner = Reasoner(tbox)
    return tbox_notes.notes(tbox, reasoner, ClassTable(reasoner))


def test_a_regular_tbox_has_no_notes():
    assert notes() == ()


def test_missing_imports_are_named():
    assert notes("<urn:o> a owl:Ontology ; owl:imports <urn:p> , <urn:o> .") == (
        "1 import was not found; the TBox is used without: urn:p",
    )
    many = " , ".join(f"<urn:p{i}>" for i in range(7))
    assert notes(f"<urn:o> owl:imports {many} .") == (
        "7 imports were not found; the TBox is used without:"
        " urn:p0, urn:p1, urn:p2, urn:p3, urn:p4 and 2 more",
    )


def test_axioms_beyond_owl_2_rl_are_counted():
    some = "[ a owl:Restriction ; owl:onProperty dm:hasSize ; owl:someValuesFrom dm:Chair ]"
    assert notes(f"dm:Chair rdfs:subClassOf {some} .") == (
        "1 axiom goes beyond OWL 2 RL; that part has no effect (1 x existential restriction as a superclass)",
    )
    (said,) = notes(f"dm:Chair rdfs:subClassOf {some} , {some} . dm:near a owl:ReflexiveProperty .")
    assert said.startswith("3 axioms go beyond OWL 2 RL; that part has no effect (2 x existential")
    assert said.endswith("1 x reflexive property)")


def test_ineffective_axioms_of_the_shipped_tbox_are_not_reported_but_added_ones_are():
    tbox = rdf.parse(HOUSEHOLD_TTL.read_bytes(), "household")
    more = rdf.parse(f"{v.dm('near')} a <{v.OWL}ReflexiveProperty> .".encode(), "more")
    assert notes_of(tbox) == ()
    (said,) = notes_of([*tbox, *more])
    assert said.endswith("(1 x reflexive property)")


def test_entities_that_the_tbox_describes_are_counted():
    (said,) = notes(":chair1 a dm:Chair . :a a dm:Seat . :kitchen1 a dm:Kitchen . :b a dm:Seat .")
    assert said == (
        "4 entities are described by the TBox itself, so commands cannot change them:"
        " a, b, chair1 and kitchen1"
    )


def test_the_reason_for_slow_changes_is_reported_with_the_time():
    (said,) = notes("dm:Chair owl:sameAs dm:Stuhl .")
    assert re.fullmatch(
        r"not incremental: classes or properties are compared: .*, about \d+ ms a change", said
    )


def test_missing_spatial_properties_are_reported():
    """If a TBox has some of the properties, facts are computed for those."""
    lab = [
        t for t in home.TBOX if v.local_name(t[0]) not in {"isOn", "isInside", "isLocatedIn", "isAttachedTo"}
    ]
    assert notes_of(lab) == (
        "the TBox has none of isAttachedTo, isInside, isLocatedIn, isOn, so spatial relations are measured"
        " on request and are not facts",
    )
    on = (v.dm("isOn"), v.RDF_TYPE, "<http://www.w3.org/2002/07/owl#ObjectProperty>")
    assert notes_of([*lab, on]) == ()
