"""The parts of an entity that relations depend on."""

import pytest
from msgspec import structs

from semmap.nodes.kb_node.relations.geometry.placed_entity import (
    PlacedEntity,
    extent_in,
    holder_in,
    joints_in,
    model_of,
    name_shape_source,
)
from semmap.ontology import model_shapes
from semmap.schemas.attachments import IS_GRASPED_BY
from semmap.schemas.polygons import EXTENT
from tests.kb_node.relations.entities import PROVENANCE, thing

SQUARE = "POLYGON ((0 0, 1 0, 1 1, 0 1, 0 0))"
FRIDGE = thing("fridge1", (1.0, 2.0, 0.0))
ROOM = structs.replace(
    thing("room1", (0.0, 0.0, 0.0), size=(1.0, 1.0, 2.0), place=True), properties={EXTENT: SQUARE}
)


@pytest.fixture
def world(monkeypatch):
    shape = model_shapes.ModelShape(size_m=FRIDGE.size_m)
    monkeypatch.setattr(model_shapes, "_world", model_shapes.WorldShapes.of({"fridge1": shape}))


def test_the_parts_of_an_entity_are_kept():
    found = PlacedEntity.of(structs.replace(FRIDGE, fixed=True, properties={"openness": 0.5}))
    assert (found.name, found.iri, found.pose, found.size_m) == (
        "fridge1",
        "urn:fridge1",
        FRIDGE.pose,
        FRIDGE.size_m,
    )
    assert (found.model, found.place, found.fixed, found.extent, found.held_by) == (
        "fridge",
        False,
        True,
        "",
        "",
    )
    assert any(found.joints)
    again = (model_of(found), extent_in(found), holder_in(found), joints_in(found))
    assert again == (found.model, found.extent, found.held_by, found.joints)


def test_only_a_place_has_a_polygon():
    assert extent_in(ROOM) == PlacedEntity.of(ROOM).extent == extent_in(PlacedEntity.of(ROOM)) == SQUARE
    assert extent_in(structs.replace(FRIDGE, properties={EXTENT: SQUARE})) == ""
    assert extent_in(structs.replace(ROOM, properties={EXTENT: (SQUARE, SQUARE)})) == ""
    assert extent_in(structs.replace(ROOM, properties={})) == ""


def test_an_entity_is_attached_if_its_attachment_is_asserted():
    held = structs.replace(FRIDGE, properties={IS_GRASPED_BY: "gripper1"}, grip_provenance=PROVENANCE)
    assert holder_in(held) == holder_in(PlacedEntity.of(held)) == "gripper1"
    assert holder_in(structs.replace(held, grip_provenance=None)) == ""
    assert holder_in(FRIDGE) == ""


def test_joints_are_as_drawn_unless_the_map_states_them():
    assert joints_in(FRIDGE) == ()
    opened = joints_in(structs.replace(FRIDGE, properties={"openness": 1.0}))
    assert opened
    assert all(position > 1.5 for position in opened)
    assert joints_in(structs.replace(FRIDGE, size_m=None, properties={"openness": 1.0})) == opened
    assert joints_in(structs.replace(FRIDGE, properties={"color": "red"})) == ()


@pytest.mark.usefixtures("world")
def test_the_body_of_the_world_file_stands_for_the_entity_of_its_name_and_size():
    assert model_shapes.shape_named(model_of(FRIDGE)).size_m == FRIDGE.size_m
    assert model_of(FRIDGE) != "fridge"
    assert name_shape_source(FRIDGE) == "world"
    assert model_of(structs.replace(FRIDGE, name="fridge2")) == "fridge"
    assert model_of(structs.replace(FRIDGE, size_m=(9.0, 9.0, 9.0))) == "fridge"
    assert model_of(structs.replace(FRIDGE, place=True)) == "fridge"


@pytest.mark.parametrize(("model", "source"), [("fridge", "model"), ("unheard of", "box"), ("", "box")])
def test_a_shape_is_from_its_model_or_its_size(model, source):
    assert name_shape_source(structs.replace(FRIDGE, model=model)) == source


def test_a_place_has_no_shape():
    assert name_shape_source(ROOM) == ""
