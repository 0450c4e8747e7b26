import math

import pytest

from semmap.nodes.perception_node.tracking.legs import is_leg
from semmap.nodes.perception_node.tracking.overlap import OrientedBox
from semmap.schemas.entities import Pose

TURN = math.pi / 6
CHAIR = (0.45, 0.45, 0.9)


def box(x, y, z, size, yaw=0.0):
    half = yaw / 2.0
    pose = Pose(position_m=(x, y, z), orientation_wxyz=(math.cos(half), 0.0, 0.0, math.sin(half)))
    return OrientedBox(pose, size)


@pytest.mark.parametrize(
    ("piece", "leg"),
    [
        (box(0.21, 0.21, 0.0, (0.04, 0.04, 0.16)), True),
        (box(-0.21, 0.21, 0.0, (0.04, 0.06, 0.08)), True),
        (box(0.0, 0.0, 0.0, (0.08, 0.08, 0.28)), False),  # a bottle below the middle
        (box(0.4, 0.21, 0.0, (0.04, 0.04, 0.16)), False),  # beside it
        (box(0.21, 0.21, 0.45, (0.04, 0.04, 0.16)), False),  # on the seat
        (box(0.21, 0.21, 0.0, (0.2, 0.2, 0.3)), False),  # too stout
        (box(0.21, 0.21, 0.0, (0.08, 0.08, 0.02)), False),  # it lies flat
        (box(0.21, 0.21, 0.0, (0.04, 0.04, 1.5)), False),  # it is taller than the chair
    ],
)
def test_a_leg_is_slender_and_upright_below_a_corner(piece, leg):
    assert is_leg(piece, box(0.0, 0.0, 0.0, CHAIR)) is leg


def test_the_corners_turn_with_the_thing():
    radius = math.hypot(0.21, 0.21)
    turned = math.pi / 4 + TURN
    piece = box(radius * math.cos(turned), radius * math.sin(turned), 0.0, (0.04, 0.04, 0.16))
    assert is_leg(piece, box(0.0, 0.0, 0.0, CHAIR, TURN))
    assert not is_leg(piece, box(0.0, 0.0, 0.0, CHAIR, TURN + math.pi / 4))


def test_what_is_low_or_narrow_has_no_such_legs():
    piece = box(0.1, 0.1, 0.0, (0.04, 0.04, 0.16))
    assert not is_leg(piece, box(0.0, 0.0, 0.0, (0.22, 0.22, 0.9)))
    assert not is_leg(box(0.21, 0.21, 0.0, (0.04, 0.04, 0.16)), box(0.0, 0.0, 0.0, (0.45, 0.45, 0.2)))
