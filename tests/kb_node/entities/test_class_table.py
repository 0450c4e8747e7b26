import pytest

from nodes.kb_node.entities.class_table import ClassTable
from nodes.kb_node.reasoner import Reasoner
from ontology import vocabulary as v
from schemas import errors
from tests.kb_node import home
from tests.kb_node.home import turtle


def table(text="", tbox=home.TBOX):
    return ClassTable(Reasoner([*tbox, *turtle(text)]))


def test_a_row_says_what_commands_need():
    row = next(row for row in table().rows if row.name == "Chair")
    assert row.iri == v.bare(v.dm("Chair"))
    assert (row.parents, row.ancestors) == (("Seat",), ("Seat", "Object", "Physical_Thing"))
    assert (row.labels, row.comment) == ({"en": "chair", "it": "sedia"}, "To sit on.")
    assert (row.spatial, row.place, row.fixed, row.model) == (True, False, False, "chair")


def test_annotations_come_from_the_nearest_ancestor():
    rows = {row.name: row for row in table("dm:Gate a owl:Class ; rdfs:subClassOf dm:Door .").rows}
    assert (rows["Gate"].fixed, rows["Gate"].model) == (True, "box")
    assert (rows["Kitchen"].fixed, rows["Kitchen"].model) == (False, "")


def test_a_nearer_annotation_wins_over_a_farther_one():
    text = "dm:Gate a owl:Class ; rdfs:subClassOf dm:Door ; dm:fixed false ."
    assert v.dm("Gate") not in table(text).fixed


def test_spatial_classes_and_places():
    rows = table().rows
    assert {row.name for row in rows if row.place} == {"Location", "Kitchen"}
    assert {row.name for row in rows if not row.spatial} == {
        "Property", "Coordinates", "3Three_Dim_Size", "PreferredReference", "AlternativeReference"
    }  # fmt: skip


def test_without_a_domain_of_positions_physical_things_are_spatial():
    tbox = [t for t in home.TBOX if t[1] != v.RDFS_DOMAIN]
    assert v.dm("Chair") in table(tbox=tbox).spatial


def test_a_cycle_of_subclasses_does_no_harm():
    names = [row.name for row in table("dm:Seat rdfs:subClassOf dm:Chair .").rows]
    assert {"Seat", "Chair"} <= set(names)


def test_special_first_is_by_depth_and_leaves_unknown_classes_out():
    special_first = table().special_first
    given = [v.OBJECT, v.OWL_THING, v.dm("Chair"), "_:x", v.dm("Nothing_Known")]
    assert special_first(given) == [v.dm("Chair"), v.OBJECT]


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("<http://a.org/x#Chair> a owl:Class .", "two classes named Chair, .*: rename one"),
        (
            "<http://a.org/x#> a owl:Class .",
            r"<http://a\.org/x#> of the TBox needs an IRI that ends in a name",
        ),
        ("<http://a.org/x#A*> a owl:Class .", "needs an IRI that ends in a name"),
    ],
)
def test_classes_must_be_told_apart_by_their_names(text, fault):
    with pytest.raises(errors.BadFile, match=fault):
        table(text)
