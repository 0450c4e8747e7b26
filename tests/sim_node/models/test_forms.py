"""Shapes that many models share."""

from __future__ import annotations

import math

import numpy as np
import pytest

from semmap.nodes.sim_node.models import forms
from semmap.nodes.sim_node.models.parts import (
    Joint,
    Role,
    Shape,
    bounds,
    box,
    collision,
    moving,
    rotation_matrix,
)

RED = (0.5, 0.2, 0.0)


def corners(parts):
    return np.array(bounds(parts))


def test_a_shade_is_darker_or_lighter_and_never_more_than_full():
    assert forms.shade(RED, 0.5) == (0.25, 0.1, 0.0)
    assert forms.shade(RED, 4.0) == (1.0, 0.8, 0.0)


def test_legs_stand_in_the_corners_and_are_felt_as_pills_inside_what_is_seen():
    parts = forms.legs(1.0, 0.6, 0.7, 0.1, RED)
    for role, shape in ((Role.VISUAL, Shape.BOX), (Role.COLLISION, Shape.CAPSULE)):
        own = [part for part in parts if part.role is role]
        assert {part.shape for part in own} == {shape}
        assert np.array(sorted(part.centre for part in own)) == pytest.approx(
            np.array([(x, y, 0.35) for x in (-0.45, 0.45) for y in (-0.25, 0.25)])
        )
        assert corners(own) == pytest.approx(np.array([(-0.5, -0.3, 0.0), (0.5, 0.3, 0.7)]))


def test_a_slab_lies_between_two_heights_and_a_solid_is_only_felt():
    assert corners([forms.slab(1.0, 0.6, 0.2, 0.5, RED)]) == pytest.approx(
        np.array([(-0.5, -0.3, 0.2), (0.5, 0.3, 0.5)])
    )
    (stand_in,) = forms.solid(1.0, 0.6, 0.2, 0.5)
    assert stand_in.role is Role.COLLISION
    assert corners([stand_in]) == pytest.approx(np.array([(-0.5, -0.3, 0.2), (0.5, 0.3, 0.5)]))


def test_the_outer_face_of_a_front_is_at_its_depth():
    (panel,) = forms.front(0.3, 0.4, 0.6, (0.1, 0.5), RED, deep=0.02)
    assert panel.role is Role.VISUAL
    assert corners([panel]) == pytest.approx(np.array([(0.28, -0.1, 0.2), (0.3, 0.3, 0.8)]))


def test_a_closed_box_is_one_to_the_eye_and_six_walls_with_room_to_the_touch():
    size, centre = (0.8, 1.0, 2.0), (0.1, 0.2, 1.0)
    parts = forms.closed_box(size, centre, RED)
    (outside,) = (part for part in parts if part.role is Role.VISUAL)
    walls = [part for part in parts if part.role is Role.COLLISION]
    box_ = np.array([(-0.3, -0.3, 0.0), (0.5, 0.7, 2.0)])
    assert corners([outside]) == pytest.approx(box_)
    assert corners(walls) == pytest.approx(box_)
    wall = 0.02
    room = (0.8 - 2 * wall) * (1.0 - 2 * wall) * (2.0 - 2 * wall)
    assert sum(part.volume for part in walls) == pytest.approx(0.8 * 1.0 * 2.0 - room)
    for wall_ in walls:  # none is in the room
        low, high = bounds([wall_])
        assert not (np.abs((low + high) / 2 - centre) < np.array(size) / 2 - 0.05).all()
    assert {tuple(np.round((np.subtract(w.centre, centre)) / size, 1)) for w in walls} >= {
        (0.0, 0.0, 0.5),
        (0.0, 0.0, -0.5),
        (0.5, 0.0, 0.0),
        (-0.5, 0.0, 0.0),
        (0.0, 0.5, 0.0),
        (0.0, -0.5, 0.0),
    }


def test_the_walls_of_a_large_box_are_thicker_and_those_of_a_small_one_thinner():
    def wall(*size):
        return 2 * min(part.half[2] for part in forms.closed_box(size, (0, 0, 0), RED))

    assert wall(0.8, 1.0, 1.0) == pytest.approx(0.02)
    assert wall(1.0, 2.0, 1.0) == pytest.approx(0.036)
    assert wall(2.0, 1.0, 1.0) == pytest.approx(0.036)
    assert wall(0.1, 0.5, 0.5) == pytest.approx(0.01)


def test_boards_lie_at_shares_of_the_height_and_reach_from_the_back():
    parts = forms.closed_box((0.8, 1.0, 2.0), (0.1, 0.0, 1.0), RED, boards=(0.25, 0.5), depth=0.5)
    one, two = parts[-2:]
    for board, height in ((one, 0.5), (two, 1.0)):
        low, high = bounds([board])
        assert board.centre[2] == pytest.approx(height)
        assert (low[0], high[0]) == pytest.approx((0.1 - 0.38, 0.1))
        assert (low[1], high[1]) == pytest.approx((-0.48, 0.48))
        assert high[2] - low[2] == pytest.approx(0.02)


def test_a_hollow_box_is_open_at_the_top():
    parts = forms.hollow_box(0.4, 0.6, 0.3, 0.05, RED)
    assert corners(parts) == pytest.approx(np.array([(-0.2, -0.3, 0.0), (0.2, 0.3, 0.3)]))
    room = 0.3 * 0.5 * 0.25
    assert sum(part.volume for part in parts) == pytest.approx(0.4 * 0.6 * 0.3 - room)
    for part in parts[1:]:
        low, high = bounds([part])
        assert (low[2], high[2]) == pytest.approx((0.05, 0.3))
        assert max(abs(part.centre[0]) / 0.175, abs(part.centre[1]) / 0.275) == pytest.approx(1.0)


@pytest.mark.parametrize("radii", [(0.1, 0.1), (0.1, 0.15), (0.15, 0.1)])
def test_a_ring_of_staves_is_closed_and_leans_from_one_radius_to_the_other(radii):
    low, high = radii
    staves = forms.ring(radii, 0.1, 0.4, 0.01, RED, count=12)
    assert len(staves) == 12
    angles = sorted(math.degrees(math.atan2(part.centre[1], part.centre[0])) % 360 for part in staves)
    assert np.diff(angles) == pytest.approx(30.0)
    assert angles[0] == pytest.approx(15.0)
    (bottom, top) = corners(staves)
    assert (bottom[2], top[2]) == pytest.approx((0.1, 0.4), abs=0.006)
    assert max(top[:2]) == pytest.approx(max(radii), rel=0.06)
    for part in staves:
        assert part.centre[2] == pytest.approx(0.25)
        assert math.hypot(*part.centre[:2]) == pytest.approx(
            (low + high) / 2 * math.cos(math.pi / 12) - 0.005
        )
        assert 2 * part.half[1] == pytest.approx(2 * max(radii) * math.sin(math.pi / 12))
        length = math.hypot(0.3, high - low)
        assert 2 * part.half[2] == pytest.approx(length - 0.01 * abs(high - low) / length)
        outwards = np.array([*part.centre[:2], 0.0]) / math.hypot(*part.centre[:2])
        up = rotation_matrix(part.turn)[:, 2]
        assert up @ outwards == pytest.approx((high - low) / length)
        assert up[2] == pytest.approx(0.3 / length)


def test_a_turned_profile_is_a_stack_of_discs_through_its_points():
    discs = forms.turned([(0.1, 0.0), (0.1, 0.2), (0.3, 0.6)], RED, steps=4)
    assert {part.role for part in discs} == {Role.VISUAL}
    assert {part.shape for part in discs} == {Shape.CYLINDER}
    assert {(part.centre[0], part.centre[1]) for part in discs} == {(0, 0)}
    rows = [(part.half[0], part.half[1], part.centre[2], part.half[2]) for part in discs]
    slope = [(0.125 + 0.05 * k, 0.125 + 0.05 * k, 0.25 + 0.1 * k, 0.05) for k in range(4)]
    assert np.array(rows) == pytest.approx(np.array([(0.1, 0.1, 0.1, 0.1), *slope]))


def test_a_turned_profile_has_six_steps_to_each_slope():
    assert len(forms.turned([(0.1, 0.0), (0.2, 0.2)], RED)) == 6


def test_a_column_stands_between_two_heights():
    assert corners([forms.column(0.1, 0.2, 0.8, RED)]) == pytest.approx(
        np.array([(-0.1, -0.1, 0.2), (0.1, 0.1, 0.8)])
    )


def test_what_is_shifted_takes_its_joint_along():
    joint = Joint("lid", "hinge", (1.0, 2.0, 3.0), (1.0, 0.0, 0.0), None)
    (part,) = forms.shifted(moving(joint, box((1, 1, 1), (0, 0, 0), RED)), x=0.1, y=0.2, z=0.3)
    assert part.centre == (0.1, 0.2, 0.3)
    assert part.joint.anchor == (1.1, 2.2, 3.3)
    assert part.joint.axis == (1.0, 0.0, 0.0)
    (plain,) = forms.shifted(collision(box((1, 1, 1), (0, 0, 0), RED)), z=-1.0)
    assert plain.centre == (0, 0, -1.0)
    assert plain.joint is None


@pytest.mark.parametrize(
    "name", [name for name in vars(forms) if name.isupper() and isinstance(vars(forms)[name], tuple)]
)
def test_a_colour_can_be_shown(name):
    assert all(0.0 <= channel <= 1.0 for channel in vars(forms)[name])
