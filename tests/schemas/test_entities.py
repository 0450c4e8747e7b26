import math
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from semmap.schemas import codec
from semmap.schemas.commands import Move
from semmap.schemas.entities import (
    NAME_PATTERN,
    Pose,
    angle_rad,
    compose,
    distance_m,
    free_name,
    is_name,
    names_in,
    orientation_from_yaw,
    parse_angle,
    valid_name,
)
from semmap.schemas.errors import BadRequest

YAWS = st.floats(-math.pi + 1e-6, math.pi)


@given(YAWS)
def test_yaw_survives_the_quaternion(yaw):
    pose = Pose(position_m=(0.0, 0.0, 0.0), orientation_wxyz=orientation_from_yaw(yaw))
    assert pose.yaw_rad == pytest.approx(yaw, abs=1e-9)


@given(YAWS, YAWS)
def test_the_angle_between_two_yaws_is_the_shorter_way(first, second):
    a, b = (
        Pose(position_m=(0.0, 0.0, 0.0), orientation_wxyz=orientation_from_yaw(y)) for y in (first, second)
    )
    turn = abs(first - second) % (2 * math.pi)
    assert angle_rad(a, b) == pytest.approx(min(turn, 2 * math.pi - turn), abs=1e-6)


def test_opposite_quaternions_are_one_orientation():
    a = Pose(position_m=(0.0, 0.0, 0.0), orientation_wxyz=(0.6, 0.0, 0.0, 0.8))
    b = Pose(position_m=(3.0, 4.0, 0.0), orientation_wxyz=(-0.6, 0.0, 0.0, -0.8))
    assert angle_rad(a, b) == 0.0
    assert distance_m(a, b) == 5.0


@pytest.mark.parametrize(
    "quaternion", [(0.0, 0.0, 0.0, 0.0), (1.0, 1.0, 0.0, 0.0), (math.nan, 0.0, 0.0, 0.0)]
)
def test_a_quaternion_must_be_of_unit_length(quaternion):
    with pytest.raises(ValueError, match="it must be 1"):
        Pose(position_m=(0.0, 0.0, 0.0), orientation_wxyz=quaternion)


def test_names_count_up_from_the_class():
    assert free_name("Chair", set()) == "chair1"
    assert free_name("Chair", {"chair1", "chair2"}) == "chair3"
    assert free_name("Coffee_Machine", set()) == "coffee_machine1"


@given(st.text(min_size=1, max_size=30))
def test_every_class_gives_a_valid_name(class_name):
    assert re.match(NAME_PATTERN, free_name(class_name, set()))


@pytest.mark.parametrize(
    ("value", "radians"), [(-3, -3.0), (math.tau, math.tau), ("450deg", math.pi / 2), ("7rad", 7 - math.tau)]
)
def test_an_angle_with_a_unit_is_reduced_to_one_turn(value, radians):
    assert parse_angle(value) == pytest.approx(radians)


@pytest.mark.parametrize(("value", "reason"), [(90, "for degrees write 90deg"), (math.inf, "not an angle")])
def test_a_number_beyond_one_turn_is_no_angle(value, reason):
    with pytest.raises(ValueError, match=reason):
        parse_angle(value)


def test_commands_take_angles_with_a_unit():
    assert codec.convert({"verb": "move", "name": "c", "yaw": "90deg"}, Move).yaw == pytest.approx(
        math.pi / 2
    )
    with pytest.raises(BadRequest, match="the angle 90 exceeds one turn"):
        Move(name="c", yaw=90)


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("chair_3", "chair_3"),
        ("mug 2", "mug_2"),
        ("basket_1/base", "basket_1_base"),
        ("Apple|+01.2", "Apple_01.2"),
        ("Apple|-01.2", "Apple_-01.2"),
        ("003_cracker_box", "_003_cracker_box"),
        ("tazza caffè", "tazza_caffè"),
        ("|+", "_"),
        ("x" * 200, "x" * 120),
    ],
)
def test_other_characters_of_a_name_become_underscores(text, name):
    assert valid_name(text) == name
    assert is_name(name)


def test_a_taken_name_gets_a_number():
    assert valid_name("mug 2", {"mug_2", "mug_2_2"}) == "mug_2_3"


@pytest.mark.parametrize(
    ("roll", "pitch", "yaw"), [(0.0, 0.0, 1.0), (math.pi / 2, 0.0, 0.0), (0.3, -0.7, 2.0), (-3.0, 1.2, -1.0)]
)
def test_roll_and_pitch_precede_the_yaw(roll, pitch, yaw):
    turns = (
        (math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)),
        (math.cos(pitch / 2), 0.0, math.sin(pitch / 2), 0.0),
        (math.cos(roll / 2), math.sin(roll / 2), 0.0, 0.0),
    )
    found = Pose(position_m=(0.0, 0.0, 0.0))
    for turn in turns:
        found = compose(found, Pose(position_m=(0.0, 0.0, 0.0), orientation_wxyz=turn))
    assert found.roll_pitch_rad == pytest.approx((roll, pitch))
    assert found.yaw_rad == pytest.approx(yaw)


@pytest.mark.parametrize(
    ("text", "names"),
    [
        (":cup1", ["cup1"]),
        ("cup1's side, 2.0 cm from the_door-2", ["cup1", "s", "side", "cm", "from", "the_door-2"]),
        ("<http://example.org/map#tasse_für_tee>", ["http", "example.org", "map", "tasse_für_tee"]),
        ("x" * 129, []),
    ],
)
def test_the_names_in_a_text(text, names):
    assert names_in(text) == names
