"""Ray casting and supports."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.extern.web.scene.gizmo import place_on_support
from semmap.nodes.extern.web.scene.picking import (
    Solid,
    corners_of,
    edges_of,
    first_hit,
    is_level,
    rotation_of,
    support_m,
)
from tests.extern.web.scene.sample_scenes import pose, surface

DOWN = (0.0, 0.0, -1.0)


def table(at=None):
    return Solid("table1", at or pose(2.0, 3.0), (1.0, 0.6, 0.75))


def test_the_floor_is_hit_where_no_object_is():
    hit = first_hit((1.0, 1.0, 2.0), (1.0, 0.0, -1.0), [table()])
    assert (hit.name, hit.at) == ("", pytest.approx((3.0, 1.0, 0.0)))
    assert is_level(hit)


def test_an_upward_ray_has_no_hit():
    assert first_hit((0.0, 0.0, 1.0), (0.0, 1.0, 0.5), [table()]) is None


def test_the_nearest_object_is_hit():
    cup = Solid("cup1", pose(2.0, 3.0, 0.75), (0.1, 0.1, 0.1))
    assert first_hit((2.0, 3.0, 3.0), DOWN, [table(), cup]).name == "cup1"
    hit = first_hit((2.3, 3.0, 3.0), DOWN, [table(), cup])
    assert (hit.name, hit.at[2]) == ("table1", pytest.approx(0.75))


def test_a_vertical_side_is_not_level():
    hit = first_hit((0.0, 3.0, 0.5), (1.0, 0.0, 0.0), [table()])
    assert hit.at == pytest.approx((1.5, 3.0, 0.5))
    assert hit.normal == pytest.approx((-1.0, 0.0, 0.0))
    assert not is_level(hit)


def test_rotations_of_objects_are_respected():
    turned = table(pose(2.0, 3.0, 0.0, math.pi / 2.0))
    assert first_hit((2.0, 3.45, 3.0), DOWN, [turned]).name == "table1"
    assert first_hit((2.45, 3.0, 3.0), DOWN, [turned]).name == ""


def test_a_known_surface_replaces_the_box():
    low = Solid("chair1", pose(), (1.0, 1.0, 1.0), surface((1.0, 1.0, 0.4)))
    assert first_hit((0.2, 0.1, 3.0), DOWN, [low]).at[2] == pytest.approx(0.4)


@given(
    st.floats(-3, 3), st.floats(-3, 3), st.floats(0, 2), st.floats(-3, 3), st.floats(-1, 1), st.floats(-1, 1)
)
def test_box_and_surface_of_the_same_shape_have_the_same_hit(x, y, z, yaw, east, north):
    at = pose(x, y, z, yaw)
    size_m = (1.0, 0.6, 0.75)
    ray = ((0.1, 0.2, 6.0), (east, north, -1.0))
    by_box = first_hit(*ray, [Solid("a", at, size_m)])
    by_surface = first_hit(*ray, [Solid("a", at, size_m, surface(size_m))])
    if by_box.name == by_surface.name:  # an edge may be met by the one and missed by the other
        assert by_box.at == pytest.approx(by_surface.at, abs=1e-4)


def test_corners_and_edges_of_a_box():
    corners = corners_of(pose(1.0, 2.0, 3.0, math.pi / 2.0), (2.0, 1.0, 0.5))
    assert corners.min(axis=0) == pytest.approx((0.5, 1.0, 3.0))
    assert corners.max(axis=0) == pytest.approx((1.5, 3.0, 3.5))
    edges = edges_of(pose(), (2.0, 1.0, 0.5))
    lengths = sorted(np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1).round(3).tolist())
    assert lengths == [0.5] * 4 + [1.0] * 4 + [2.0] * 4


@given(st.floats(-math.pi, math.pi))
def test_rotation_matrices_are_orthonormal(yaw_rad):
    rotation = rotation_of(pose(yaw_rad=yaw_rad))
    assert rotation @ rotation.T == pytest.approx(np.eye(3), abs=1e-9)


def test_the_support_below_a_point_is_an_object_or_the_floor():
    assert support_m((2.0, 3.0, 2.0), [table()]) == pytest.approx(0.75)
    assert support_m((2.0, 3.0, 0.5), [Solid("rug", pose(2.0, 3.0), (1.0, 1.0, 0.01))]) == pytest.approx(0.01)
    assert support_m((0.0, 0.0, 2.0), [table()]) == 0.0


def test_a_small_object_dragged_into_a_counter_is_placed_on_top():
    counter = Solid("counter1", pose(2.0, 3.0), (1.0, 0.6, 0.9))
    dragged = place_on_support(pose(2.0, 3.0, 0.74), (0.1, 0.1, 0.1), [counter])
    assert dragged.position_m == pytest.approx((2.0, 3.0, 0.9), abs=0.01)


def test_a_chair_dragged_under_a_table_stays_on_the_floor():
    top = surface((1.0, 0.6, 0.05))
    board = Solid("table1", pose(2.0, 3.0, 0.7), (1.0, 0.6, 0.05), top)
    at = pose(2.0, 3.0, 0.0)
    assert place_on_support(at, (0.4, 0.4, 0.6), [board]) == at


def test_lifted_and_large_objects_stay_where_they_are_released():
    assert place_on_support(pose(2.0, 3.0, 1.4), (0.1, 0.1, 0.1), [table()]) == pose(2.0, 3.0, 1.4)
    assert place_on_support(pose(2.0, 3.0, 0.0), (2.0, 1.0, 0.4), [table()]) == pose(2.0, 3.0, 0.0)


def test_objects_off_the_ray_are_not_hit():
    grid = [Solid(f"s{i}", pose(2.0 * (i % 30), 2.0 * (i // 30)), (0.5, 0.5, 1.0)) for i in range(900)]
    hit = first_hit((10.0, 10.0, 5.0), (0.0, 0.0, -1.0), grid)
    assert (hit.name, hit.at) == ("s155", pytest.approx((10.0, 10.0, 1.0)))
    assert first_hit((11.0, 11.0, 5.0), (0.0, 0.0, -1.0), grid).name == ""
