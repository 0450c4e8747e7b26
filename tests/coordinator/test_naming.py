from __future__ import annotations

import math

from nodes.coordinator.naming import DEFAULT_POSITION, free_position
from schemas.entities import Pose, orientation_from_yaw
from tests.coordinator.scene.test_reconcile import entity


def standing(x, y, size, yaw=0.0):
    import msgspec

    pose = Pose(position_m=(x, y, 0.0), orientation_wxyz=orientation_from_yaw(yaw))
    return msgspec.structs.replace(entity("box1", pose), size_m=size)


def test_an_empty_map_gives_the_default_position():
    assert free_position([], None) == DEFAULT_POSITION


def test_the_place_is_beside_what_stands_at_the_default_position():
    x, y, z = free_position([standing(2.0, 2.0, (1.0, 1.0, 1.0))], (0.4, 0.4, 0.4))
    assert z == 0.0
    assert max(abs(x - 2.0), abs(y - 2.0)) >= 0.5 + 0.2
    assert math.hypot(x - 2.0, y - 2.0) < 2.0


def test_a_place_is_found_for_big_things_and_in_crowds():
    crowd = [standing(2.0 + i, 2.0 + j, (1.0, 1.0, 1.0)) for i in range(-40, 40) for j in range(-40, 40)]
    for size in ((1.0, 1.0, 1.0), (1000.0, 1000.0, 1000.0)):
        x, y, _ = free_position(crowd, size)
        assert math.hypot(x - 2.0, y - 2.0) > 40.0


def test_a_rug_is_no_obstacle():
    assert free_position([standing(2.0, 2.0, (2.0, 2.0, 0.01))], None) == DEFAULT_POSITION


def test_a_long_thing_blocks_along_its_length_only():
    beside = [standing(2.0, 3.0, (4.0, 0.2, 0.5))]
    turned = [standing(2.0, 3.0, (4.0, 0.2, 0.5), yaw=math.pi / 2)]
    assert free_position(beside, (0.4, 0.4, 0.4)) == DEFAULT_POSITION
    assert free_position(turned, (0.4, 0.4, 0.4)) != DEFAULT_POSITION
