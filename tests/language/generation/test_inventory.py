"""The things of a map as groups by place, each with what is on, in and round them."""

from __future__ import annotations

import pytest

from semmap.nodes.language.generation.inventory import Inventory, Place, Thing

PLACES = (
    Place("flat1", "flat"),
    Place("kitchen1", "kitchen", "flat1"),
    Place("corner1", "corner", "kitchen1"),
    Place("corner2", "corner", "flat1"),
    Place("garden1", "garden"),
)


def phrases(groups):
    return [group.phrase for group in groups]


def standing(*things, place=None):
    return phrases(Inventory(things, PLACES).standing_in(place))


def test_similar_things_in_one_place_are_one_group():
    things = (
        Thing("cup1", "cup", place="kitchen1"),
        Thing("cup2", "cup", place="kitchen1"),
        Thing("lamp1", "lamp", "switched on", "kitchen1"),
        Thing("lamp2", "lamp", "switched off", "kitchen1"),
        Thing("cup3", "cup", place="flat1"),
        Thing("cup4", "cup", place="cellar1"),
        Thing("cup5", "cup"),
    )
    assert standing(*things, place="kitchen1") == [
        "2 cups",
        "a lamp that is switched off",
        "a lamp that is switched on",
    ]
    assert standing(*things, place="flat1") == ["a cup"]
    assert standing(*things) == ["2 cups"]  # an unknown place is none
    assert standing(*things, place="garden1") == []


def test_a_group_has_its_phrases_and_counts():
    inventory = Inventory(
        [
            *(Thing(f"table{n}", "table") for n in (1, 2)),
            Thing("cup1", "cup", at=("on", "table1")),
            Thing("sugar1", "sugar lump", at=("in", "cup1")),
        ]
    )
    (tables,) = inventory.standing_in(None)
    assert (tables.phrase, tables.definite, tables.is_plural, tables.all) == (
        "2 tables",
        "the 2 tables",
        True,
        4,
    )
    (cup,) = tables.load["on"]
    assert (cup.phrase, cup.definite, cup.is_plural, cup.all) == ("a cup", "the cup", False, 2)


def test_groups_with_a_load_come_first_then_large_ones_and_parts_of_the_building_last():
    things = (
        Thing("door1", "door", volume_m3=2.0, fixed=True),
        Thing("pin1", "pin", volume_m3=0.001),
        Thing("pen1", "pen", volume_m3=0.001),
        Thing("wardrobe1", "wardrobe", volume_m3=0.9),
        Thing("tray1", "tray", volume_m3=0.002),
        Thing("cup1", "cup", at=("on", "tray1")),
        Thing("shelf1", "shelf", volume_m3=0.1, fixed=True),
        Thing("book1", "book", at=("on", "shelf1")),
    )
    assert standing(*things) == ["a shelf", "a tray", "a wardrobe", "a pen", "a pin", "a door"]


def test_a_load_is_listed_round_on_and_in_a_thing():
    inventory = Inventory(
        [
            Thing("table1", "table"),
            Thing("drawer1", "knife", at=("in", "table1")),
            Thing("cup1", "cup", at=("on", "table1")),
            Thing("chair1", "chair", at=("round", "table1")),
        ]
    )
    load = inventory.at("table1")
    assert {how: phrases(groups) for how, groups in load.items()} == {
        "round": ["a chair"],
        "on": ["a cup"],
        "in": ["a knife"],
    }
    assert list(load) == ["round", "on", "in"]
    assert inventory.at("cup1") == {}


@pytest.mark.parametrize(
    "things",
    [
        (Thing("cup1", "cup", at=("on", "gone1")),),
        (Thing("cup1", "cup", at=("on", "cup1")),),
        (Thing("box1", "cup", at=("in", "box2")), Thing("box2", "cup", at=("in", "box1"))),
    ],
    ids=["a support that does not exist", "itself", "a circle"],
)
def test_a_thing_without_a_real_support_stands_in_its_place(things):
    inventory = Inventory(things)
    (group,) = inventory.standing_in(None)
    assert len(group.things) == len(things)


def test_a_stack_is_followed_to_its_foot_unless_it_is_absurdly_high():
    def in_stack(height):
        above = (Thing(f"box{n}", "box", at=("on", f"box{n - 1}")) for n in range(1, height))
        return Inventory([Thing("box0", "box"), *above]).standing_in(None)

    (group,) = in_stack(20)
    assert (len(group.things), group.all) == (1, 20)
    (group,) = in_stack(60)
    assert group.all == 60
    assert len(group.things) > 1  # those above the limit stand beside it


def test_things_in_a_place_are_also_those_on_others_and_not_those_in_its_parts():
    things = (
        Thing("table1", "table", place="kitchen1"),
        Thing("cup1", "cup", place="kitchen1", at=("on", "table1")),
        Thing("chair1", "chair", place="corner1"),
    )
    inventory = Inventory(things, PLACES)
    assert [thing.name for thing in inventory.in_place("kitchen1")] == ["table1", "cup1"]


def test_things_in_sum_are_grouped_by_kind_the_most_frequent_first():
    things = (
        Thing("mug1", "mug", kind="cup", place="kitchen1"),
        Thing("cup1", "cup", place="flat1"),
        Thing("table1", "table"),
        Thing("armchair1", "armchair", state="broken"),
    )
    inventory = Inventory(things, PLACES)
    assert phrases(inventory.in_sum(things)) == ["2 cups", "an armchair", "a table"]


def test_a_place_has_its_name_only_if_the_word_is_that_of_several():
    inventory = Inventory((), PLACES)
    assert inventory.the("kitchen1") == "the kitchen"
    assert inventory.the("corner2") == "the corner corner2"


def test_a_place_is_followed_by_its_parts_and_comes_itself_after_them_if_it_is_outermost():
    inventory = Inventory((), PLACES)
    assert inventory.parts_of("flat1") == ["flat1", "corner2", "kitchen1", "corner1"]
    assert inventory.parts_of("corner1") == ["corner1"]
    assert inventory.places_in_order() == ["corner2", "kitchen1", "corner1", "flat1", "garden1"]
    unsorted = Inventory(
        (), (Place("a1", "room", "flat1"), Place("flat1", "flat"), Place("lost1", "room", "x"))
    )
    assert unsorted.places_in_order() == ["a1", "flat1", "lost1"]


def test_places_that_are_within_each_other_are_each_listed_once():
    circle = (Place("a1", "room", "b1"), Place("b1", "room", "a1"))
    inventory = Inventory((), circle)
    assert inventory.parts_of("a1") == ["a1", "b1"]
    assert sorted(inventory.places_in_order()) == ["a1", "b1"]
