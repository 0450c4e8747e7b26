"""Projections of parts, and how far two of them must be moved apart."""

from __future__ import annotations

import math

import pytest

from semmap.nodes.kb_node.relations.geometry.projections import Projection, overlap_depth, project

SQUARE = Projection(((1.0, 0.0), (0.0, 2.0)))
DISC = Projection((), 0.5)


def test_a_box_is_projected_to_its_level_sides():
    assert project([(1.0, 2.0, 0.0), (-2.0, 1.0, 0.0)], []) == Projection(((1.0, 2.0), (-2.0, 1.0)))


@pytest.mark.parametrize("round_", [[(3.0, 0.0, 0.0), (0.0, 0.5, 0.0)], [(0.3, 0.4, 0.0), (-2.4, 1.8, 0.0)]])
def test_an_ellipse_is_replaced_by_the_disc_of_its_shorter_axis(round_):
    found = project([], round_)
    assert found is not None
    assert found.sides == ()
    assert found.radius == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("level", "round_"),
    [
        ([(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)], [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]),
        ([], []),
        ([(1.0, 0.0, 0.0)], []),
        ([(1.0, 0.0, 0.0)], [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]),
    ],
)
def test_a_part_that_is_neither_a_box_nor_a_cylinder_has_no_projection(level, round_):
    assert project(level, round_) is None


@pytest.mark.parametrize(
    ("x", "y", "depth"), [(0.0, 0.0, 2.0), (1.5, 0.0, 0.5), (-2.5, 0.0, -0.5), (0.5, -3.9, 0.1)]
)
def test_boxes_are_moved_apart_along_the_direction_of_least_overlap(x, y, depth):
    assert overlap_depth(x, y, SQUARE, SQUARE) == pytest.approx(depth)


@pytest.mark.parametrize(
    ("x", "y", "depth"),
    [
        (0.0, 0.0, 1.5),
        (0.9, 0.0, 0.6),
        (0.0, -1.9, 0.6),
        (1.2, 0.0, 0.3),
        (0.0, 2.7, -0.2),
        (1.3, -2.4, 0.0),
        (-1.6, 2.8, -0.5),
    ],
)
def test_a_disc_beside_a_box_is_compared_with_the_nearest_side_or_corner(x, y, depth):
    assert overlap_depth(x, y, SQUARE, DISC) == pytest.approx(depth)
    assert overlap_depth(-x, -y, DISC, SQUARE) == pytest.approx(depth)


def test_discs_overlap_by_the_sum_of_their_radii_less_their_distance():
    assert overlap_depth(0.3, -0.4, DISC, Projection((), 0.25)) == pytest.approx(0.25)


def test_there_is_no_lower_bound_beside_a_skewed_or_a_flat_box():
    skewed, flat = Projection(((1.0, 0.0), (0.5, 1.0))), Projection(((1.0, 0.0), (0.0, 0.0)))
    assert overlap_depth(0.0, 0.0, skewed, DISC) == -math.inf
    assert overlap_depth(0.0, 0.0, DISC, flat) == -math.inf
    assert overlap_depth(0.0, 0.0, flat, SQUARE) == -math.inf


DIAGONAL = Projection(((math.sqrt(0.5), math.sqrt(0.5)), (-math.sqrt(0.5), math.sqrt(0.5))))
"""A square whose corners are on the axes."""


@pytest.mark.parametrize(
    ("x", "y", "depth"),
    [
        (3.0, 0.0, math.sqrt(2.0) - 2.0),  # across a side of the box
        (0.0, -3.0, math.sqrt(2.0) - 1.0),
        (2.2, 2.2, 3.0 / math.sqrt(2.0) + 1.0 - 2.2 * math.sqrt(2.0)),  # across a side of the square
        (2.2, -2.2, 3.0 / math.sqrt(2.0) + 1.0 - 2.2 * math.sqrt(2.0)),
    ],
)
def test_a_turned_box_is_compared_across_the_sides_of_both(x, y, depth):
    assert overlap_depth(x, y, DIAGONAL, SQUARE) == pytest.approx(depth)
    assert overlap_depth(-x, -y, SQUARE, DIAGONAL) == pytest.approx(depth)
