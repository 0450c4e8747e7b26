"""Shapes of entities are requested once."""

import msgspec
import pytest
from msgspec import structs

from semmap.nodes.extern.ros.shapes import ShapeTable
from semmap.ontology.model_shapes import ModelShape, WorldShapes
from semmap.schemas import errors
from semmap.schemas.bridge import FoundShapes
from tests.recorder.messages import entity

SHAPE = ModelShape(size_m=(1.0, 1.0, 1.0))


def reply(**by_name):
    shapes = {"0": SHAPE}
    bodies = {name: (number,) for name, number in by_name.items()}
    return FoundShapes(content=msgspec.json.encode(WorldShapes(shapes, bodies)))


def test_each_is_requested_once_and_places_are_not():
    table, chair, room = ShapeTable(), entity("chair1"), entity("room1", place=True)
    (query,) = table.queries([chair, room])
    assert [key.name for key in query.keys] == ["chair1"]
    assert table.of(chair) is None
    assert not [*table.queries([chair])]
    table.take(query, reply(chair1="0"))
    assert table.of(chair) == SHAPE
    assert not [*table.queries([structs.replace(chair, preferred_reference="red chair")])]


def test_another_size_or_an_open_door_is_another_shape():
    table, fridge = ShapeTable(), entity("fridge1")
    (query,) = table.queries([fridge])
    table.take(query, reply())
    assert table.of(fridge) is None
    for changed in (
        structs.replace(fridge, size_m=(1.0, 1.0, 2.0)),
        structs.replace(fridge, properties={"isOpen": True}),
    ):
        assert [*table.queries([changed])]


def test_a_failed_request_is_repeated():
    table, chair = ShapeTable(), entity("chair1")
    (query,) = table.queries([chair])
    table.forget(query.keys)
    assert [*table.queries([chair])] == [query]


def test_all_shapes_are_requested_again_after_a_reset():
    table, chair = ShapeTable(), entity("chair1")
    (query,) = table.queries([chair])
    table.take(query, reply(chair1="0"))
    table.reset()
    assert table.of(chair) == SHAPE
    (again,) = table.queries([chair])
    table.take(again, reply())
    assert table.of(chair) is None


def test_an_invalid_reply_is_reported():
    (query,) = (table := ShapeTable()).queries([entity("chair1")])
    with pytest.raises(errors.InternalError, match="shapes from kb_node"):
        table.take(query, FoundShapes(content=b"[]"))
