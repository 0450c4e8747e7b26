"""Conversion of commands to the map frame."""

from __future__ import annotations

import math

import pytest

from semmap.nodes.coordinator.frames.conversion import convert_to_map, require_position
from semmap.schemas import errors
from semmap.schemas.commands import Add, Drive, Get, List, Move, Update
from semmap.schemas.entities import Pose, orientation_from_yaw

TURNED = Pose(position_m=(2.0, 1.0, 0.5), orientation_wxyz=orientation_from_yaw(math.pi / 2))
LYING = Pose(position_m=(0.0, 0.0, 1.0), orientation_wxyz=(math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0))
"""Its x points down, its z along the map's x."""


def test_without_an_angle_only_the_position_is_in_the_frame():
    added = convert_to_map(Add(class_="Cup", at=(1.0, 0.0, 0.0), frame="robot1"), TURNED)
    assert added == Add(class_="Cup", at=(2.0, 2.0, 0.5))
    assert convert_to_map(Update(name="c", at=(0.2, 0.0, 0.0), frame="f"), LYING).at == (0.0, 0.0, 0.8)


def test_an_angle_is_in_the_frame_too():
    added = convert_to_map(Add(class_="Cup", at=(1.0, 0.0, 0.0), yaw=0.5, frame="f"), TURNED)
    assert added.yaw is None
    assert added.orientation == pytest.approx(orientation_from_yaw(math.pi / 2 + 0.5), abs=1e-6)
    turned = convert_to_map(Update(name="cup1", yaw=0.0, frame="f"), LYING)
    assert turned.at is None
    assert turned.orientation == pytest.approx(LYING.orientation_wxyz, abs=1e-6)
    moved = convert_to_map(Move(name="cup1", at=(0.0, 1.0, 0.0), yaw=0.0, frame="f"), TURNED)
    assert moved.at == (1.0, 1.0, 0.5)
    assert moved.yaw == pytest.approx(math.pi / 2)
    assert convert_to_map(Move(name="cup1", at=(0.0, 1.0, 0.0), frame="f"), TURNED).yaw is None


def test_a_course_is_in_the_frame_as_it_is_at_the_start():
    course = Drive(name="robot1", to=((1.0, 0.0), (1.0, 1.0)), yaw=0.0, frame="robot1", wait=True)
    driven = convert_to_map(course, TURNED)
    assert driven.to == ((2.0, 2.0), (1.0, 2.0))
    assert (driven.yaw, driven.frame, driven.wait) == (pytest.approx(math.pi / 2), None, True)
    assert convert_to_map(Drive(name="robot1", to=((1.0, 0.0),), frame="f"), TURNED).yaw is None


def test_positions_among_words_are_in_the_frame_and_names_stay():
    asked = convert_to_map(List(near="1,0,0", within=1.0, nearest=2, to="cup1", frame="f"), TURNED)
    assert (asked.near, asked.to, asked.frame) == ("2.0,2.0,0.5", "cup1", None)


@pytest.mark.parametrize(
    ("command", "said"),
    [
        (Add(class_="Cup", frame="f"), "--frame requires --at"),
        (Update(name="c", ref="x", frame="f"), "--frame requires --at"),
        (
            Add(class_="Room", at=(0.0, 0.0, 0.0), extent="POLYGON ((0 0, 1 0, 1 1, 0 0))", frame="f"),
            "an extent",
        ),
        (Drive(name="r", stop=True, frame="f"), "--frame requires --to"),
        (Get(name="c", as_of=3, frame="f"), "either --frame or --as-of"),
        (List(as_of=3, frame="f"), "either --frame or --as-of"),
        (List(format="legacy", frame="f"), "remove --frame"),
    ],
)
def test_invalid_uses_of_a_frame(command, said):
    with pytest.raises(errors.BadRequest, match=said):
        require_position(command)


def test_positions_beyond_the_limit_are_rejected():
    with pytest.raises(errors.BadRequest, match="coordinates are limited to 10,000 m"):
        convert_to_map(Move(name="c", at=(9_999.0, 0.0, 0.0), frame="f"), Pose(position_m=(500.0, 0.0, 0.0)))
