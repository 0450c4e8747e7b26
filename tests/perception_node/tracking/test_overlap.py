import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.perception_node.tracking.overlap import (
    OrientedBox,
    may_be_same_thing,
    share,
    uncovered_slabs,
)
from tests.perception_node.things import at

CUP = (0.08, 0.08, 0.1)


@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(-3.1, 3.1))
def test_a_box_is_all_in_itself_and_in_a_bigger_one(x, y, yaw):
    box = OrientedBox(at(x, y, yaw=yaw), CUP)
    assert share(box, box) == 1.0
    assert share(box, OrientedBox(at(x, y, 0.65, yaw=yaw), (0.1, 0.1, 0.2))) == 1.0


def test_half_a_box_beside():
    assert share(OrientedBox(at(0, 0), CUP), OrientedBox(at(0.04, 0), CUP)) == pytest.approx(0.5)
    assert share(OrientedBox(at(0, 0), CUP), OrientedBox(at(0, 0, 0.75), CUP)) == pytest.approx(0.5)


@pytest.mark.parametrize("apart", [at(0.09, 0), at(0, -0.09), at(0, 0, 0.81), at(0, 0, 0.59)])
def test_boxes_that_do_not_touch_share_nothing(apart):
    assert share(OrientedBox(at(0, 0), CUP), OrientedBox(apart, CUP)) == 0.0


def test_turning_counts():
    long = OrientedBox(at(0, 0), (0.4, 0.04, 0.1))
    across = OrientedBox(at(0, 0, yaw=1.5708), (0.4, 0.04, 0.1))
    assert share(long, across) < 0.2


def test_a_part_is_of_one_with_the_whole_but_a_cup_is_not_of_the_chair_it_stands_on():
    whole = OrientedBox(at(0, 0), (0.1, 0.1, 0.3))
    assert may_be_same_thing(whole, OrientedBox(at(0, 0, 0.9), (0.09, 0.09, 0.1)))
    assert may_be_same_thing(OrientedBox(at(0, 0, 0.9), (0.09, 0.09, 0.1)), whole)
    chair = OrientedBox(at(0, 0, 0.0), (0.5, 0.5, 0.9))
    assert not may_be_same_thing(chair, OrientedBox(at(0, 0, 0.45), CUP))
    assert not may_be_same_thing(whole, OrientedBox(at(0.12, 0), (0.1, 0.1, 0.3)))


def test_what_a_thing_leaves_behind_is_what_of_its_box_is_beyond_its_new_one():
    before = OrientedBox(at(1, 1, 0.0, yaw=1.5707963), (1.4, 0.6, 0.9))  # long along y
    (slab,) = uncovered_slabs(before, OrientedBox(at(1, 1.5, 0.0, yaw=1.5707963), (1.4, 0.6, 0.9)))
    assert slab.pose.position_m == pytest.approx((1.0, 0.55, 0.0), abs=1e-6)
    assert slab.size_m == pytest.approx((0.5, 0.6, 0.9))
    (below,) = uncovered_slabs(before, OrientedBox(at(1, 1, 0.4), (0.6, 1.4, 0.5)))
    assert below.pose.position_m == pytest.approx((1.0, 1.0, 0.0), abs=1e-6)
    assert below.size_m == pytest.approx((1.4, 0.6, 0.4))


@given(st.floats(-3, 3), st.floats(-0.09, 0.09))
def test_nothing_is_left_behind_by_what_hardly_moves_or_grows(yaw, aside):
    before = OrientedBox(at(0, 0, yaw=yaw), (1.0, 0.5, 0.5))
    assert uncovered_slabs(before, OrientedBox(at(aside / 2, aside / 2, yaw=yaw), (1.0, 0.5, 0.5))) == []
    assert uncovered_slabs(before, OrientedBox(at(0, 0, yaw=yaw), (1.5, 0.6, 0.7))) == []


@pytest.mark.parametrize(
    ("x", "y", "z", "expected"),
    [
        (0.0, 0.0, 0.0, 1.0),
        (0.5, 0.0, 0.0, 0.5),
        (0.0, 0.5, 0.0, 0.5),
        (0.0, 0.0, 0.5, 0.5),
        (0.5, 0.5, 0.5, 0.125),
    ],
)
def test_a_cube_that_is_shifted_by_half_shares_half(x, y, z, expected):
    cube = OrientedBox(at(0, 0, 0.0), (1.0, 1.0, 1.0))
    other = OrientedBox(at(x, y, z), (1.0, 1.0, 1.0))
    assert share(cube, other) == pytest.approx(expected)
    assert share(other, cube) == pytest.approx(expected)
    assert cube.volume_m3 == 1.0


@pytest.mark.parametrize(
    ("x", "y", "z"), [(3.0, 0.0, 0.0), (0.0, -3.0, 0.0), (0.0, 0.0, 1.1), (0.0, 0.0, -1.1)]
)
def test_boxes_that_are_apart_share_nothing(x, y, z):
    cube = OrientedBox(at(0, 0, 0.0), (1.0, 1.0, 1.0))
    assert share(cube, OrientedBox(at(x, y, z), (1.0, 1.0, 1.0))) == 0.0


def test_a_small_box_lies_all_in_a_large_one_and_fills_a_part_of_it():
    large, small = OrientedBox(at(0, 0, 0.0), (2.0, 2.0, 2.0)), OrientedBox(at(0.2, 0, 0.5), (1.0, 1.0, 1.0))
    assert share(small, large) == 1.0
    assert share(large, small) == pytest.approx(1 / 8, abs=0.06)


def test_boxes_are_turned_before_they_are_compared():
    along = OrientedBox(at(0, 0, 0.0), (2.0, 0.2, 1.0))
    across = OrientedBox(at(0, 0, 0.0, yaw=math.pi / 2), (2.0, 0.2, 1.0))
    same = OrientedBox(at(0, 0, 0.0, yaw=math.pi / 2), (0.2, 2.0, 1.0))
    assert share(along, across) < 0.4
    assert share(along, same) == 1.0
    aside = OrientedBox(at(0.9, 0, 0.0, yaw=0.0), (0.1, 0.1, 1.0))
    assert share(aside, along) == 1.0
    assert share(aside, across) == 0.0


@pytest.mark.parametrize(
    ("size_m", "of_one"),
    [((1.0, 1.0, 1.0), True), ((0.5, 0.5, 0.5), True), ((0.25, 0.25, 0.25), False), ((4.0, 4.0, 4.0), False)],
)
def test_boxes_are_of_one_thing_unless_one_is_tiny(size_m, of_one):
    cube = OrientedBox(at(0, 0, 0.0), (1.0, 1.0, 1.0))
    other = OrientedBox(at(0, 0, 0.0), size_m)
    assert may_be_same_thing(cube, other) is of_one
    assert may_be_same_thing(other, cube) is of_one


@pytest.mark.parametrize(("x", "of_one"), [(0.6, True), (0.8, False)])
def test_boxes_that_hardly_overlap_are_not_of_one_thing(x, of_one):
    cube = OrientedBox(at(0, 0, 0.0), (1.0, 1.0, 1.0))
    assert may_be_same_thing(cube, OrientedBox(at(x, 0, 0.0), (1.0, 1.0, 1.0))) is of_one


def test_what_is_left_behind_of_a_box_is_what_is_beyond_the_other_on_each_side():
    before = OrientedBox(at(0, 0, 0.0), (2.0, 2.0, 2.0))
    slabs = uncovered_slabs(before, OrientedBox(at(0.2, -0.3, 0.5), (1.0, 1.0, 1.0)))
    found = sorted((*(round(v, 6) for v in slab.pose.position_m), *map(float, slab.size_m)) for slab in slabs)
    expected = sorted(
        [
            (-0.65, 0.0, 0.0, 0.7, 2.0, 2.0),
            (0.85, 0.0, 0.0, 0.3, 2.0, 2.0),
            (0.0, -0.9, 0.0, 2.0, 0.2, 2.0),
            (0.0, 0.6, 0.0, 2.0, 0.8, 2.0),
            (0.0, 0.0, 0.0, 2.0, 2.0, 0.5),
            (0.0, 0.0, 1.5, 2.0, 2.0, 0.5),
        ]
    )
    assert np.array(found) == pytest.approx(np.array(expected))


def test_what_is_left_behind_of_a_turned_box_lies_along_its_own_axes():
    before = OrientedBox(at(5, 5, 0.0, yaw=math.pi / 2), (2.0, 1.0, 1.0))
    now = OrientedBox(at(5, 5.5, 0.0), (1.0, 1.0, 1.0))
    (slab,) = uncovered_slabs(before, now)
    assert slab.pose.position_m == pytest.approx((5.0, 4.5, 0.0))
    assert slab.size_m == pytest.approx((1.0, 1.0, 1.0))
    assert slab.pose.yaw_rad == pytest.approx(math.pi / 2)


def test_nothing_is_left_behind_of_a_box_in_its_place_and_all_of_it_elsewhere():
    cube = OrientedBox(at(0, 0, 0.0), (1.0, 1.0, 1.0))
    assert uncovered_slabs(cube, OrientedBox(at(0.05, 0, 0.0), (1.0, 1.0, 1.0))) == []
    away = uncovered_slabs(cube, OrientedBox(at(5, 0, 0.0), (1.0, 1.0, 1.0)))
    assert [slab.size_m for slab in away] == [pytest.approx((1.0, 1.0, 1.0))]
    assert away[0].pose.position_m == pytest.approx((0.0, 0.0, 0.0))
