import math

import pytest
from msgspec import structs

from semmap.nodes.extern.phrasing import changed_in_short, pose_text
from semmap.schemas.entities import Pose, orientation_from_yaw
from tests.recorder.messages import entity

HALF = math.sqrt(0.5)


@pytest.mark.parametrize(
    ("orientation", "text"),
    [
        ((1.0, 0.0, 0.0, 0.0), "yaw 0°"),
        (orientation_from_yaw(math.pi / 2), "yaw 90°"),
        ((HALF, HALF, 0.0, 0.0), "yaw 0°, pitch 0°, roll 90°"),
        ((math.cos(0.1), 0.0, math.sin(0.1), 0.0), "yaw 0°, pitch 11°, roll 0°"),
        ((math.cos(0.001), math.sin(0.001), 0.0, 0.0), "yaw 0°"),
    ],
)
def test_a_tilted_pose_has_pitch_and_roll(orientation, text):
    pose = Pose(position_m=(1.0, 2.0, 0.5), orientation_wxyz=orientation)
    assert pose_text(pose) == f"(1.000, 2.000, 0.500) m, {text}"


@pytest.mark.parametrize(
    ("was", "now", "text"),
    [
        (
            {"isOpen": False, "openness": 0.0, "jointPositions": "door=0"},
            {"isOpen": True, "openness": 1.0, "jointPositions": "door=1.57"},
            "isOpen: false → true",
        ),
        (
            {"isOpen": True, "openness": 0.5, "jointPositions": "door=0.8"},
            {"isOpen": True, "openness": 1.0, "jointPositions": "door=1.57"},
            "openness: 0.5 → 1.0",
        ),
        ({"jointPositions": "arm=0"}, {"jointPositions": "arm=1"}, "jointPositions: arm=0 → arm=1"),
        (
            {"isSwitchedOn": False, "switchPositions": "knob=0", "isOpen": False},
            {"isSwitchedOn": True, "switchPositions": "knob=1", "isOpen": True},
            "isOpen: false → true; isSwitchedOn: false → true",
        ),
    ],
)
def test_a_short_label_leaves_out_the_details_of_joints(was, now, text):
    cabinet = entity("cabinet1", "Cabinet")
    before, after = (structs.replace(cabinet, properties=properties) for properties in (was, now))
    assert changed_in_short(before, after) == text


def test_an_unknown_pose_is_none():
    assert pose_text(None) == "none"
