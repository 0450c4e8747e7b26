"""Antecedents of pronouns."""

import pytest

from semmap.nodes.language.understanding.grounding import Thing
from semmap.nodes.language.understanding.interpretation import shipped
from tests.language.household import there

THINGS = (
    Thing("kitchen1", "Kitchen", ("kitchen",), (6.0, 1.0, 0.0)),
    Thing("fridge1", "Fridge", (), (6.0, 0.0, 0.0), ("Openable_Thing", "Containing_Thing")),
    Thing("oven1", "Oven", (), (7.0, 0.0, 0.0), ("Openable_Thing", "Switchable_Thing", "Containing_Thing")),
    Thing("milk1", "Milk", (), (6.0, 0.1, 0.5), ("Graspable_Thing",)),
    Thing("pizza1", "Pizza", (), (6.0, 2.0, 0.7)),
    Thing("table1", "Table", (), (6.0, 2.0, 0.0), ("Supporting_Thing",)),
)


def of_last(text, things=THINGS):
    """The entities of the last frame."""
    return [a.entity for a in shipped().understand(text, there(things)).frames[-1].arguments]


@pytest.mark.parametrize(
    ("text", "entities"),
    [
        ("put the milk in the fridge and close it", ["fridge1"]),
        ("put the fridge near the milk and close it", ["fridge1"]),
        ("open the fridge, take the milk and close it", ["fridge1"]),
        ("open the fridge, take the milk and put it on the table", ["milk1", "table1"]),
        ("take the milk from the fridge and bring it to the kitchen", ["milk1", "kitchen1"]),
        ("open the oven and put the pizza in it", ["pizza1", "oven1"]),
        ("go to the kitchen and take it", [None]),  # places are not carried
        ("take the milk and close it", ["milk1"]),  # the only candidate
        ("metti il latte nel frigo e chiudilo", ["fridge1"]),
    ],
)
def test_what_suits_is_meant(text, entities):
    assert of_last(text) == entities


def test_without_what_things_afford_the_last_acted_on_is_meant():
    things = tuple(Thing(t.name, t.class_name, t.references, t.at) for t in THINGS)
    assert of_last("put the milk in the fridge and close it", things) == ["milk1"]


def test_what_may_be_several_may_be_several_again_and_them_are_all():
    cups = (*THINGS, Thing("cup1", "Cup"), Thing("cup2", "Cup"))
    placed = shipped().understand("take the cup and put it on the table", there(cups)).frames[-1]
    assert (placed.arguments[0].candidates, placed.arguments[0].ambiguous) == (("cup1", "cup2"), True)
    text = "take the milk and the pizza and put them on the table"
    placed = shipped().understand(text, there(THINGS), resolve=lambda _: ()).frames[-1]
    assert (placed.arguments[0].candidates, placed.arguments[0].ambiguous) == (("milk1", "pizza1"), False)
