import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.perception_node.views.boxes import Box, best_yaw, box_around, in_frame

YAWS = st.floats(-3.0, 3.0)


def shell(size, yaw, middle):
    """Return points on the sides of a box at `middle`."""
    grid = np.stack(np.meshgrid(*[np.linspace(-0.5, 0.5, 9)] * 3), axis=-1).reshape(-1, 3)
    local = (grid[np.abs(grid).max(axis=1) > 0.49] + [0.0, 0.0, 0.5]) * size
    return in_frame(local, -yaw) + middle


@given(YAWS)
def test_a_box_is_found_as_it_stands(yaw):
    points = shell([0.4, 0.2, 0.3], yaw, [1.0, -2.0, 0.7])
    box = box_around(points, best_yaw(points), 0.7)
    assert box.bottom_m == pytest.approx([1.0, -2.0, 0.7], abs=0.002)
    assert sorted(box.size_m[:2]) == pytest.approx([0.2, 0.4], abs=0.012)
    assert box.size_m[2] == pytest.approx(0.3)


@given(YAWS, YAWS)
def test_turning_frames_adds_up(a, b):
    points = np.array([[1.0, 2.0, 3.0], [-1.0, 0.5, 0.0]])
    assert in_frame(in_frame(points, a), b) == pytest.approx(in_frame(points, a + b), abs=1e-9)


@given(YAWS)
def test_a_quarter_turn_leaves_the_box_where_it_is(yaw):
    box = Box(np.array([0.1, -0.3, 0.0]), np.array([0.5, 0.4, 0.2]), yaw)
    turned = box.quarter_turned()
    assert turned.bottom_m == pytest.approx(box.bottom_m)
    assert turned.size_m == pytest.approx(box.size_m[[1, 0, 2]])


def test_one_point_has_a_box_too():
    box = box_around(np.array([[1.0, 1.0, 1.0]]), 0.0, 1.0)
    assert (box.size_m > 0.0).all()
