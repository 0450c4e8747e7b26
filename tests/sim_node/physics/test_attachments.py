"""Attached bodies move with their holders, and stay where they are when detached."""

import math

import pytest
from msgspec import structs

from semmap.nodes.sim_node.config import RobotConfig
from semmap.nodes.sim_node.models.sources import Models
from semmap.nodes.sim_node.robots.robot import SHIPPED
from semmap.nodes.sim_node.world import World
from semmap.nodes.sim_node.world_file import open_world
from semmap.schemas.entities import Pose, angle_rad, compose, distance_m, relative
from semmap.schemas.scenes import DriveBase, GripOrder
from tests.sim_node.orders import bodies, hand, order, pose, spawned


@pytest.fixture
def world() -> World:
    world = spawned(
        order("table1", "table", pose(0.0, 0.0)),
        order("tray1", "tray", pose(3.0, 0.0)),
        order("cup1", "cup", pose(3.2, 0.3)),
        order("apple1", "apple", pose(0.0, 0.1, 0.8)),
        order("wall1", "wall", pose(6.0, 0.0), size_m=(0.1, 1.0, 2.0), fixed=True),
    )
    world.step(2.0)
    return world


def held(world: World, name: str, holder: str, **fields: object) -> None:
    assert world.grip([GripOrder(name=name, holder=holder, **fields)]).failed == {}


def off_m(world: World, name: str) -> float:
    """Return the distance of an attached body from its attach pose."""
    there = bodies(world)
    body = there[name]
    return distance_m(body.pose, compose(there[body.held_by].pose, body.grip))


def test_it_is_held_where_it_is_and_sleeps(world):
    before = bodies(world)["cup1"].pose
    held(world, "cup1", "tray1", commit=7)
    world.step(3.0)
    cup = bodies(world)["cup1"]
    assert (cup.held_by, cup.grip_commit) == ("tray1", 7)
    assert cup.grip.position_m == pytest.approx((0.2, 0.3, 0.0), abs=1e-3)
    assert distance_m(cup.pose, before) < 2e-3
    assert cup.resting
    assert world.asleep


def test_it_goes_with_what_holds_it(world):
    held(world, "cup1", "tray1")
    world.move([hand("tray1", pose(0.0, 3.0, 0.5, yaw=math.pi / 2))])
    assert bodies(world)["cup1"].pose.position_m == pytest.approx((-0.3, 3.2, 0.5), abs=2e-3)
    world.step(3.0)
    assert bodies(world)["tray1"].pose.position_m[2] == pytest.approx(0.0, abs=0.01)
    assert off_m(world, "cup1") < 5e-3
    assert not bodies(world)["cup1"].ghost


def test_let_go_it_falls(world):
    held(world, "cup1", "wall1", grip=Pose(position_m=(-0.5, 0.0, 1.0)))
    world.step(2.0)
    assert bodies(world)["cup1"].pose.position_m == pytest.approx((5.5, 0.0, 1.0), abs=5e-3)
    held(world, "cup1", "")
    world.step(2.0)
    cup = bodies(world)["cup1"]
    assert (cup.held_by, cup.grip) == ("", None)
    assert cup.pose.position_m[2] < 0.1
    assert cup.resting


def test_holds_survive_bodies_that_come_and_go(world):
    held(world, "cup1", "tray1", commit=3)
    held(world, "apple1", "cup1")
    world.spawn([order(f"can{i}", "can", pose(0.3 * i, -3.0)) for i in range(12)])
    world.delete(["can3", "table1"])
    world.move([hand("tray1", pose(1.0, 1.0))])
    world.step(2.0)
    there = bodies(world)
    assert (there["cup1"].held_by, there["apple1"].held_by) == ("tray1", "cup1")
    assert max(off_m(world, "cup1"), off_m(world, "apple1")) < 5e-3
    world.delete(["cup1"])
    world.step(2.0)
    assert bodies(world)["apple1"].held_by == ""


def test_reset_leaves_it_in_its_hand(world):
    held(world, "cup1", "tray1")
    world.move([hand("tray1", pose(1.0, 1.0))])
    world.reset()
    world.step(1.0)
    assert bodies(world)["tray1"].pose.position_m[:2] == pytest.approx((3.0, 0.0), abs=5e-3)
    assert off_m(world, "cup1") < 5e-3


def test_the_robot_carries_what_its_gripper_holds():
    at = (7.5, 2.0, 0.0)
    world = open_world(None, Models(), robot=RobotConfig(SHIPPED["porter"], at_m=at, yaw_rad=0.0))
    world.spawn([order("cup1", "cup", pose(7.5, 0.8)), order("apple1", "apple", pose(5.5, 3.0))])
    world.step(1.0)
    held(world, "cup1", "robot1_gripper", grip=Pose(position_m=(0.06, 0.0, 0.0)))
    world.step(1.0)
    assert off_m(world, "cup1") < 0.01
    world.drive(DriveBase(name="robot1", to=((6.5, 2.0),), yaw=None))
    furthest = 0.0
    for _ in range(600):
        world.step(0.02)
        furthest = max(furthest, off_m(world, "cup1"))
        if ended := world.ended():
            break
    assert ended == {"robot1": "there"}
    assert furthest < 0.02
    there = bodies(world)
    cup, gripper = there["cup1"], there["robot1_gripper"]
    assert angle_rad(relative(cup.pose, gripper.pose), cup.grip) < 0.05
    world.step(3.0)
    assert world.asleep


@pytest.mark.parametrize(
    ("name", "holder", "why"),
    [
        ("cup1", "missing", "the scene has no body named missing"),
        ("cup1", "cup1", "cannot attach cup1 to itself"),
        ("wall1", "tray1", "cannot attach wall1: it is a fixed body"),
        ("tray1", "cup1", "cannot attach tray1 to cup1, which is attached to or part of it"),
        ("cup1", "table1", "cup1 is already attached to tray1"),
    ],
)
def test_what_cannot_be_held_is_told(world, name, holder, why):
    held(world, "cup1", "tray1")
    assert world.grip([GripOrder(name=name, holder=holder)]).failed == {name: why}


def test_who_is_held_cannot_be_moved_by_itself(world):
    held(world, "cup1", "tray1")
    why = "cup1 is attached to tray1; to move it, first: semmap detach cup1"
    assert world.move([hand("cup1", pose(1.0, 1.0))]).failed == {"cup1": why}


def test_what_stands_on_a_held_tray_stays_on_it(world):
    world.move([hand("tray1", pose(3.0, 0.0)), hand("cup1", pose(3.0, 0.0, 0.05))])
    world.step(1.0)
    held(world, "tray1", "wall1")
    world.step(1.0)
    assert structs.asdict(bodies(world)["cup1"])["resting"]
    assert bodies(world)["cup1"].pose.position_m == pytest.approx((3.0, 0.0, 0.01), abs=0.01)
