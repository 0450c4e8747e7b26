import math

import pytest

from semmap.nodes.extern.phrasing import pose_text
from semmap.schemas.entities import Pose, orientation_from_yaw

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


def test_an_unknown_pose_is_none():
    assert pose_text(None) == "none"
