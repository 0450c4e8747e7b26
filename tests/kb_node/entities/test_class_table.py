import pytest

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.ontology import vocabulary as v
from semmap.ontology.prefixes import PREFERRED_PREFIX
from semmap.schemas import errors
from tests.kb_node import home
from tests.kb_node.home import turtle


def table(text="", tbox=home.TBOX):
    return ClassTable(Reasoner([*tbox, *turtle(text)]))


def test_a_row_has_what_commands_need():
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


def test_a_cycle_of_subclasses_is_accepted():
    names = [row.name for row in table("dm:Seat rdfs:subClassOf dm:Chair .").rows]
    assert {"Seat", "Chair"} <= set(names)


def test_the_most_specific_class_is_the_deepest_and_unknown_classes_are_omitted():
    most_specific_first = table().most_specific_first
    given = [v.OBJECT, v.OWL_THING, v.dm("Chair"), "_:x", v.dm("Nothing_Known")]
    assert most_specific_first(given) == [v.dm("Chair"), v.OBJECT]


TWINS = "<http://a.org/lab.owl#Chair> a owl:Class ; rdfs:subClassOf dm:Seat ."


def test_ambiguous_class_names_have_prefixes():
    classes = table(TWINS)
    assert {"dm:Chair", "lab:Chair", "Seat"} <= set(classes.iris)
    assert "Chair" not in classes.iris
    assert classes.ambiguous == {"Chair": ("dm:Chair", "lab:Chair")}
    rows = {row.name: row for row in classes.rows}
    assert rows["lab:Chair"].iri == "http://a.org/lab.owl#Chair"
    assert (rows["Seat"].prefixed, rows["lab:Chair"].prefixed) == ("dm:Seat", "lab:Chair")


def test_a_prefix_declared_by_the_ontology_is_used():
    declared = f'<http://a.org/lab.owl#> {PREFERRED_PREFIX} "Kit" .'
    assert "kit:Chair" in table(TWINS + declared).iris


@pytest.mark.parametrize(
    "iri", ["http://a.org/x#", "http://a.org/x#A*", "urn:x:A b".replace(" ", "%20"), "http://a/?c=$1"]
)
def test_an_iri_without_a_local_name_is_accepted(iri):
    classes = table(f"<{iri}> a owl:Class .")
    name = classes.names[f"<{iri}>"]
    assert name
    assert classes.iris[name] == f"<{iri}>"


def test_a_class_is_found_by_its_names_and_labels():
    index = table().index
    words = ["Chair", "dm:Chair", v.dm("Chair"), v.bare(v.dm("Chair")), "chair", "SEDIA"]
    assert {index.find(word) for word in words} == {"Chair"}
    assert index.find("sofa") is None


def test_domains_and_ranges_have_the_names_of_the_class_table():
    lab = "<http://a.org/lab.owl#seats> a owl:ObjectProperty ; rdfs:domain dm:Chair ; rdfs:range dm:Seat ."
    rows = {row.name: row for row in table(TWINS + lab).property_table.rows()}
    assert (rows["seats"].domain, rows["seats"].range) == (("dm:Chair",), ("Seat",))


def test_additional_labels_are_kept():
    row = next(row for row in table('dm:Chair rdfs:label "poltrona"@it .').rows if row.name == "Chair")
    assert (row.labels["it"], row.also) == ("poltrona", ("sedia",))


def test_ambiguous_property_names_have_prefixes():
    classes = table("<http://a.org/lab.owl#isLocatedIn> a owl:ObjectProperty .")
    find = classes.property_names.find
    assert find("lab:isLocatedIn") == "<http://a.org/lab.owl#isLocatedIn>"
    assert find("has_size") == v.HAS_SIZE
    assert find("isLocatedIn", among=lambda p: p != v.IS_LOCATED_IN) == "<http://a.org/lab.owl#isLocatedIn>"
    assert find("xyzzy") is None
    with pytest.raises(
        errors.BadRequest, match="'isLocatedIn' is ambiguous: dm:isLocatedIn or lab:isLocatedIn"
    ):
        find("isLocatedIn")


ZOO = """
@prefix z: <http://zoo.org/zoo#> . @prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
z:Animal a owl:Class . z:Cat a owl:Class ; rdfs:subClassOf z:Animal . z:Idea a owl:Class .
"""


def zoo(text=""):
    return ClassTable(Reasoner(rdf.parse((ZOO + text).encode(), "zoo")))


def test_an_unknown_vocabulary_has_no_spatial_classes_by_default():
    assert (zoo().spatial_roots, zoo().spatial) == ((), frozenset())
    said = zoo(f"z:Animal {v.SPATIAL} true .")
    assert said.spatial_roots == ("<http://zoo.org/zoo#Animal>",)
    assert {said.names[c] for c in said.spatial} == {"Animal", "Cat"}


def test_declarations_of_the_tbox_take_precedence():
    assert {row.name for row in table(f"dm:Seat {v.SPATIAL} true .").rows if row.spatial} == {"Seat", "Chair"}


def test_rdfs_classes_are_classes():
    assert "Dog" in zoo("z:Dog a rdfs:Class .").iris


def test_in_a_household_tbox_without_roots_all_but_properties_are_spatial():
    text = (
        "dm:Cup a owl:Class . dm:Property a owl:Class . dm:Color a owl:Class ; rdfs:subClassOf dm:Property ."
    )
    spatial = {row.name: row.spatial for row in table(text, ()).rows}
    assert spatial == {"Cup": True, "Property": False, "Color": False}


def test_a_declared_root_replaces_the_default():
    text = "dm:Cup a owl:Class . dm:Spoon a owl:Class ; dm:spatial true ."
    assert {row.name: row.spatial for row in table(text, ()).rows} == {"Cup": False, "Spoon": True}
