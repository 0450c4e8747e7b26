"""Accepted and rejected orders."""

import pytest

from semmap.nodes.sim_node.models.library import build as library_model
from semmap.nodes.sim_node.order_validation import (
    REACH_M,
    joint_targets,
    validate_grips,
    validate_moves,
    validate_spawn,
)
from semmap.schemas.entities import Pose
from semmap.schemas.joints import Joint
from semmap.schemas.scenes import GripOrder, JointOrder, Placement
from tests.sim_node.orders import hand, order, pose
from tests.sim_node.test_bodies import record


def test_each_order_is_accepted_or_has_a_reason():
    accepted, failed = validate_spawn(
        [
            order("cup1", "cup", pose(1, 2), commit=7),
            order("cup1", "cup", pose(3, 0)),
            order("table1", "table", pose(0, 0)),
            order("far", "cup", pose(9000, 0)),
            order("huge", "cup", pose(2, 0), size_m=(1000.0, 1.0, 1.0)),
        ],
        library_model,
        taken=lambda name: name == "table1",
    )
    record, model = accepted.pop("cup1")
    assert accepted == {}
    assert (record.ordered, record.commit, record.shape_commit) == (pose(1, 2), 7, 7)
    assert (record.size_m, record.model) == (model.size_m, model.name)
    assert set(failed) == {"cup1", "table1", "far", "huge"}
    assert "twice" in failed["cup1"]
    assert "already" in failed["table1"]
    assert "9000 m from the origin" in failed["far"]
    assert "1000 m" in failed["huge"]


@pytest.mark.parametrize(("x", "is_accepted"), [(REACH_M, True), (REACH_M + 1.0, False)])
def test_a_body_may_be_a_kilometre_away_and_no_farther(x, is_accepted):
    accepted, failed = validate_spawn([order("cup1", "cup", pose(x, 0))], library_model, lambda _: False)
    assert ("cup1" in accepted, "cup1" in failed) == (is_accepted, not is_accepted)


@pytest.mark.parametrize(("commit", "entity"), [(0, False), (1, True)])
def test_with_commit_0_a_body_is_the_worlds_own(commit, entity):
    accepted, _ = validate_spawn(
        [order("cup1", "cup", pose(0, 0), commit=commit)], library_model, lambda _: False
    )
    assert accepted["cup1"][0].entity is entity
    assert accepted["cup1"][0].joint_commit == commit


def test_the_frame_of_a_body_is_its_centre_of_mass():
    accepted, _ = validate_spawn([order("cup1", "cup", pose(0, 0))], library_model, lambda _: False)
    made, model = accepted["cup1"]
    assert made.origin_m == pytest.approx([-value for value in model.inertial.centre_m])
    assert len(made.masks) == len(model.parts)


def test_a_body_that_opens_has_its_joints_shut_unless_the_map_says_otherwise():
    accepted, _ = validate_spawn([order("fridge1", "fridge", pose(0, 0))], library_model, lambda _: False)
    made, model = accepted["fridge1"]
    assert [joint.name for joint in made.joints] == [leaf.joint.name for leaf in model.leaves]
    assert made.joint_names == ("fridge1/freezer", "fridge1/door") or made.joint_names == (
        "fridge1/door",
        "fridge1/freezer",
    )
    for joint, leaf in zip(made.joints, model.leaves, strict=True):
        assert (joint.lower, joint.upper) == leaf.joint.range
        assert joint.position == joint.closed == leaf.joint.closed


def cabinet(**more):
    joints = (
        Joint(name="door", kind="hinge", lower=0.0, upper=2.0, closed=0.0),
        Joint(name="drawer", kind="slide", lower=-0.5, upper=0.0, closed=0.0),
        Joint(name="knob", kind="hinge", lower=0.0, upper=1.0, closed=0.0, switch=True),
        Joint(name="wheel", kind="hinge"),
        Joint(name="gimbal", kind="ball"),
    )
    return record("cabinet1", joints=joints, **more)


def targets(*orders):
    return joint_targets(orders, {"cabinet1": cabinet(), "stone1": record("stone1")})


@pytest.mark.parametrize(
    ("asked", "expected"),
    [
        ({}, {"door": 2.0, "drawer": -0.5}),
        ({"openness": 0.25}, {"door": 0.5, "drawer": -0.125}),
        ({"openness": 0.0}, {"door": 0.0, "drawer": 0.0}),
        ({"openness": 0.5, "joint": "door"}, {"door": 1.0}),
        ({"openness": 1.0, "joint": "knob"}, {"knob": 1.0}),
        ({"positions": {"door": 1.5, "drawer": -0.2}}, {"door": 1.5, "drawer": -0.2}),
        ({"positions": {"door": 9.0, "drawer": -9.0}}, {"door": 2.0, "drawer": -0.5}),
        ({"positions": {"door": -9.0}}, {"door": 0.0}),
        ({"positions": {"wheel": 9.0, "gimbal": 1.0}}, {"wheel": 9.0}),
        ({"positions": {"door": 1.0, "knob": 1.0}, "joint": "door"}, {"door": 1.0}),
    ],
    ids=str,
)
def test_joints_go_where_they_are_ordered_within_their_limits(asked, expected):
    accepted, failed = targets(JointOrder(name="cabinet1", **asked))
    assert failed == {}
    assert accepted["cabinet1"] == pytest.approx(expected)


def test_of_several_orders_about_one_joint_the_last_counts():
    accepted, _ = targets(
        JointOrder(name="cabinet1", openness=1.0),
        JointOrder(name="cabinet1", openness=0.5, joint="door"),
    )
    assert accepted["cabinet1"] == pytest.approx({"door": 1.0, "drawer": -0.5})


@pytest.mark.parametrize(
    ("asked", "why"),
    [
        ({"name": "x"}, "the scene has no body named x"),
        ({"name": "stone1"}, "stone1 has no joint that opens"),
        ({"name": "stone1", "joint": "lid"}, "no joint named lid that can be moved; it has: none"),
        ({"name": "cabinet1", "joint": "lid"}, "it has: door, drawer, knob, wheel, gimbal"),
        ({"name": "cabinet1", "joint": "gimbal"}, "no joint named gimbal that can be moved"),
        ({"name": "cabinet1", "joint": "wheel", "openness": 1.0}, "no joint that opens"),
    ],
    ids=str,
)
def test_what_does_not_open_has_a_reason(asked, why):
    accepted, failed = targets(JointOrder(**asked))
    assert not any(accepted.values())
    assert why in failed[asked["name"]]


def test_what_cannot_be_moved_has_a_reason():
    first, last = hand("cup1", pose(1, 0)), Placement(name="cup1", pose=pose(2, 0), commit=3)
    there = {
        "cup1": record("cup1"),
        "can1": record("can1"),
        "door1": record("door1", anchored=True, joints=(Joint(name="hinge1", kind="hinge"),)),
        "chair1": record("chair1", anchored=True),
        "lid1": record("lid1", anchored=True, part_of="pot1"),
        "ring1": record("ring1", held_by="hand1"),
    }
    stays = [hand(name, pose(0, 0)) for name in ("x", "door1", "chair1", "lid1", "ring1")]
    accepted, failed = validate_moves([first, *stays, hand("can1", pose(0, 2000)), last], there)
    assert accepted == [first, last]
    assert "no body named x" in failed["x"]
    assert "position is 2000 m from the origin; the limit is 1000 m" in failed["can1"]
    assert failed["door1"] == "door1 is fixed by its joint; only its joints can move it"
    assert failed["chair1"] == "chair1 is fixed by the body around it; only its joints can move it"
    assert failed["lid1"] == "lid1 is fixed by pot1; only its joints can move it"
    assert "semmap detach ring1" in failed["ring1"]


THERE = {
    "hand1": record("hand1", part_of="robot1"),
    "robot1": record("robot1"),
    "cup1": record("cup1"),
    "ring1": record("ring1", held_by="hand1", grip=Pose(position_m=(0.0, 0.0, 0.0))),
    "wall1": record("wall1", fixed=True),
    "door1": record("door1", anchored=True, joints=(Joint(name="hinge1", kind="hinge"),)),
    "lid1": record("lid1", anchored=True, part_of="pot1"),
}


@pytest.mark.parametrize(
    ("asked", "why"),
    [
        ({"name": "x", "holder": "hand1"}, "no body named x"),
        ({"name": "cup1", "holder": "x"}, "no body named x"),
        ({"name": "cup1", "holder": "cup1"}, "to itself"),
        (
            {"name": "robot1", "holder": "hand1"},
            "cannot attach robot1 to hand1, which is attached to or part of it",
        ),
        (
            {"name": "hand1", "holder": "ring1"},
            "cannot attach hand1 to ring1, which is attached to or part of it",
        ),
        ({"name": "wall1", "holder": "hand1"}, "cannot attach wall1: it is a fixed body"),
        ({"name": "door1", "holder": "hand1"}, "it is fixed by its joint"),
        ({"name": "lid1", "holder": "hand1"}, "it is fixed by pot1"),
        ({"name": "ring1", "holder": "robot1"}, "ring1 is already attached to hand1"),
    ],
    ids=str,
)
def test_what_cannot_be_held_has_a_reason(asked, why):
    accepted, failed = validate_grips([GripOrder(**asked)], THERE)
    assert accepted == []
    assert why in failed[asked["name"]]


@pytest.mark.parametrize(
    "asked",
    [
        {"name": "cup1", "holder": "hand1"},
        {"name": "cup1", "holder": ""},
        {"name": "wall1", "holder": ""},
        {"name": "ring1", "holder": "hand1"},
        {"name": "ring1", "holder": "robot1", "commit": 4},
    ],
    ids=["taken", "let go", "never held", "held already", "the map has another hold it"],
)
def test_these_may_be_held_or_let_go(asked):
    wanted = GripOrder(**asked)
    assert validate_grips([wanted], THERE) == ([wanted], {})
