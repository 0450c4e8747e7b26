import json

import pytest

from nodes.sim_node.models.library import build
from nodes.sim_node.models.spaces import shape_of
from nodes.sim_node.models.variety_table import KINDS
from nodes.sim_node.models.write_shapes import as_json, library_shapes
from ontology import MODEL_SHAPES_JSON


def heights(model):
    return [round(surface.height, 2) for surface in shape_of(build(model, None)).surfaces]


@pytest.mark.long
def test_the_file_is_what_the_models_say():
    assert MODEL_SHAPES_JSON.read_text() == as_json(library_shapes()), "make shapes"


def test_the_file_is_what_some_models_of_each_kind_say():
    text = MODEL_SHAPES_JSON.read_text()
    assert json.loads(text).keys() == {"", *KINDS}
    for name in ("", "table", "bookshelf", "fridge", "chair", "bowl", "cup", "apple", "door", "clock"):
        (row,) = as_json({name: shape_of(build(name, None))}).splitlines()[1:-1]
        assert row in text, "make shapes"


@pytest.mark.parametrize(
    ("model", "expected"),
    [("table", [0.75]), ("bookshelf", [1.8, 1.44, 1.09, 0.73, 0.38, 0.03]), ("chair", [0.88, 0.67, 0.45])],
)
def test_surfaces_are_where_a_person_would_put_things(model, expected):
    assert heights(model) == pytest.approx(expected, abs=0.02)


def test_hollows():
    (inside,) = shape_of(build("bowl", None)).interiors
    assert inside.open
    assert inside.low[2] < 0.02
    assert shape_of(build("table", None)).interiors == ()
    assert shape_of(build("apple", None)).interiors == ()


def test_a_plain_box_carries_with_all_of_its_top():
    (top,) = shape_of(build("", (0.4, 0.6, 0.3))).surfaces
    assert top.height == pytest.approx(0.3)
    assert top.high[0] - top.low[0] == pytest.approx(0.4, abs=0.02)
    assert top.fill == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("model", "behind"),
    [
        ("fridge", {("door",), ("freezer",)}),
        ("cabinet", {("left", "right")}),
        ("wardrobe", {("left", "right")}),
        ("oven", {("door",)}),
        ("washing_machine", {("door",)}),
        ("bin", {("lid",)}),
        ("cardboard_box", {("left", "right")}),
        ("suitcase", {("lid",)}),
        ("drawer", {("drawer_1",), ("drawer_2",), ("drawer_3",), ("drawer_4",)}),
        ("bowl", {()}),
    ],
)
def test_a_hollow_says_what_closes_it(model, behind):
    assert {room.behind for room in shape_of(build(model, None)).interiors} == behind


@pytest.mark.parametrize("model", ["drawer", "desk"])
def test_a_drawer_carries_what_is_in_its_tray(model):
    shape = shape_of(build(model, None))
    for leaf in shape.leaves:
        (tray,) = leaf.interiors
        (room,) = (room for room in shape.interiors if leaf.name in room.behind)
        assert all(low >= least - 0.02 for low, least in zip(tray.low, room.low, strict=True))
        assert all(high <= most + 0.02 for high, most in zip(tray.high, room.high, strict=True))
        assert tray.high[2] == pytest.approx(room.high[2])
        assert any(shape.surfaces[k].height == pytest.approx(tray.low[2], abs=0.01) for k in leaf.surfaces)
