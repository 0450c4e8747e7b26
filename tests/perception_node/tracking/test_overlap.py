import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodes.perception_node.tracking.overlap import OrientedBox, are_of_one, left_behind, share
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
    assert are_of_one(whole, OrientedBox(at(0, 0, 0.9), (0.09, 0.09, 0.1)))
    assert are_of_one(OrientedBox(at(0, 0, 0.9), (0.09, 0.09, 0.1)), whole)
    chair = OrientedBox(at(0, 0, 0.0), (0.5, 0.5, 0.9))
    assert not are_of_one(chair, OrientedBox(at(0, 0, 0.45), CUP))
    assert not are_of_one(whole, OrientedBox(at(0.12, 0), (0.1, 0.1, 0.3)))


def test_what_a_thing_leaves_behind_is_what_of_its_box_is_beyond_its_new_one():
    before = OrientedBox(at(1, 1, 0.0, yaw=1.5707963), (1.4, 0.6, 0.9))  # long along y
    (slab,) = left_behind(before, OrientedBox(at(1, 1.5, 0.0, yaw=1.5707963), (1.4, 0.6, 0.9)))
    assert slab.pose.position_m == pytest.approx((1.0, 0.55, 0.0), abs=1e-6)
    assert slab.size_m == pytest.approx((0.5, 0.6, 0.9))
    (below,) = left_behind(before, OrientedBox(at(1, 1, 0.4), (0.6, 1.4, 0.5)))
    assert below.pose.position_m == pytest.approx((1.0, 1.0, 0.0), abs=1e-6)
    assert below.size_m == pytest.approx((1.4, 0.6, 0.4))


@given(st.floats(-3, 3), st.floats(-0.09, 0.09))
def test_nothing_is_left_behind_by_what_hardly_moves_or_grows(yaw, aside):
    before = OrientedBox(at(0, 0, yaw=yaw), (1.0, 0.5, 0.5))
    assert left_behind(before, OrientedBox(at(aside / 2, aside / 2, yaw=yaw), (1.0, 0.5, 0.5))) == []
    assert left_behind(before, OrientedBox(at(0, 0, yaw=yaw), (1.5, 0.6, 0.7))) == []
