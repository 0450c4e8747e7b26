"""Classes of bodies from the words of their names."""

from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from semmap.nodes.sim_node.body_classes import BodyClasses, Found
from tests.household import household_classes

TABLE = Path(__file__).with_name("body_names.txt")


@cache
def household() -> BodyClasses:
    return BodyClasses(household_classes())


def rows() -> Iterator[tuple[str, set[str]]]:
    """Yield the names of the table, each with the classes that are right."""
    for line in TABLE.read_text("utf-8").splitlines():
        if line and not line.startswith("#"):
            name, _, classes = line[2:].rpartition(" | ")
            yield name, set(classes.split("|"))


@pytest.mark.parametrize(("name", "classes"), list(rows()))
def test_names_of_published_worlds_have_the_class_that_a_person_gives_them(name, classes):
    assert household().find(name).class_ in classes


def test_most_names_of_published_worlds_have_a_class():
    known = [name for name, classes in rows() if "Object" not in classes]
    assert len(known) > 110
    assert [name for name in known if not household().find(name).is_sure] == []


@pytest.mark.parametrize(
    ("name", "label"),
    [
        ("chair_3", ""),
        ("DiningTable_01", ""),
        ("Apple|+01.2", ""),
        ("red_mug", "red mug"),
        ("mug 2", "mug"),
        ("akita_black_bowl_1_main", "akita black bowl"),
        ("KitchenCabinet_3_right", "kitchen cabinet"),
        ("iPhone", "iphone"),
        ("red_4d2f_mug", "red mug"),  # a hash of a converter is not a word
        ("red_mug_4d2f_1", "red mug"),
        ("tazza_rossa_1", "tazza rossa"),
        ("mug_red_2", "red mug"),
        ("cushion_blue", "blue cushion"),
        ("wooden_board_big", "big wooden board"),
        ("kettle_electric_1", ""),
        ("desk_caddy_1", "desk caddy"),
        ("obj_main", ""),
        ("12", ""),
    ],
)
def test_the_words_of_a_name_are_its_label_unless_they_are_that_of_its_class(name, label):
    assert household().find(name).label == label


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("chair_3", "chair"),
        ("chair", "chair"),
        ("side-table-12", "side-table"),
        ("mug__", "mug"),
        ("12", None),
    ],
)
def test_without_classes_a_name_without_its_number_is_the_class(name, expected):
    assert BodyClasses().find(name) == Found(expected, is_sure=True)


def test_a_tbox_without_objects_has_no_class_for_unknown_ones():
    bowls = BodyClasses(c for c in household_classes() if c.name == "Bowl")
    assert bowls.find("black_bowl_1").class_ == "Bowl"
    assert bowls.find("desk_caddy_1") == Found(None, is_sure=False, label="desk caddy")


@pytest.mark.parametrize("key", ["desk_caddy", "desk_caddy_1", "Desk Caddy"])
def test_the_class_map_has_names_with_or_without_numbers(key):
    mapped = BodyClasses(household_classes(), {key: "Basket"})
    assert mapped.find("desk_caddy_1") == Found("Basket", is_sure=True, label="desk caddy", is_stated=True)
    assert mapped.find("caddy_1").class_ == "Object"


def test_the_class_map_overrides_a_word():
    mapped = BodyClasses(household_classes(), {"moka_pot": "Coffee_Machine"})
    assert mapped.find("moka_pot_2").class_ == "Coffee_Machine"


@pytest.mark.parametrize(
    ("name", "whole", "is_entity"),
    [
        ("red_mug", "coffee_table", True),
        ("sink_1", "counter_1", True),
        ("door", "wardrobe_1", False),
        ("drawer_top", "wooden_cabinet_1", False),
        ("shelf_2", "fridge", False),
        ("door", "wall_1", True),
        ("door_3", "kitchen", True),
        ("door", "scene", True),
        ("leaf", "wardrobe_1", False),
        ("camera", "robot1", False),
        ("robot0_camera", "table_1", False),
        ("cup_link", "scene", False),
        ("bathroom", "scene", False),
    ],
)
def test_a_nested_body_is_an_entity_if_its_class_is_certain_and_not_a_part(name, whole, is_entity):
    found, around = household().find(name), household().find(whole)
    assert household().is_separate(name, found, whole, around, moves=False) is is_entity


@pytest.mark.parametrize(
    ("name", "whole", "moves", "is_entity"),
    [
        ("dresser_drawer_1", "Dresser_HEMNES", True, False),
        ("dresser_drawer_1", "Dresser_HEMNES", False, True),
        ("drawer_unit_tray_0", "drawer_unit", True, False),
        ("mug_2", "drawer_unit", True, True),
        ("wooden_cabinet_1_cabinet_top", "wooden_cabinet_1_main", True, False),
        ("cabinet_1_base", "cabinet_1", False, False),
        ("cabinet_2", "cabinet_1", False, True),
        ("cabinet_10", "cabinet_1", False, True),
    ],
)
def test_a_body_named_after_its_whole_is_a_part_of_it(name, whole, moves, is_entity):
    found, around = household().find(name), household().find(whole)
    assert household().is_separate(name, found, whole, around, moves=moves) is is_entity


def test_a_nested_body_of_the_class_map_is_an_entity():
    mapped = BodyClasses(household_classes(), {"door": "Door"})
    assert mapped.is_separate(
        "door", mapped.find("door"), "wardrobe_1", mapped.find("wardrobe_1"), moves=True
    )
