"""Doors move, are stopped, stay where they are left, and survive recompiling."""

import math

import mujoco
import pytest
from msgspec import structs

from semmap.nodes.sim_node.world import World
from semmap.schemas.scenes import JointOrder
from tests.sim_node.orders import bodies, hand, order, pose, spawned


def opened(world: World, name: str = "fridge1", **order_) -> dict[str, float]:
    """Return the openness of each joint once all is at rest."""
    assert world.move_joints([JointOrder(name=name, **order_)]).failed == {}
    world.step(4.0)
    return {joint.name: joint.openness for joint in bodies(world)[name].joints}


@pytest.fixture
def world() -> World:
    world = spawned(order("fridge1", "fridge", pose(0.0, 0.0)))
    world.step(1.0)
    return world


def test_a_door_opens_in_motion_and_rests_only_then(world):
    world.move_joints([JointOrder(name="fridge1", joint="door")])
    seen = []
    for _ in range(30):
        world.step(0.1)
        fridge = bodies(world)["fridge1"]
        seen.append((fridge.joints[0].openness, fridge.resting))
    shares = [share for share, _ in seen]
    assert shares == sorted(shares)
    assert any(0.2 < share < 0.8 for share in shares)
    assert not any(resting for share, resting in seen if share < 0.97)
    assert seen[-1] == (pytest.approx(1.0, abs=0.01), True)
    assert fridge.joints[1].openness == pytest.approx(0.0, abs=0.01)  # the freezer's stays shut
    assert fridge.pose.position_m == pytest.approx((0.0, 0.0, 0.0), abs=0.01)


def test_it_stays_where_it_is_left_and_sleeps(world):
    assert opened(world, openness=0.5) == pytest.approx({"door": 0.5, "freezer": 0.5}, abs=0.01)
    assert world.asleep
    world.step(60.0)
    assert bodies(world)["fridge1"].joints[0].openness == pytest.approx(0.5, abs=0.01)
    assert opened(world, openness=0.0) == pytest.approx({"door": 0.0, "freezer": 0.0}, abs=0.01)


def test_joints_of_one_body_may_be_ordered_one_by_one_in_a_batch(world):
    door, freezer = (JointOrder(name="fridge1", joint=name, openness=0.5) for name in ("door", "freezer"))
    overridden = structs.replace(door, openness=1.0)
    assert world.move_joints([overridden, door, freezer]).failed == {}
    world.step(4.0)
    joints = bodies(world)["fridge1"].joints
    assert {j.name: j.openness for j in joints} == pytest.approx({"door": 0.5, "freezer": 0.5}, abs=0.01)


def test_what_is_in_the_way_stops_it(world):
    world.spawn([order("wall1", "wall", pose(0.6, 0.0), size_m=(0.1, 1.0, 2.0), fixed=True)])
    share = opened(world, joint="door")["door"]
    assert 0.05 < share < 0.9
    assert bodies(world)["fridge1"].resting


def test_joints_survive_bodies_that_come_and_go(world):
    opened(world, openness=0.5)
    world.spawn([order("fridge2", "fridge", pose(3.0, 0.0)), order("cup1", "cup", pose(1.0, 0.0))])
    there = bodies(world)
    assert there["fridge1"].joints[0].openness == pytest.approx(0.5, abs=0.01)
    assert there["fridge2"].joints[0].openness == 0.0
    world.delete(["fridge2"])
    assert bodies(world)["fridge1"].joints[0].openness == pytest.approx(0.5, abs=0.01)
    assert world.snapshot()[0].nbody == world.model.nbody


def test_a_body_is_made_as_open_as_the_map_says():
    asked = order("fridge1", "fridge", pose(0.0, 0.0))
    world = World()
    world.spawn([structs.replace(asked, properties={"jointPositions": "door=1 freezer=9"})])
    door, freezer = bodies(world)["fridge1"].joints
    assert door.position == pytest.approx(1.0)
    assert freezer.position == freezer.upper  # not beyond its limits


def test_a_hand_that_carries_it_leaves_its_doors_as_they_are(world):
    opened(world, openness=0.5)
    world.move([hand("fridge1", pose(2.0, 1.0))])
    world.step(2.0)
    assert bodies(world)["fridge1"].joints[0].openness == pytest.approx(0.5, abs=0.03)


@pytest.mark.parametrize("angles", ["radian", "degree"])
def test_a_fixed_one_opens_too_whatever_the_unit_of_the_world(angles):
    floor = '<worldbody><geom type="plane" size="0 0 1"/></worldbody>'
    ground = mujoco.MjSpec.from_string(f'<mujoco><compiler angle="{angles}"/>{floor}</mujoco>')
    world = World(ground)
    world.spawn([order("fridge1", "fridge", pose(0.0, 0.0), fixed=True)])
    assert bodies(world)["fridge1"].joints[0].upper == pytest.approx(math.radians(100.0))
    assert opened(world, openness=1.0) == pytest.approx({"door": 1.0, "freezer": 1.0}, abs=0.01)


@pytest.mark.parametrize(
    ("asked", "why"),
    [
        ({"name": "missing"}, "no body named missing"),
        ({"name": "cup1"}, "no joint that opens"),
        ({"name": "fridge1", "joint": "lid"}, "no joint named lid that can be moved; it has: door, freezer"),
    ],
)
def test_what_cannot_be_moved_is_told(world, asked, why):
    world.spawn([order("cup1", "cup", pose(1.0, 0.0))])
    assert why in world.move_joints([JointOrder(**asked)]).failed[asked["name"]]


def test_an_order_to_leave_all_as_it_is_moves_nothing(world):
    world.move_joints([JointOrder(name="fridge1", positions={}, commit=7)])
    world.step(1.0)
    fridge = bodies(world)["fridge1"]
    assert fridge.joint_commit == 7
    assert fridge.joints[0].openness < 0.01


def test_poses_tell_joints_in_the_order_of_the_bodies(world):
    world.spawn([order("cup1", "cup", pose(1.0, 0.0)), order("fridge2", "fridge", pose(3.0, 0.0))])
    opened(world, "fridge2", joint="door")
    told = world.poses()
    assert [round(position, 2) for position in told.joints] == [0.0, 0.0, 1.75, 0.0]
    assert len(told.joint_commits) == 2


def test_a_door_that_has_arrived_rests_at_once(world):
    world.move_joints([JointOrder(name="fridge1", joint="door", openness=0.5)])
    seen = []
    for _ in range(300):
        world.step(0.01)
        seen.append((world.poses().joints[0], all(world.poses().resting)))
    end = seen[-1][0]
    assert end == pytest.approx(math.radians(50.0), abs=0.004)
    arrived = next(i for i, (position, _) in enumerate(seen) if abs(position - end) < 0.001)
    rested = next(i for i, (_, rests) in enumerate(seen) if rests)
    assert arrived - 1 <= rested <= arrived + 2
    assert all(rests for _, rests in seen[rested:])
