"""Search items of entities, and terms of a TBox."""

import pytest
from msgspec import structs

from semmap.nodes.kb_node.answers.search_vocabulary import item, terms
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Reasoner
from tests.kb_node.reasoner.graphs import household
from tests.kb_node.relations.entities import ROOM, TABLE


def test_an_entity_has_its_labels_and_property_values_as_search_terms():
    told = structs.replace(
        TABLE,
        alternative_references=("desk", ""),
        properties={"isOpen": True, "hasColor": ("color_red", "color_blue"), "isOwnedBy": "anna"},
    )
    found = item(told)
    assert (found.name, found.class_name, found.types, found.is_place) == (
        "table1",
        "Table",
        {"Table"},
        False,
    )
    assert found.references == ("kitchen table", "desk")
    assert found.values == {
        "isOpen": {True},
        "hasColor": {"color_red", "color_blue"},
        "isOwnedBy": {"anna"},
    }
    assert item(ROOM).is_place
    assert item(structs.replace(TABLE, preferred_reference=None)).references == ()


@pytest.fixture(scope="module")
def spoken():
    reasoner = Reasoner(household())
    return terms(reasoner, ClassTable(reasoner))


def test_classes_have_their_labels_in_every_language_and_their_names(spoken):
    assert {("en", "Fridge", "Fridge")} <= set(spoken.classes)
    assert {tag for tag, name, _ in spoken.classes if name == "Fridge"} >= {"en"}
    assert "Color" not in {name for _, name, _ in spoken.classes}


def test_qualities_are_distinguished_from_affordances(spoken):
    qualities = {name for _, name, _ in spoken.qualities}
    affordances = {name for _, name, _ in spoken.affordances}
    assert "color_red" in qualities
    assert affordances
    assert qualities.isdisjoint(affordances)


def test_a_class_has_the_affordances_that_the_tbox_states_for_it(spoken):
    assert spoken.affords
    names = {name for _, name, _ in spoken.affordances} | {"containing", "supporting", "grasping"}
    assert any(found & names for found in spoken.affords.values())
