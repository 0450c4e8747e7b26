"""The model of an entity is stated, or chosen by class, name and size."""

import pytest

from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commits import Edit, NewEntity, Statement, Transaction
from semmap.schemas.entities import Pose
from tests.kb_node import home

HERE = Pose(position_m=(1.0, 2.0, 0.0))


@pytest.fixture
def household(tmp_path):
    """An empty map with the shipped TBox."""
    made = SemanticMap(home.new_household_journal(tmp_path))
    yield made
    home.close(made)


def put(semantic_map, name, class_, size_m=None):
    star = entity_triples.describe(name, v.dm(class_), pose=HERE, size_m=size_m)
    semantic_map.commit(home.transaction(f"put {name}", star))
    return semantic_map.entity(name)


def edit(semantic_map, name, **fields):
    change = Edit(name=name, **fields)
    semantic_map.commit(Transaction(id=f"{semantic_map.seq} {name}", source="operator", edit=(change,)))
    return semantic_map.entity(name)


def said(semantic_map, name, model):
    return edit(semantic_map, name, set=(Statement(property="model", values=(model,)),))


def test_names_and_sizes_choose_among_the_models_of_a_class(household):
    assert put(household, "bottle1", "Bottle").model == "bottle"
    assert put(household, "spray_bottle1", "Bottle").model == "spray_bottle"
    assert put(household, "ball1", "Ball", (0.065, 0.065, 0.065)).model == "tennis_ball"
    assert put(household, "box1", "Box", (0.2, 0.2, 0.2)).model == "small_carton"
    assert put(household, "chair1", "Chair", (0.2, 0.2, 0.2)).model == "chair"


def test_a_stated_model_is_used_until_it_is_unset(household):
    put(household, "bottle1", "Bottle")
    stated = said(household, "bottle1", "spray_bottle")
    assert stated.model == "spray_bottle"
    assert stated.properties["model"] == "spray_bottle"
    assert stated.shape_provenance.commit == household.seq
    assert said(household, "bottle1", "/data/mine.obj").model == "/data/mine.obj"
    assert edit(household, "bottle1", size=(0.045, 0.09, 0.21)).model == "/data/mine.obj"
    taken = edit(household, "bottle1", unset=(Statement(property="model", values=()),))
    assert (taken.model, taken.properties) == ("flat_bottle", {})
    assert taken.shape_provenance.commit == household.seq


def test_a_new_size_may_change_the_model_and_a_move_does_not(household):
    before = put(household, "cup1", "Cup", (0.08, 0.11, 0.095))
    assert before.model == "cup"
    resized = edit(household, "cup1", size=(0.055, 0.075, 0.05))
    assert resized.model == "espresso_cup"
    moved = edit(household, "cup1", at=(3.0, 1.0, 0.5))
    assert (moved.model, moved.shape_provenance) == ("espresso_cup", resized.shape_provenance)
    assert moved.pose.position_m == (3.0, 1.0, 0.5)


def test_a_stated_model_survives_a_move_and_a_restart(household):
    put(household, "cup1", "Cup")
    said(household, "cup1", "tumbler")
    assert edit(household, "cup1", at=(3.0, 1.0, 0.5)).model == "tumbler"
    again = home.reopened(household)
    assert again.entity("cup1").model == "tumbler"
    home.close(again)


@pytest.mark.parametrize("model", ["spary_bottle", "", "no such model"])
def test_an_unknown_model_is_rejected(household, model):
    put(household, "bottle1", "Bottle")
    seq = household.seq
    with pytest.raises(errors.BadRequest, match="unknown model"):
        said(household, "bottle1", model)
    assert household.seq == seq


def test_at_most_one_model_can_be_stated(household):
    put(household, "cup1", "Cup")
    with pytest.raises(errors.BadRequest, match="one value at most"):
        edit(household, "cup1", set=(Statement(property="model", values=("tumbler", "cup")),))


def test_the_model_is_a_property_that_can_be_set(household):
    (row,) = (row for row in household.classes.property_table.rows() if row.name == "model")
    assert (row.kind, row.functional, row.range) == ("data", True, ("string",))


def test_a_tbox_without_models_has_no_such_property(semantic_map):
    assert "model" not in {row.name for row in semantic_map.classes.property_table.rows()}


def on(name, other):
    return (v.entity_iri(name), v.dm("isOn"), v.entity_iri(other))


def test_objects_are_measured_against_the_new_model_of_their_support(household):
    put(household, "can1", "Can")
    star = entity_triples.describe("apple1", v.dm("Apple"), pose=Pose(position_m=(1.0, 2.0, 0.12)))
    household.commit(home.transaction("apple", star))
    assert household.reasoner.holds(on("apple1", "can1"))
    said(household, "can1", "flat_can")
    assert not household.reasoner.holds(on("apple1", "can1"))
    edit(household, "can1", unset=(Statement(property="model", values=()),))
    assert household.reasoner.holds(on("apple1", "can1"))


def test_a_new_entity_may_have_a_stated_model(household):
    new = NewEntity(
        name="cup1",
        class_iri=v.bare(v.dm("Cup")),
        pose=HERE,
        set=(Statement(property="model", values=("tumbler",)),),
    )
    household.commit(Transaction(id="cup", source="operator", add=(new,)))
    assert household.entity("cup1").model == "tumbler"
