import math

import mujoco
import numpy as np
import pytest

from semmap.nodes.sim_node.models.variety_table import KINDS
from semmap.nodes.sim_node.world import World
from semmap.schemas.entities import Pose, angle_rad, distance_m
from tests.sim_node.orders import hand, order, pose


def poses(world):
    return {b.name: b.pose for b in world.scene().bodies}


def test_every_model_stays_where_it_is_put():
    world = World()
    at = {name: pose(3.0 * (i % 13), 3.0 * (i // 13)) for i, name in enumerate(KINDS)}
    world.spawn([order(name, name, where) for name, where in at.items()])
    world.step(2.0)
    for name, now in poses(world).items():
        assert distance_m(now, at[name]) < 0.004, name
        assert math.degrees(angle_rad(now, at[name])) < 2.0, name
    assert all(b.resting for b in world.scene().bodies)


@pytest.fixture(scope="module")
def flat():
    """Return tables and shelves with 200 things."""
    world = World()
    small = ["can", "cup", "bowl", "book", "bottle", "plate", "glass", "apple", "jar", "cereals"]
    orders = []
    for number in range(20):
        x, y = 2.5 * (number % 5), 2.0 * (number // 5)
        orders.append(order(f"table{number}", "table", pose(x, y)))
        for place in range(9):
            dx, dy = 0.25 * (place % 3 - 1), 0.36 * (place // 3 - 1)
            name = small[(number + place) % len(small)]
            orders.append(order(f"{name}_{number}_{place}", name, pose(x + dx, y + dy, 0.75)))
    world.spawn(orders)
    world.step(2.0)
    return world


def test_two_hundred_things_at_rest_do_not_drift(flat):
    before = poses(flat)
    assert len(before) == 200
    for _ in range(6):
        flat._engine.wake(before)
        assert not flat.asleep
        flat.step(10.0)
    drift = [distance_m(now, before[name]) for name, now in poses(flat).items()]
    assert max(drift) < 0.001
    assert all(b.resting for b in flat.scene().bodies)


def test_a_nudge_next_door_disturbs_nobody(flat):
    before = poses(flat)
    flat.move([hand("can_0_0", pose(1.3, -1.2, 0.3))])
    flat.step(1.0)
    drift = {name: distance_m(now, before[name]) for name, now in poses(flat).items() if name != "can_0_0"}
    assert max(drift.values()) < 0.001


def test_a_stack_of_books_stands():
    world = World()
    world.spawn([order(f"book{i}", "book", pose(0, 0, 0.03 * i, yaw=0.1 * i)) for i in range(8)])
    world.step(3.0)
    for i in range(8):
        assert distance_m(poses(world)[f"book{i}"], pose(0, 0, 0.03 * i)) < 0.003
    assert world.asleep


def test_a_cup_on_a_tray_goes_with_neither():
    world = World()
    world.spawn(
        [
            order("table1", "table", pose(0, 0)),
            order("tray1", "tray", pose(0, 0, 0.75)),
            order("cup1", "cup", pose(0.05, 0.08, 0.76)),
        ]
    )
    world.step(2.0)
    assert poses(world)["cup1"].position_m == pytest.approx((0.05, 0.08, 0.76), abs=0.003)
    world.move([hand("table1", pose(0, 4))])
    world.step(2.0)
    assert poses(world)["cup1"].position_m[2] < 0.1


def test_what_lies_on_a_slope_or_leans_does_not_creep_even_while_nothing_may_sleep():
    world = World()
    slope = math.radians(20)
    tilt = (math.cos(slope / 2), 0.0, math.sin(slope / 2), 0.0)

    def on_slope(across: float) -> Pose:
        return Pose(
            position_m=(0.1 * math.sin(slope), across, 1.0 + 0.1 * math.cos(slope)), orientation_wxyz=tilt
        )

    kinds = ["box", "book", "plate", "can", "cup"]
    leaning = Pose(position_m=(4.95 - math.sin(slope) - 0.02, 0, 0.005), orientation_wxyz=tilt)
    world.spawn(
        [
            order(
                "ramp", "?", Pose(position_m=(0, 0, 1), orientation_wxyz=tilt), size_m=(2, 4, 0.1), fixed=True
            ),
            *(order(kind, kind, on_slope(0.5 * i - 1)) for i, kind in enumerate(kinds)),
            order("wall", "?", pose(5, 0), size_m=(0.1, 2, 2), fixed=True),
            order("board", "?", leaning, size_m=(0.02, 0.3, 1.0)),
        ]
    )
    world.model.opt.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    world.step(2.0)
    before = poses(world)
    world.step(5.0)
    for name in (*kinds, "board"):
        assert distance_m(poses(world)[name], before[name]) < 0.001, name
    assert poses(world)["cup"].position_m[2] > 0.5
    assert angle_rad(poses(world)["board"], leaning) < 0.1


def test_an_apple_does_not_roll_for_ever():
    world = World()
    world.spawn([order("apple1", "apple", pose(0, 0, 0.4))])
    world.data.qvel[:3] = [0.6, 0.0, 0.0]
    world.step(6.0)
    assert world.asleep
    assert 0.0 < poses(world)["apple1"].position_m[0] < 3.0


def test_things_shaken_together_neither_explode_nor_fall_through():
    world = World()
    names = ["can", "book", "cup", "box", "apple"]
    world.spawn(
        [
            order(f"{names[i % 5]}{i}", names[i % 5], pose(0.3 * (i % 5), 0.3 * (i // 5), 0.3))
            for i in range(50)
        ]
    )
    rng = np.random.default_rng(1)
    for _ in range(20):
        world.data.qvel[:] += rng.normal(0.0, 0.5, world.data.qvel.shape)
        world.step(0.05)
    world.step(2.0)
    for name, now in poses(world).items():
        assert -0.05 < now.position_m[2] < 2.0, name
        assert math.hypot(*now.position_m) < 15.0, name


def test_a_body_out_of_bounds_does_not_take_the_world_with_it():
    world = World()
    world.spawn([order("can1", "can", pose(0, 0)), order("can2", "can", pose(1, 0))])
    world.step(0.5)
    world.data.qvel[:3] = 1e200
    world.step(0.5)
    assert distance_m(poses(world)["can2"], pose(1, 0)) < 0.001
    assert all(math.isfinite(v) for v in world.poses().poses)
