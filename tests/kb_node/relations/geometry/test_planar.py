"""Parallelograms, ellipses and bounds on the floor plan."""

from __future__ import annotations

import numpy as np
import pytest

from semmap.nodes.kb_node.relations.geometry import planar

U, V = np.array([[2.0, 0.0]]), np.array([[1.0, 1.0]])


def test_the_area_is_that_of_the_whole_sides_whichever_comes_first():
    assert planar.compute_areas(U, V) == pytest.approx([8.0])
    assert planar.compute_areas(V, U) == pytest.approx([8.0])


def test_a_vector_is_the_sum_of_its_multiples_of_the_sides():
    s, t = planar.decompose(np.array([[7.0, 3.0]]), U, V)
    assert (*s, *t) == pytest.approx((2.0, 3.0))


def test_parallel_sides_decompose_nothing_and_contain_nothing():
    s, t = planar.decompose(np.array([[1.0, 1.0]]), U, -3.0 * U)
    assert np.isnan(s).all()
    assert np.isnan(t).all()
    assert not planar.are_within(s, t).any()


def test_an_extent_adds_the_distance_of_the_centre_and_both_half_sides():
    along = np.array([[2.0, 0.0]]), np.array([[0.0, 4.0]])
    centre, a, b = np.array([[-1.0, 1.0]]), np.array([[-0.2, 0.4]]), np.array([[0.6, -0.8]])
    s, t = planar.compute_extents(centre, a, b, *along)
    assert (*s, *t) == pytest.approx((0.9, 0.55))


@pytest.mark.parametrize(
    ("s", "t", "is_within"),
    [(0.9, -0.9, True), (0.0, 0.0, True), (-1.1, 0.0, False), (0.0, 1.1, False), (1.0, 0.0, False)],
)
def test_within_means_clearly_less_than_the_half_side_in_both_directions(s, t, is_within):
    assert planar.are_within(np.array([s]), np.array([t])).tolist() == [is_within]


def test_a_corner_is_on_a_square_top_but_not_on_a_round_one():
    s = t = np.array([0.8, 0.8, 0.5])
    assert planar.are_within_outline(s, t, np.array([0.0, 1.0, 1.0])).tolist() == [True, False, True]


def test_bounds_contain_all_four_corners_and_touch_them():
    middle = np.array([[10.0, 20.0]])
    corners = np.concatenate([middle + i * U + j * V for i in (-1, 1) for j in (-1, 1)])
    expected = [*corners.min(axis=0), *corners.max(axis=0)]
    assert planar.bounds_around(middle, U, -V)[0] == pytest.approx(expected)


@pytest.mark.parametrize(
    ("other", "area"),
    [
        ((1.0, 2.0, 5.0, 6.0), 2.0),
        ((0.5, 0.5, 1.0, 1.5), 0.5),
        ((2.0, 0.0, 3.0, 3.0), 0.0),
        ((5.0, 7.0, 8.0, 9.0), 0.0),
    ],
)
def test_bounds_that_are_apart_or_touch_have_no_common_area(other, area):
    one, second = np.array([[0.0, 0.0, 2.0, 4.0]]), np.array([other])
    assert planar.compute_intersections(one, second) == pytest.approx([area])
    assert planar.compute_intersections(second, one) == pytest.approx([area])


def test_the_uncertainty_grows_with_the_distance_and_for_small_areas():
    at = np.array([[0.0, 0.0, 9e9], [-6e3, 4e3, 0.0], [-6e3, 4e3, 0.0]])
    found = planar.compute_uncertainty(at, np.array([1.0, 1.0, 0.01]))
    assert found == pytest.approx([1e-6, 2e-6, 1.01e-4])
