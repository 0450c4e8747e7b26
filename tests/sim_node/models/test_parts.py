"""Primitive parts: volumes, boxes, motion and mass."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.sim_node.models.facets import facets
from semmap.nodes.sim_node.models.parts import (
    ALONG_X,
    ALONG_Y,
    UPRIGHT,
    Joint,
    Part,
    Role,
    Shape,
    about,
    ball,
    bounds,
    box,
    collision,
    inertial,
    mesh,
    moved,
    moving,
    pill,
    product,
    quarter_turned,
    rod,
    rotation_matrix,
    visual,
)

RED = (1.0, 0.0, 0.0)
ANGLE = st.floats(-3.0, 3.0)
TURN = st.builds(
    lambda a, b, c: product(about("z", a), product(about("y", b), about("x", c))), ANGLE, ANGLE, ANGLE
)
TETRAHEDRON = (
    np.array([(0, 0, 0), (2, 0, 0), (0, 4, 0), (0, 0, 6)], dtype=float),
    np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)], dtype=np.int32),
)


def test_volumes_are_those_of_the_textbook():
    assert box((0.4, 0.2, 0.6), (0, 0, 0), RED).volume == pytest.approx(0.048)
    assert ball((0.4, 0.2, 0.6), (0, 0, 0), RED).volume == pytest.approx(4 / 3 * math.pi * 0.2 * 0.1 * 0.3)
    assert rod(0.1, 0.5, (0, 0, 0), RED).volume == pytest.approx(math.pi * 0.01 * 0.5)
    straight, caps = math.pi * 0.01 * 0.3, 4 / 3 * math.pi * 0.001
    assert pill(0.1, 0.5, (0, 0, 0), RED).volume == pytest.approx(straight + caps)
    assert mesh(*TETRAHEDRON, RED).volume == pytest.approx(48.0)  # of its bounding box


def test_a_pill_that_is_shorter_than_wide_is_nearly_a_ball():
    assert pill(0.1, 0.1, (0, 0, 0), RED).half == (0.1, 0.1, 1e-4)


@given(TURN, TURN)
def test_turning_twice_is_turning_by_the_product(first, second):
    both = rotation_matrix(product(second, first))
    assert both == pytest.approx(rotation_matrix(second) @ rotation_matrix(first), abs=1e-9)
    assert both @ both.T == pytest.approx(np.eye(3), abs=1e-9)
    assert np.linalg.det(both) == pytest.approx(1.0)


def test_a_turn_about_an_axis_leaves_it_and_takes_the_next_to_the_third():
    x, y, z = np.eye(3)
    for name, axis, of, to in (("x", x, y, z), ("y", y, z, x), ("z", z, x, y)):
        turn = rotation_matrix(about(name, math.pi / 2))
        assert turn @ axis == pytest.approx(axis)
        assert turn @ of == pytest.approx(to)
    assert rotation_matrix(ALONG_X) @ z == pytest.approx(x)
    assert rotation_matrix(ALONG_Y) @ z == pytest.approx(y)
    assert rotation_matrix(UPRIGHT) == pytest.approx(np.eye(3))


@given(TURN, st.sampled_from([box, ball]))
def test_the_reach_of_a_turned_part_is_that_of_its_surface(turn, make):
    part = make((0.4, 0.2, 0.6), (1, 2, 3), RED, turn)
    extent = np.abs(facets(part).points - part.centre).max(axis=0)
    assert part.reach() == pytest.approx(extent, rel=0.06)
    assert (part.reach() >= extent - 1e-9).all()


@given(TURN, st.sampled_from([rod, pill]))
def test_the_reach_of_a_turned_rod_or_pill_is_that_of_its_surface(turn, make):
    part = make(0.1, 0.5, (1, 2, 3), RED, turn)
    extent = np.abs(facets(part).points - part.centre).max(axis=0)
    assert part.reach() == pytest.approx(extent, rel=0.08, abs=0.006)
    assert (part.reach() >= extent - 1e-9).all()


def test_a_mesh_stands_where_its_corners_are_and_reaches_as_far():
    part = mesh(*TETRAHEDRON, RED)
    assert part.centre == (1.0, 2.0, 3.0)
    assert part.half == (1.0, 2.0, 3.0)
    assert part.reach() == pytest.approx((1.0, 2.0, 3.0))
    quarter = Part(Shape.MESH, part.half, part.centre, RED, about("z", math.pi / 2), mesh=part.mesh)
    assert quarter.reach() == pytest.approx((2.0, 1.0, 3.0))


def test_one_part_or_several_become_decoration_or_a_stand_in():
    parts = [box((1, 1, 1), (0, 0, 0), RED), ball((1, 1, 1), (0, 0, 0), RED)]
    assert [part.role for part in parts] == [Role.BOTH, Role.BOTH]
    assert [part.role for part in visual(parts)] == [Role.VISUAL, Role.VISUAL]
    assert [part.role for part in collision(parts[0])] == [Role.COLLISION]


def test_a_quarter_turn_takes_the_front_to_the_right_with_joints_and_all():
    joint = Joint("door", "hinge", (1.0, 2.0, 3.0), (1.0, 0.0, 0.0), (0.0, 1.0))
    (plain,) = quarter_turned([box((4, 2, 6), (1.0, 0.5, 3.0), RED)])
    assert plain.centre == pytest.approx((0.5, -1.0, 3.0))
    assert plain.reach() == pytest.approx((1.0, 2.0, 3.0))
    assert plain.joint is None
    (hinged,) = quarter_turned(moving(joint, box((4, 2, 6), (1.0, 0.5, 3.0), RED)))
    assert hinged.joint.anchor == (2.0, -1.0, 3.0)
    assert hinged.joint.axis == pytest.approx((0.0, -1.0, 0.0))


def test_what_a_slide_carries_shifts_along_its_axis():
    slide = Joint("drawer", "slide", (0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.5))
    (drawer,) = moving(slide, box((1, 1, 1), (1.0, 2.0, 3.0), RED))
    assert moved(drawer, 0.5).centre == pytest.approx((1.0, 2.5, 3.0))
    assert moved(drawer, 0.0) is drawer


def test_what_a_hinge_carries_turns_about_its_anchor():
    hinge = Joint("door", "hinge", (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 2.0))
    (door,) = moving(hinge, box((2, 0.1, 1), (2.0, 0.0, 3.0), RED))
    opened = moved(door, math.pi / 2)
    assert opened.centre == pytest.approx((1.0, 1.0, 3.0))
    assert opened.reach() == pytest.approx((0.05, 1.0, 0.5))


def test_what_no_joint_carries_stays():
    fixed = box((1, 1, 1), (1.0, 2.0, 3.0), RED)
    assert moved(fixed, 1.0) is fixed


@given(ANGLE, st.sampled_from(["hinge", "slide"]))
def test_moving_there_and_back_changes_nothing(position, kind):
    joint = Joint("it", kind, (0.3, 0.2, 0.1), (0.0, 0.6, 0.8), (-3.0, 3.0))
    (part,) = moving(joint, box((0.4, 0.2, 0.6), (1.0, 2.0, 3.0), RED))
    back = moved(moved(part, position), -position)
    assert back.centre == pytest.approx(part.centre)
    assert rotation_matrix(back.turn) == pytest.approx(rotation_matrix(part.turn), abs=1e-9)


def test_the_box_around_parts_has_all_of_each():
    low, high = bounds([box((2, 2, 2), (0, 0, 1), RED), box((1, 1, 1), (3, -4, 0), RED)])
    assert low == pytest.approx((-1.0, -4.5, -0.5))
    assert high == pytest.approx((3.5, 1.0, 2.0))


def test_the_inertia_of_two_boxes_adds_up_by_steiner_s_theorem():
    parts = [box((0.2, 0.2, 0.2), (0.0, 0.0, 0.0), RED), box((0.2, 0.2, 0.2), (1.0, 0.0, 0.0), RED)]
    whole = inertial([*parts, *visual(box((9, 9, 9), (5, 5, 5), RED))], 4.0)
    assert whole.mass_kg == 4.0
    assert whole.centre_m == pytest.approx((0.5, 0.0, 0.0))
    own = 2.0 / 12.0 * (0.2**2 + 0.2**2)
    assert whole.moments == pytest.approx((2 * own, 2 * (own + 2.0 * 0.25), 2 * (own + 2.0 * 0.25)))


def test_mass_is_shared_out_by_volume():
    parts = [box((1, 1, 3), (0.0, 0.0, 0.0), RED), box((1, 1, 1), (0.0, 0.0, 4.0), RED)]
    assert inertial(parts, 8.0).centre_m == pytest.approx((0.0, 0.0, 1.0))


def test_a_needle_is_given_a_fiftieth_of_its_largest_moment_and_a_mote_a_least_one():
    needle = inertial([box((0.001, 0.001, 1.0), (0, 0, 0), RED)], 12.0).moments
    assert needle == pytest.approx((1.0, 1.0, 0.02), rel=1e-3)
    assert inertial([box((0.001, 0.001, 0.001), (0, 0, 0), RED)], 0.002).moments == pytest.approx([1e-7] * 3)
