"""The surfaces of models that perception ships."""

from __future__ import annotations

import numpy as np
import pytest

from semmap.nodes.perception_node.fitting.model_surfaces import SHIPPED, shipped
from semmap.nodes.sim_node.models.library import build
from semmap.nodes.sim_node.models.model_table import MODELS
from semmap.nodes.training.model_surfaces import POINTS, library_models, surface_of
from semmap.nodes.training.taxonomy import class_of_models


def test_every_class_with_a_model_has_its_surface():
    assert set(shipped()) == set(class_of_models(MODELS).values()), "make shapes"


@pytest.mark.parametrize(("model", "class_"), [("cup", "Cup"), ("apple", "Apple"), ("book", "Book")])
def test_the_shipped_file_is_of_the_library_as_it_is(model, class_):
    now, then = surface_of(build(model, None)), shipped()[class_][0]
    assert now.fold == then.fold, "make shapes"
    np.testing.assert_allclose(now.size_m, then.size_m, atol=1e-6, err_msg="make shapes")
    np.testing.assert_allclose(now.points, then.points, atol=1e-4, err_msg="make shapes")


def test_a_class_has_its_usual_model_and_its_varieties():
    assert library_models()["Bottle"] == ["bottle", "flat_bottle", "spray_bottle", "wine_bottle"]
    assert library_models()["Box"][:2] == ["box", "cardboard_box"]
    have = {class_: len(models) for class_, models in shipped().items()}
    assert have == {class_: len(models) for class_, models in library_models().items()}, "make shapes"


def test_the_shipped_file_is_small():
    assert SHIPPED.stat().st_size < 500_000


def test_what_lies_within_another_part_is_not_on_the_surface():
    table = surface_of(build("table", None))
    assert len(table.points) == POINTS
    top = table.points[:, 2].max()
    legs = table.points[table.points[:, 2] < 0.7 * top]
    assert len(legs) > 20
    assert np.abs(legs[:, :2]).max(axis=1).min() > 0.2  # the legs are at the corners, and nothing between
