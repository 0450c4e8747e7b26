"""A robot and its parts are followed in one commit, so that none of it stays behind."""

from concurrent.futures import Future

import pytest
from msgspec import structs

from nodes.coordinator.config import CoordinatorConfig
from nodes.coordinator.scene import reconciler
from nodes.coordinator.scene.reconcile import order
from nodes.coordinator.scene.reconciler import Keeping
from schemas import commands as c
from schemas.entities import Pose
from schemas.joints import Joint
from tests.coordinator.conftest import at_once
from tests.coordinator.scene.test_reconciler import standing

ARM = Joint(name="arm", kind="hinge", lower=-1.0, upper=1.0)


@pytest.fixture
def keeping(door):
    """A robot with a gripper and a hand at that, which drove by a metre, and a chair that was pushed."""
    keeping = Keeping(CoordinatorConfig("map"), door, at_once(door), lambda call: Future(), lambda text: None)
    keeping.scene.known = True
    for name in ("robot1", "gripper1", "hand1", "chair1"):
        door.change(c.Add(class_="Chair", name=name, at=(0.0, 0.0, 0.0)))
    for name, entity in door.map.entities.items():
        body = standing(order(entity, entity.pose))
        whole = {"gripper1": "robot1", "hand1": "gripper1"}.get(name, "")
        there = Pose(position_m=(1.0, 0.0, 0.0))
        body = structs.replace(body, robot=name != "chair1", part_of=whole, pose=there, entity=False)
        keeping.scene.bodies[name] = body
    return keeping


def have(keeping: Keeping, name: str, **what: object) -> None:
    keeping.scene.bodies[name] = structs.replace(keeping.scene.bodies[name], **what)


def stands_at_m(door, name: str) -> float:
    return door.map.entity(name).pose.position_m[0]


@pytest.mark.parametrize("moving", ["robot1", "gripper1", "hand1"])
def test_it_is_followed_whole_once_all_of_it_rests(door, keeping, moving):
    have(keeping, moving, resting=False)
    seq = door.map.seq
    keeping.keep()
    assert door.map.seq == seq + 1  # the chair's
    assert {stands_at_m(door, name) for name in ("robot1", "gripper1", "hand1")} == {0.0}
    assert not keeping.in_agreement()
    have(keeping, moving, resting=True)
    keeping.keep({moving})
    assert door.map.seq == seq + 2
    assert {stands_at_m(door, name) for name in ("robot1", "gripper1", "hand1")} == {1.0}
    keeping.keep()
    assert door.map.seq == seq + 2
    assert keeping.in_agreement()


def test_how_its_joints_stand_is_in_that_commit(door, keeping):
    have(keeping, "robot1", joints=(structs.replace(ARM, position=0.5),))
    seq = door.map.seq
    keeping.keep({"robot1"})
    assert door.map.seq == seq + 1
    assert door.map.entity("robot1").properties["jointPositions"] == "arm=0.5"
    assert stands_at_m(door, "hand1") == 1.0


def test_the_joints_of_a_part_come_too(door, keeping):
    for name in ("robot1", "gripper1"):
        have(keeping, name, joints=(structs.replace(ARM, position=0.5),))
    keeping.keep()
    keeping.keep()
    for name in ("robot1", "gripper1"):
        assert door.map.entity(name).properties["jointPositions"] == "arm=0.5"


def test_an_arm_that_never_rests_is_not_waited_for(door, keeping, monkeypatch):
    have(keeping, "hand1", resting=False)
    monkeypatch.setattr(reconciler, "_CALM_S", 0.0)
    keeping.keep()
    assert [stands_at_m(door, name) for name in ("robot1", "gripper1", "hand1")] == [1.0, 1.0, 0.0]
