"""A model's shape stretched and turned to the size of an entity."""

from __future__ import annotations

import math

import numpy as np
import pytest

from semmap.nodes.kb_node.relations.geometry import fitting
from semmap.nodes.kb_node.relations.geometry.fitting import box, fit_model, need_quarter_turn, turn_quarter
from semmap.ontology.model_shapes import ConvexPart, Interior, LeafShape, ModelShape, Surface

HOLLOW = Interior(low=(-0.4, -0.1, 0.1), high=(0.3, 0.2, 0.5), behind=("door",), open=False)
DRAWER = Interior(low=(-0.1, -0.2, 0.2), high=(0.1, 0.2, 0.3), carried_by="drawer")
HINGE = LeafShape(
    name="door",
    kind="hinge",
    anchor=(0.5, 0.2, 0.1),
    axis=(0.0, 0.0, 1.0),
    limits=(0.0, 1.5),
    closed=0.0,
    parts=(1,),
)
SLIDE = LeafShape(
    name="drawer",
    kind="slide",
    anchor=(0.1, 0.0, 0.3),
    axis=(1.0, 0.0, 0.0),
    limits=(-0.1, 0.4),
    closed=0.05,
    interiors=(DRAWER,),
)
CUPBOARD = ModelShape(
    size_m=(1.0, 0.5, 0.8),
    surfaces=(Surface(height=0.8, low=(-0.5, -0.25), high=(0.4, 0.2), fill=0.7),),
    interiors=(HOLLOW,),
    parts=(
        ConvexPart(centre=(0.1, 0.05, 0.4), straight=((0.2, 0.0, 0.0),), round=((0.0, 0.1, 0.0),)),
        ConvexPart(centre=(0.5, 0.0, 0.4), points=((0.01, 0.2, 0.3), (-0.01, -0.2, -0.3))),
    ),
    leaves=(HINGE, SLIDE),
)
TWICE = (2.0, 1.5, 0.4)
"""The cupboard with its sides multiplied by 2, 3 and 0.5."""


@pytest.fixture
def cupboard(monkeypatch):
    monkeypatch.setattr(fitting, "model_shape", {"cupboard": CUPBOARD}.get)
    fit_model.cache_clear()
    yield
    fit_model.cache_clear()


@pytest.mark.usefixtures("cupboard")
class TestFitting:
    """An entity that has a model."""

    def test_a_model_at_its_own_size_is_as_it_is(self):
        assert fit_model("cupboard", CUPBOARD.size_m) == CUPBOARD

    def test_surfaces_and_hollows_are_stretched_along_each_axis(self):
        found = fit_model("cupboard", TWICE)
        assert found.size_m == TWICE
        (surface,), (hollow,) = found.surfaces, found.interiors
        assert (surface.height, surface.fill) == (pytest.approx(0.4), 0.7)
        assert (*surface.low, *surface.high) == pytest.approx((-1.0, -0.75, 0.8, 0.6))
        assert hollow.low == pytest.approx((-0.8, -0.3, 0.05))
        assert hollow.high == pytest.approx((0.6, 0.6, 0.25))
        assert (hollow.behind, hollow.open) == (("door",), False)

    def test_parts_are_stretched_with_their_centres(self):
        first, second = fit_model("cupboard", TWICE).parts
        assert first.centre == pytest.approx((0.2, 0.15, 0.2))
        assert first.straight == (pytest.approx((0.4, 0.0, 0.0)),)
        assert first.round == (pytest.approx((0.0, 0.3, 0.0)),)
        assert second.points == (pytest.approx((0.02, 0.6, 0.15)), pytest.approx((-0.02, -0.6, -0.15)))

    def test_a_hinge_keeps_its_angles_and_a_slide_changes_its_travel(self):
        door, drawer = fit_model("cupboard", TWICE).leaves
        assert door.anchor == pytest.approx((1.0, 0.6, 0.05))
        assert (door.axis, door.limits, door.closed) == ((0.0, 0.0, 1.0), (0.0, 1.5), 0.0)
        assert drawer.anchor == pytest.approx((0.2, 0.0, 0.15))
        assert drawer.axis == pytest.approx((1.0, 0.0, 0.0))
        assert drawer.limits == pytest.approx((-0.2, 0.8))
        assert drawer.closed == pytest.approx(0.1)
        assert drawer.interiors[0].low == pytest.approx((-0.2, -0.6, 0.1))

    def test_the_axis_of_a_slanted_slide_keeps_its_length(self, monkeypatch):
        slanted = LeafShape(name="flap", kind="slide", anchor=(0.0, 0.0, 0.0), axis=(0.6, 0.8, 0.0))
        monkeypatch.setattr(
            fitting, "model_shape", {"desk": ModelShape(size_m=(1.0, 0.5, 0.8), leaves=(slanted,))}.get
        )
        (found,) = fit_model("desk", TWICE).leaves
        assert math.hypot(*found.axis) == pytest.approx(1.0)
        assert found.axis[1] / found.axis[0] == pytest.approx(3 * 0.8 / (2 * 0.6))
        assert (found.limits, found.closed) == (None, None)

    def test_a_model_is_turned_if_the_entity_is_longer_across(self):
        found = fit_model("cupboard", (0.5, 1.0, 0.8))
        assert found == turn_quarter(CUPBOARD)

    def test_a_turned_model_is_stretched_along_the_axes_of_the_entity(self):
        found = fit_model("cupboard", (1.5, 2.0, 0.8))
        assert found.size_m == (1.5, 2.0, 0.8)
        assert found.parts[0].centre == pytest.approx((3 * 0.05, 2 * -0.1, 0.4))


def test_a_quarter_turn_maps_x_to_the_negative_y_axis():
    found = turn_quarter(CUPBOARD)
    assert found.size_m == (0.5, 1.0, 0.8)
    (surface,), (hollow,) = found.surfaces, found.interiors
    assert (surface.low, surface.high) == ((-0.25, -0.4), (0.2, 0.5))
    assert (surface.height, surface.fill) == (0.8, 0.7)
    assert (hollow.low, hollow.high) == ((-0.1, -0.3, 0.1), (0.2, 0.4, 0.5))
    assert found.parts[0].centre == (0.05, -0.1, 0.4)
    assert found.parts[0].straight == ((0.0, -0.2, 0.0),)
    assert found.parts[1].points[0] == (0.2, -0.01, 0.3)
    door, drawer = found.leaves
    assert (door.anchor, door.axis, door.limits) == ((0.2, -0.5, 0.1), (0.0, 0.0, 1.0), (0.0, 1.5))
    assert drawer.axis == (0.0, -1.0, 0.0)
    assert drawer.interiors[0].low == (-0.2, -0.1, 0.2)


def test_four_quarter_turns_are_none():
    found = CUPBOARD
    for _ in range(4):
        found = turn_quarter(found)
    assert found == CUPBOARD


def needs_turn(model_xy, xy, *, turns=True):
    shape = ModelShape(size_m=(*model_xy, 1.0), turns=turns)
    return bool(need_quarter_turn(shape, np.array([(*xy, 1.0)]))[0])


def test_only_a_clearly_oblong_model_is_turned():
    assert needs_turn((1.0, 0.5), (0.5, 1.0))
    assert needs_turn((0.5, 1.0), (1.0, 0.5))
    assert not needs_turn((1.0, 0.5), (1.0, 0.5))
    assert not needs_turn((1.0, 0.5), (1.0, 1.0))
    assert not needs_turn((1.0, 0.8), (0.5, 1.0))
    assert not needs_turn((1.0, 0.5), (0.5, 1.0), turns=False)


@pytest.mark.parametrize("model", ["", "unheard of"])
def test_without_a_model_the_whole_box_is_the_part_and_its_top_the_surface(model):
    found = fit_model(model, (0.4, 0.2, 1.0))
    assert found == box((0.4, 0.2, 1.0))
    assert found.size_m == (0.4, 0.2, 1.0)
    (surface,), (part,) = found.surfaces, found.parts
    assert (surface.height, surface.low, surface.high, surface.fill) == (1.0, (-0.2, -0.1), (0.2, 0.1), 1.0)
    assert part.centre == (0.0, 0.0, 0.5)
    assert part.straight == ((0.2, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.5))
