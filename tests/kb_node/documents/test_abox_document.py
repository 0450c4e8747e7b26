from types import SimpleNamespace

import pytest

from semmap.nodes.kb_node.documents import abox_document
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.entities import Pose
from tests.kb_node import home, stating
from tests.kb_node.home import turtle

MAPS_OWN = (
    "only the map declares {}: nothing can be added by such classes; to add them to the TBox, load the map"
    " with --tbox-from-abox"
)


@pytest.fixture(scope="module")
def classes():
    return ClassTable(Reasoner(home.TBOX))


def test_a_document_with_known_classes_is_accepted_completely(classes):
    triples = turtle(
        ":a a dm:Chair , owl:NamedIndividual ; dm:hasPosition [ a dm:Coordinates ] . <urn:o> a owl:Ontology ."
    )
    assert abox_document.filter_document(triples, classes, skip_unknown=False) == (list(triples), [], [])


def test_all_unknown_classes_are_named(classes):
    triples = turtle(":c a dm:Chiar . :x a dm:Xylophone . :d a dm:Door . :y a dm:Xylophone .")
    with pytest.raises(errors.UnknownClass) as caught:
        abox_document.filter_document(triples, classes, skip_unknown=False)
    assert caught.value.text == (
        "unknown classes 'Chiar' (of c; did you mean Chair?), 'Xylophone' (of x, y);"
        " see: semmap classes; --skip-unknown leaves these out"
    )


def test_an_error_names_the_file_and_counts_blank_nodes(classes):
    origin = abox_document.DocumentOrigin("map.ttl")
    with pytest.raises(errors.UnknownClass, match=r"^map.ttl: unknown class 'Pose' \(of x, 2 blank nodes\)"):
        abox_document.filter_document(
            turtle("[] a dm:Pose . :x a dm:Pose . [] a dm:Pose ."),
            classes,
            skip_unknown=False,
            of_file=origin,
        )
    with pytest.raises(errors.BadFile, match=r"^map.ttl: declares classes but no entities; to load a TBox"):
        abox_document.filter_document(turtle(":C a owl:Class ."), classes, skip_unknown=False, of_file=origin)


@pytest.mark.parametrize("namespace", ["http://lab.org/x#", v.TBOX.replace("_domain_model", ""), v.ABOX])
def test_a_class_in_a_wrong_namespace_is_suggested_in_the_right_one(classes, namespace):
    with pytest.raises(errors.UnknownClass) as caught:
        abox_document.filter_document(turtle(f":c a <{namespace}Chair> ."), classes, skip_unknown=False)
    assert caught.value.text == (
        f"unknown class '<{namespace}Chair>' (of c; did you mean <{v.TBOX}Chair> (prefix dm:)?);"
        " see: semmap classes; --skip-unknown leaves these out"
    )


def test_of_many_classes_in_a_wrong_namespace_one_is_named(classes):
    triples = turtle(":c a :Chair . :d a :Door . :k a :Kitchen . :x a dm:Xylophone .")
    with pytest.raises(errors.UnknownClass) as caught:
        abox_document.filter_document(triples, classes, skip_unknown=False)
    assert caught.value.text == (
        f"unknown classes '<{v.ABOX}Chair>' (of c, d and 1 more; did you mean <{v.TBOX}Chair> (prefix dm:),"
        " and so for 2 more classes?), 'Xylophone' (of x); see: semmap classes;"
        " --skip-unknown leaves these out"
    )
    _, words, _ = abox_document.filter_document(triples, classes, skip_unknown=True)
    assert len(words) == 4


def test_a_class_in_the_right_namespace_is_suggested_by_its_name(classes):
    with pytest.raises(errors.UnknownClass, match=r"'chair' \(of c; did you mean Chair\?\)"):
        abox_document.filter_document(turtle(":c a dm:chair ."), classes, skip_unknown=False)


def test_a_skipped_entity_is_skipped_with_its_nodes(classes):
    kept = turtle(":d a dm:Door ; dm:hasPreferredReference :shared . :shared dm:lexicalReference 'it' .")
    skipped = turtle(
        ":x a dm:Xylophone ; dm:hasPosition :x_coordinates ; dm:hasPreferredReference :shared ; dm:near :d ."
        " :x_coordinates a dm:Coordinates ; dm:float_coordinates_x 1 . :d dm:near :x ."
    )
    triples, words, _ = abox_document.filter_document([*skipped, *kept], classes, skip_unknown=True)
    assert set(triples) == set(kept)
    assert words == ["x (unknown class 'Xylophone')"]


def test_an_entity_that_a_skipped_one_refers_to_is_kept(classes):
    robot = turtle(":robot a dm:Robot ; dm:holds :chair1 .")
    held = turtle(":chair1 a dm:Chair .")
    assert abox_document.filter_document([*robot, *held], classes, skip_unknown=True).triples == list(held)


def test_only_the_unknown_one_of_two_classes_is_skipped(classes):
    triples = turtle(":c a dm:Chair , dm:Antique ; dm:near :d .")
    kept, words, _ = abox_document.filter_document(triples, classes, skip_unknown=True)
    assert set(kept) == set(turtle(":c a dm:Chair ; dm:near :d ."))
    assert words == ["c (unknown class 'Antique')"]


def test_a_class_that_the_document_declares_is_accepted_but_is_not_in_the_map(classes):
    triples = turtle(":s a dm:Sofa . dm:Sofa a owl:Class ; rdfs:subClassOf dm:Seat .")
    filtered = abox_document.filter_document(triples, classes, skip_unknown=False)
    assert filtered.skipped == []
    assert filtered.notes == [MAPS_OWN.format("Sofa")]


def test_a_literal_as_class_is_unknown(classes):
    with pytest.raises(errors.UnknownClass):
        abox_document.filter_document(
            [(v.entity_iri("a"), v.RDF_TYPE, '"Chair"')], classes, skip_unknown=False
        )


def test_numbers_may_have_any_numeric_datatype(classes):
    node = v.entity_iri("a_coordinates")
    said = [
        (node, v.COORDINATE_XYZ[i], v.literal("1", v.iri(v.XSD + kind)))
        for i, kind in enumerate(("integer", "decimal", "double"))
    ]
    meant = [(node, p, v.literal("1", v.XSD_FLOAT)) for p in v.COORDINATE_XYZ]
    assert abox_document.filter_document(said, classes, skip_unknown=False).triples == meant


def test_a_property_that_may_be_misspelt_is_reported(classes):
    triples = [(v.entity_iri("cup1"), v.dm("hasPositoin"), v.entity_iri("x"))]
    (note,) = abox_document.filter_document(triples, classes, skip_unknown=False).notes
    assert "unknown property 'hasPositoin' (of cup1; did you mean hasPosition" in note
    text = "[] a dm:Property ; dm:hue 1 . [] a dm:Property ; dm:hue 2 ."
    (note,) = abox_document.filter_document(turtle(text), classes, skip_unknown=False).notes
    assert note == "unknown property 'hue' (of a nameless individual of class Property)"


HALF = ":p a dm:Coordinates ; dm:float_coordinates_x '1'^^xsd:float"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (f"{HALF} .", "p has no float_coordinates_y and no float_coordinates_z"),
        (f"{HALF} ; dm:float_coordinates_z 0 .", "p has no float_coordinates_y"),
        (f"{HALF} ; dm:float_coordinates_y 0 ; dm:float_coordinates_z 0 .", None),
        (
            ":c dm:hasPosition [ dm:float_coordinates_x 1 ; dm:float_coordinates_y 1 ] .",
            "c has no float_coordinates_z",
        ),
        (":s dm:float_size_x 1 ; dm:float_size_y 1 .", "s has no float_size_z"),
    ],
)
def test_incomplete_values_are_reported(text, said, classes):
    notes = abox_document.filter_document(turtle(text), classes, skip_unknown=False).notes
    notes = [note for note in notes if "unknown" not in note]
    whole = f"incomplete position, orientation or size ignored: {said}"
    assert notes == ([whole] if said else [])


def test_only_a_few_of_many_incomplete_values_are_reported(classes):
    text = "".join(f":s{i} dm:float_size_x 1 ." for i in range(50))
    *_, note = abox_document.filter_document(turtle(text), classes, skip_unknown=False).notes
    assert note.endswith("s4 has no float_size_y and no float_size_z and 45 more")


def test_literals_outside_a_range_get_a_datatype_of_it():
    classes = ClassTable(Reasoner(stating.TBOX))
    said = turtle(
        ":a a dm:Chair ; dm:seats '4' , 5 ; dm:mass 3 ; dm:madeOn 'noon' ; dm:serial 7 ; dm:note 8 ."
    )
    meant = turtle(
        ":a a dm:Chair ; dm:seats '4'^^xsd:nonNegativeInteger , 5 ; dm:mass '3'^^xsd:float ;"
        " dm:madeOn 'noon' ; dm:serial '7' ; dm:note 8 ."
    )
    triples, _, notes = abox_document.filter_document(said, classes, skip_unknown=False)
    assert set(triples) == set(meant)
    assert notes == [
        "3 values stored with the datatype of the property: mass (float), seats (nonNegativeInteger),"
        " serial (string)"
    ]


def filtered_names(classes, text):
    filtered = abox_document.filter_document(turtle(text), classes, skip_unknown=False)
    return sorted({v.entity_name(s) for s, p, o in filtered.triples if o == v.dm("Chair")}), filtered


@pytest.mark.parametrize("namespace", ["", "https://w3id.org/bot#"], ids=["plain", "with an alignment"])
def test_blank_nodes_of_spatial_classes_get_names_that_stay(namespace):
    terms = turtle(f"<{namespace}Zone> a owl:Class .") if namespace else []
    classes = ClassTable(Reasoner([*home.TBOX, *terms]))
    assert bool(classes.alignments) == bool(namespace)
    text = ":k a dm:Kitchen . [] a dm:Chair ; dm:near :k ; dm:hasPosition [ dm:float_coordinates_x '1' ] ."
    names, filtered = filtered_names(classes, text)
    (name,) = names
    assert name.startswith("chair_")
    assert filtered.notes[0] == f"1 blank node stored with names: {name}"
    assert (v.entity_iri(name), v.dm("near"), v.entity_iri("k")) in filtered.triples
    assert len(filtered.triples) == len(turtle(text))
    known = abox_document.DocumentOrigin(find=lambda name: SimpleNamespace(iri=v.bare(v.entity_iri(name))))
    again = abox_document.filter_document(turtle(text), classes, skip_unknown=False, of_file=known)
    assert again.notes == filtered.notes[1:]
    assert filtered_names(classes, text)[0] == names
    assert filtered_names(classes, text.replace("'1'", "'2'"))[0] != names


def test_the_name_of_a_blank_node_stays_if_the_frame_of_its_pose_has_moved():
    soma, knowrob = "http://www.ease-crc.org/ont/SOMA.owl#", "http://knowrob.org/kb/knowrob.owl#"
    classes = ClassTable(Reasoner([*home.TBOX, *turtle(f"<{soma}hasLocalization> a owl:ObjectProperty .")]))
    text = (
        f"[] a dm:Chair ; <{soma}hasLocalization> [ <{soma}hasSpaceRegion> [ <{knowrob}relativeTo> :base ;"
        f" <{knowrob}translation> '1 0 0' ; <{knowrob}quaternion> '0 0 0 1' ] ] ."
    )
    first, moved = (
        abox_document.filter_document(
            turtle(text),
            classes,
            skip_unknown=False,
            find_frame=lambda _, x=x: Pose(position_m=(x, 0.0, 0.0)),
        )
        for x in (0.0, 2.0)
    )
    assert first.triples != moved.triples
    assert first.notes[-1] == moved.notes[-1]
    assert first.notes[-1].startswith("1 blank node stored with names: chair_")


def test_blank_nodes_that_are_alike_get_different_names(classes):
    names, _ = filtered_names(
        classes, "[] a dm:Chair . [] a dm:Chair . [] a dm:Chair ; dm:near [ a dm:Chair ] ."
    )
    assert len(names) == 4
    assert [name.count("_") for name in names].count(2) == 2


def test_the_names_of_many_blank_nodes_that_are_alike_are_each_tried_once(classes, monkeypatch):
    tried, make = [], v.entity_iri
    triples = turtle("[] a dm:Chair ." * 100)
    monkeypatch.setattr(v, "entity_iri", lambda name: tried.append(name) or make(name))
    abox_document.filter_document(triples, classes, skip_unknown=False)
    assert len(tried) == len(set(tried)) == 100


def test_the_name_of_a_blank_node_differs_from_those_in_the_document(classes):
    ((name,), _) = filtered_names(classes, "[] a dm:Chair .")
    names, filtered = filtered_names(classes, f":{name} a dm:Chair . [] a dm:Chair .")
    assert filtered.notes[0] == f"1 blank node stored with names: {name}_2"
    assert set(names) == {name, f"{name}_2"}


def test_the_name_of_a_blank_node_does_not_depend_on_the_order_of_its_classes(classes):
    one, _ = filtered_names(classes, "[] a dm:Chair , dm:Kitchen .")
    other, _ = filtered_names(classes, "[] a dm:Kitchen , dm:Chair .")
    assert list(one) == list(other)


def test_a_circle_of_blank_nodes_gets_names(classes):
    names, _ = filtered_names(classes, "_:a a dm:Chair ; dm:near _:b . _:b a dm:Chair ; dm:near _:a , _:b .")
    assert len(names) == 2


def test_a_property_with_an_unknown_class_is_kept(classes):
    triples = turtle(
        ":p a owl:ObjectProperty , :Kind . :c a dm:Chair ; :p :c . :x a owl:NamedIndividual , :Kind ."
    )
    kept, words, _ = abox_document.filter_document(triples, classes, skip_unknown=True)
    assert set(kept) == set(turtle(":p a owl:ObjectProperty . :c a dm:Chair ; :p :c ."))
    assert words == ["p (unknown class 'Kind')", "x (unknown class 'Kind')"]
