"""Extents and outlines of shapes at an orientation."""

from __future__ import annotations

import math

import pytest

from semmap.nodes.geometry.polygons import area
from semmap.nodes.kb_node.relations.geometry.forms import RegionForm, form_of, region_form
from semmap.schemas.entities import IDENTITY, orientation_from_yaw
from semmap.schemas.polygons import read_wkt

SIZE = (0.4, 0.2, 1.0)
QUARTER = orientation_from_yaw(math.pi / 2)
EIGHTH = orientation_from_yaw(math.pi / 4)
HALF = math.sqrt(0.5)
ON_ITS_SIDE = (HALF, HALF, 0.0, 0.0)
"""A quarter turn about x: the top points to the negative y axis."""
TIPPED = (math.cos(math.pi / 8), 0.0, math.sin(math.pi / 8), 0.0)
"""An eighth of a turn about y."""
L_SHAPE = "POLYGON ((0 0, 4 0, 4 1, 1 1, 1 4, 0 4, 0 0))"


def block(wxyz=IDENTITY, model=""):
    return form_of(model, SIZE, wxyz)


def test_a_vector_is_turned_like_the_body():
    assert block(QUARTER).turned((1.0, 2.0, 3.0)) == pytest.approx((-2.0, 1.0, 3.0))
    assert block(ON_ITS_SIDE).turned((1.0, 2.0, 3.0)) == pytest.approx((1.0, -3.0, 2.0))
    assert block((HALF, 0.0, HALF, 0.0)).turned((1.0, 2.0, 3.0)) == pytest.approx((3.0, 2.0, -1.0))


def test_an_upright_block():
    form = block()
    assert (form.is_level, form.is_upright, form.is_square) == (True, True, True)
    assert form.bounds == pytest.approx((-0.2, -0.1, 0.2, 0.1))
    assert (form.bottom, form.top) == pytest.approx((0.0, 1.0))
    assert (form.lowest_top, form.highest_bottom) == pytest.approx((1.0, 0.0))
    assert (form.volume, form.footprint) == pytest.approx((0.08, 0.08))
    assert form.outline == [pytest.approx(p) for p in [(-0.2, -0.1), (0.2, -0.1), (0.2, 0.1), (-0.2, 0.1)]]


def test_the_four_corners_of_the_base_come_first():
    corners = block().corners
    assert [z for _, _, z in corners] == [0.0] * 4 + [1.0] * 4
    assert [corner[:2] for corner in corners[:4]] == [corner[:2] for corner in corners[4:]]
    assert len(set(corners)) == 8


def test_a_quarter_turn_swaps_the_sides_and_keeps_the_outline_square():
    form = block(QUARTER)
    assert form.bounds == pytest.approx((-0.1, -0.2, 0.1, 0.2))
    assert form.is_square
    assert form.footprint == pytest.approx(0.08)


def test_an_eighth_of_a_turn_has_an_outline_within_larger_bounds():
    form = block(EIGHTH)
    reach = 0.3 * HALF
    assert form.is_level
    assert not form.is_square
    assert form.bounds == pytest.approx((-reach, -reach, reach, reach))
    assert form.footprint == pytest.approx(0.08)
    assert max(x for x, _ in form.outline) == pytest.approx(reach)


def test_a_block_on_its_side_extends_below_and_beside_its_own_bottom_centre():
    form = block(ON_ITS_SIDE)
    assert (form.is_level, form.is_upright, form.is_square) == (False, False, False)
    assert form.bounds == pytest.approx((-0.2, -1.0, 0.2, 0.0))
    assert (form.bottom, form.top) == pytest.approx((-0.1, 0.1))
    assert form.lowest_corner == pytest.approx(-0.1)
    assert area(form.outline) == pytest.approx(0.4)
    assert form.volume == pytest.approx(0.08)


def test_a_tipped_block_reaches_from_its_lowest_to_its_highest_corner():
    form = block(TIPPED)
    assert (form.bottom, form.top) == pytest.approx((-0.2 * HALF, (1.0 + 0.2) * HALF))
    assert form.bounds[0] == pytest.approx(-0.2 * HALF)
    assert form.bounds[2] == pytest.approx((1.0 + 0.2) * HALF)
    assert not form.is_upright


@pytest.mark.parametrize(
    ("degrees", "level", "upright"),
    [(0.1, True, True), (0.3, False, True), (14.0, False, True), (16.0, False, False)],
)
def test_a_small_tilt_is_level_and_a_moderate_one_upright(degrees, level, upright):
    half = math.radians(degrees) / 2
    form = block((math.cos(half), math.sin(half), 0.0, 0.0))
    assert (form.is_level, form.is_upright) == (level, upright)


def test_without_a_model_there_are_no_parts_and_the_box_counts():
    form = form_of(None, SIZE, ON_ITS_SIDE)
    assert form.parts == form_of(None, SIZE, IDENTITY).parts == ()
    assert form.bottom == form.lowest_corner == pytest.approx(-0.1)
    assert (form.lowest_top, form.highest_bottom) == (form.top, form.bottom)
    assert form.hollow_bounds is None


def test_a_table_stands_on_its_legs_and_has_no_hollow():
    table = form_of("table", (1.2, 0.8, 0.75), IDENTITY)
    assert len(table.parts) > 1
    assert table.bottom == pytest.approx(0.0, abs=1e-6)
    assert table.highest_bottom > 0.5
    assert table.lowest_top < 0.75
    assert table.hollow_bounds is None
    assert table.is_sealed
    assert 0.3 * table.footprint < area(list(table.base)) <= table.footprint + 1e-9


def test_the_hollow_of_a_basket_turns_with_it():
    upright, turned = (form_of("basket", (0.4, 0.2, 0.3), turn) for turn in (IDENTITY, QUARTER))
    (low, high), (low_turned, high_turned) = upright.hollow_bounds, turned.hollow_bounds
    assert -0.2 <= low[0] < high[0] <= 0.2
    assert 0.0 <= low[2] < high[2] <= 0.3
    assert low_turned == pytest.approx((-high[1], low[0], low[2]))
    assert high_turned == pytest.approx((-low[1], high[0], high[2]))
    assert not upright.is_sealed


def test_open_doors_extend_the_bounds_but_not_the_outline():
    size = (0.6, 0.9, 1.8)
    closed, opened = (form_of("fridge", size, IDENTITY, joints) for joints in ((), (1.57, 1.57)))
    assert closed.bounds == pytest.approx((-0.3, -0.45, 0.3, 0.45))
    assert opened.bounds[:2] == pytest.approx(closed.bounds[:2], abs=0.001)
    assert opened.bounds[2] == pytest.approx(0.3 + 0.9, abs=0.1)
    assert opened.top == pytest.approx(1.8)
    assert (opened.volume, opened.footprint) == (closed.volume, closed.footprint)
    assert (closed.is_square, opened.is_square) == (True, False)


def test_equal_shapes_share_a_form():
    form = block()
    assert form_of("", SIZE, IDENTITY) is form
    assert form.is_of("", SIZE, IDENTITY)
    assert not form.is_of(None, SIZE, IDENTITY)
    assert not form.is_of("", (0.4, 0.2, 1.1), IDENTITY)
    assert not form.is_of("", SIZE, QUARTER)
    assert not form.is_of("", SIZE, IDENTITY, (0.1,))


def test_a_polygon_has_its_own_area_around_the_centre_of_its_box():
    form = region_form(L_SHAPE, (4.0, 4.0, 2.5), (2.0, 2.0))
    assert form.footprint == pytest.approx(7.0)
    assert form.volume == pytest.approx(17.5)
    assert form.bounds == pytest.approx((-2.0, -2.0, 2.0, 2.0))
    assert area(form.outline) == pytest.approx(16.0 - 4.5)
    assert min(form.outline) == pytest.approx((-2.0, -2.0))
    assert not form.is_square
    assert not form.is_of(None, (4.0, 4.0, 2.5), IDENTITY)


def test_a_cleared_form_computes_the_same_again():
    for form in (block(EIGHTH), RegionForm(read_wkt(L_SHAPE), (4.0, 4.0, 2.5), (2.0, 2.0))):
        before = form.footprint, form.bounds, form.outline
        assert form.__dict__
        form.clear_cache()
        assert "footprint" not in form.__dict__
        assert (form.footprint, form.bounds, form.outline) == before
