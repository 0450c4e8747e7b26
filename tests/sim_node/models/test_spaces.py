import json

import pytest

from nodes.sim_node.models.library import build
from nodes.sim_node.models.model_table import MODELS
from nodes.sim_node.models.spaces import shape_of
from nodes.sim_node.models.write_shapes import as_json, library_shapes
from ontology import MODEL_SHAPES_JSON


def heights(model):
    return [round(surface.height, 2) for surface in shape_of(build(model, None)).surfaces]


@pytest.mark.long
def test_the_file_is_what_the_models_say():
    assert MODEL_SHAPES_JSON.read_text() == as_json(library_shapes()), "make shapes"


def test_the_file_is_what_some_models_of_each_kind_say():
    text = MODEL_SHAPES_JSON.read_text()
    assert json.loads(text).keys() == {"", *MODELS}
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
