"""Objects in closed containers are not observable, and since when."""

import re

import pytest

from semmap.nodes.kb_node.answers.closed_containers import describe, find_closed_container
from semmap.ontology import vocabulary as v
from semmap.schemas.commits import Edit, NewEntity, Statement, Transaction
from semmap.schemas.entities import Pose
from tests.kb_node import home


@pytest.fixture
def kitchen(tmp_path):
    """Milk in a fridge, and a cup on the floor next to it."""
    made = home.new_map(tmp_path, home.household())
    at = {"fridge1": (0.0, 0.0, 0.0), "carton1": (-0.1, 0.0, 0.645), "cup1": (2.0, 0.0, 0.0)}
    classes = {"fridge1": "Fridge", "carton1": "Milk", "cup1": "Cup"}
    new = tuple(
        NewEntity(name=name, class_iri=v.bare(v.dm(classes[name])), pose=Pose(position_m=at[name]))
        for name in at
    )
    made.commit(Transaction(id="1", source="operator", add=new))
    yield made
    home.close(made)


def say(kitchen, number, value, property_="isOpen", name="fridge1"):
    edit = Edit(name=name, set=(Statement(property=property_, values=(value,)),))
    kitchen.commit(Transaction(id=str(number), source="operator", edit=(edit,)))


def test_a_fridge_without_a_stated_door_state_is_not_reported_as_closed(kitchen):
    assert find_closed_container(kitchen, kitchen.entity("carton1")) is None


def test_milk_in_a_closed_fridge_is_not_observable_since_it_was_closed(kitchen):
    say(kitchen, 2, "false")
    closed = find_closed_container(kitchen, kitchen.entity("carton1"))
    assert closed is not None
    said = r"not observable: fridge1 has been closed since commit 2, \d+ s ago"
    assert re.fullmatch(said, describe(closed))
    assert find_closed_container(kitchen, kitchen.entity("cup1")) is None
    assert find_closed_container(kitchen, kitchen.entity("fridge1")) is None


def test_it_is_observable_once_the_fridge_is_open(kitchen):
    say(kitchen, 2, "false")
    say(kitchen, 3, "true")
    assert find_closed_container(kitchen, kitchen.entity("carton1")) is None


def test_an_open_door_shows_only_what_is_behind_it(kitchen):
    milk = kitchen.entity("carton1")
    edit = Edit(
        name="fridge1",
        set=(
            Statement(property="isOpen", values=("true",)),
            Statement(property="jointPositions", values=("door=0 freezer=1.5",)),
        ),
    )
    kitchen.commit(Transaction(id="2", source="scene", edit=(edit,)))
    assert find_closed_container(kitchen, milk) == (kitchen.entity("fridge1"), ("door",))
    edit = Edit(name="fridge1", set=(Statement(property="jointPositions", values=("door=1 freezer=0",)),))
    kitchen.commit(Transaction(id="3", source="scene", edit=(edit,)))
    assert find_closed_container(kitchen, milk) is None


def test_only_the_contents_of_an_open_drawer_of_a_chest_are_observable(tmp_path):
    made = home.new_map(tmp_path, home.household())
    at = {"chest1": (0.0, 0.0, 0.0), "apple1": (0.05, 0.0, 0.72), "apple2": (0.05, 0.0, 0.51)}
    classes = {"chest1": "Drawer", "apple1": "Apple", "apple2": "Apple"}
    new = tuple(
        NewEntity(name=name, class_iri=v.bare(v.dm(classes[name])), pose=Pose(position_m=at[name]))
        for name in at
    )
    made.commit(Transaction(id="1", source="operator", add=new))
    edits = (
        Edit(
            name="chest1",
            set=(
                Statement(property="isOpen", values=("true",)),
                Statement(property="jointPositions", values=("drawer_1=0.24 drawer_2=0",)),
            ),
        ),
        Edit(name="apple1", at=(0.29, 0.0, 0.72)),
    )
    made.commit(Transaction(id="2", source="scene", edit=edits))
    try:
        assert find_closed_container(made, made.entity("apple1")) is None
        closed = find_closed_container(made, made.entity("apple2"))
        assert closed == (made.entity("chest1"), ("drawer_2",))
        assert "not observable: drawer_2 of chest1 is closed (last stated in commit 2" in describe(closed)
        say(made, 3, "false", name="chest1")
        made.commit(Transaction(id="4", source="scene", edit=(Edit(name="apple1", at=(0.05, 0.0, 0.72)),)))
        assert find_closed_container(made, made.entity("apple1")) == (made.entity("chest1"), ())
    finally:
        home.close(made)
