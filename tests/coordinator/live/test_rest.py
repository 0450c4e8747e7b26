from __future__ import annotations

from semmap.nodes.coordinator.live.rest import STILL_S, Rest
from semmap.schemas.entities import Pose, orientation_from_yaw


def at(x: float, yaw: float = 0.0) -> Pose:
    return Pose(position_m=(x, 0.0, 0.0), orientation_wxyz=orientation_from_yaw(yaw))


def test_it_rests_after_a_second_in_one_place():
    rest = Rest(at(0.0), 10.0)
    assert not rest.holds(10.0 + STILL_S - 0.01)
    assert rest.holds(10.0 + STILL_S)


def test_noise_does_not_wake_it():
    rest = Rest(at(0.0), 0.0)
    for i in range(100):
        rest.take(at(0.01 * (-1) ** i, 0.01 * (-1) ** i), 0.02 * i)
    assert rest.holds(2.0)


def test_a_moving_or_turning_entity_does_not_rest():
    moving, turning = Rest(at(0.0), 0.0), Rest(at(0.0), 0.0)
    for i in range(200):
        moving.take(at(0.002 * i), 0.02 * i)  # 10 cm a second
        turning.take(at(0.0, 0.01 * i), 0.02 * i)
    assert not moving.holds(4.0)
    assert not turning.holds(4.0)
