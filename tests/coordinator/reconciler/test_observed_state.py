"""Observed poses and joints, as a change of the map and in words."""

from __future__ import annotations

import pytest
from msgspec import structs

from semmap.nodes.coordinator.reconciler.observed_state import (
    ObservedState,
    commits_of,
    describe_joint_change,
    joint_statements,
)
from semmap.schemas.entities import Pose, orientation_from_yaw
from semmap.schemas.joints import Joint
from tests.coordinator.reconciler.test_reconcile import entity, provenance

HERE = Pose(position_m=(1.0, 2.0, 0.0), orientation_wxyz=orientation_from_yaw(1.0))
THERE = Pose(position_m=(3.0, 2.0, 0.0))


def door(position, name="door1"):
    return Joint(name=name, kind="hinge", lower=0.0, upper=2.0, closed=0.0, position=position)


def knob(position, initial=0.0):
    return Joint(
        name="knob1",
        kind="hinge",
        lower=0.0,
        upper=1.0,
        closed=0.0,
        switch=True,
        position=position,
        initial=initial,
    )


BALL = Joint(name="neck1", kind="hinge", position=0.25)


@pytest.mark.parametrize(
    ("joints", "stated"),
    [
        ((), {}),
        ((door(0.0),), {"isOpen": "false", "openness": "0", "jointPositions": "door1=0"}),
        ((door(1.0),), {"isOpen": "true", "openness": "0.5", "jointPositions": "door1=1"}),
        ((door(0.24691),), {"isOpen": "true", "openness": "0.123", "jointPositions": "door1=0.247"}),
        ((knob(1.0),), {"isSwitchedOn": "true", "switchPositions": "knob1=1"}),
        ((knob(0.0),), {"isSwitchedOn": "false", "switchPositions": "knob1=0"}),
        ((BALL,), {"jointPositions": "neck1=0.25"}),
        (
            (door(2.0), knob(1.0)),
            {
                "isOpen": "true",
                "openness": "1",
                "jointPositions": "door1=2",
                "isSwitchedOn": "true",
                "switchPositions": "knob1=1",
            },
        ),
    ],
)
def test_a_map_states_how_joints_stand(joints, stated):
    said = {one.property: one.values for one in joint_statements(joints)}
    assert said == {name: (value,) for name, value in stated.items()}


@pytest.mark.parametrize(
    ("joints", "before", "words"),
    [
        ((door(0.0),), {"isOpen": True}, "was closed"),
        ((door(1.0),), {}, "was opened to 50%"),
        ((door(2.0),), {"isOpen": False}, "was opened to 100%"),
        ((BALL,), {}, "stands at neck1=0.25"),
        ((knob(1.0),), {}, "was switched on"),
        ((knob(1.0),), {"isSwitchedOn": False}, "was switched on"),
        ((knob(0.0, initial=1.0),), {"isSwitchedOn": True}, "was switched off"),
        ((knob(0.7),), {"isSwitchedOn": True}, "has knob1=0.7"),
        ((knob(0.3),), {}, "has knob1=0.3"),
        ((knob(0.3),), {"isSwitchedOn": True}, "was switched off"),
        ((door(1.0), knob(1.0)), {}, "was opened to 50% and was switched on"),
        ((door(1.0), knob(0.0)), {}, "was opened to 50%"),
        ((door(0.0), knob(1.0)), {}, "was switched on"),
        ((door(0.004), knob(1.0)), {}, "was switched on"),
        ((door(0.006), knob(1.0)), {}, "was closed and was switched on"),
        ((door(0.0), knob(0.0)), {}, "was closed and was switched off"),
    ],
)
def test_only_changed_joints_are_described(joints, before, words):
    assert describe_joint_change(joints, before) == words


CHAIR = structs.replace(
    entity("chair1", HERE, posed=3),
    joint_provenance=provenance(4),
    switch_provenance=provenance(5),
    grip_provenance=provenance(6),
)


def test_the_commits_are_known_that_what_is_stated_comes_from():
    assert commits_of(CHAIR) == (3, 5, 6)
    assert commits_of(structs.replace(CHAIR, switch_provenance=None)) == (3, 4, 6)
    assert commits_of(entity("chair1", None)) == (-1, -1, -1)


def test_an_edit_has_what_the_scene_knows_of_each():
    entities = {name: entity(name, HERE) for name in ("chair1", "oven1", "cup1", "fork1")}
    settled = ObservedState.of(
        entities,
        {"chair1": THERE},
        {"oven1": (door(1.0),)},
        grips={"cup1": ("hand1", None), "fork1": ("", None)},
    )
    assert settled.names == ("oven1", "chair1", "cup1", "fork1")
    oven, chair, cup, fork = settled.edits(entities)
    assert (oven.name, oven.at, oven.orientation, oven.unset) == ("oven1", None, None, ())
    assert oven.set == joint_statements((door(1.0),))
    assert (chair.at, chair.orientation) == (THERE.position_m, THERE.orientation_wxyz)
    assert (chair.set, chair.unset) == ((), ())
    assert ([(s.property, s.values) for s in cup.set], cup.unset) == ([("isGraspedBy", ("hand1",))], ())
    assert (fork.set, [s.property for s in fork.unset]) == ((), ["isGraspedBy", "graspPose"])


@pytest.mark.parametrize(
    ("meanwhile", "is_edited"),
    [
        ({}, True),
        ({"reference_provenance": provenance(9)}, True),
        ({"pose_provenance": provenance(9)}, False),
        ({"joint_provenance": provenance(9)}, False),
        ({"grip_provenance": provenance(9)}, False),
    ],
    ids=["nothing", "named", "moved", "opened", "taken"],
)
def test_entities_that_were_changed_since_are_not_edited(meanwhile, is_edited):
    settled = ObservedState.of({"chair1": CHAIR}, {"chair1": THERE})
    now = {"chair1": structs.replace(CHAIR, **meanwhile)}
    assert [edit.name for edit in settled.edits(now)] == (["chair1"] if is_edited else [])


def test_an_edit_has_the_size_of_a_body_of_another_world():
    chair = entity("chair1", HERE)
    observed = ObservedState.of({"chair1": chair}, {}, sizes_m={"chair1": (1.0, 2.0, 3.0)})
    (edit,) = observed.edits({"chair1": chair})
    assert (observed.names, edit.size, edit.at) == (("chair1",), (1.0, 2.0, 3.0), None)


def test_entities_that_were_removed_since_are_left_out():
    both = {"chair1": CHAIR, "chair2": structs.replace(CHAIR, name="chair2")}
    settled = ObservedState.of(both, dict.fromkeys(both, THERE))
    assert [edit.name for edit in settled.edits({"chair2": both["chair2"]})] == ["chair2"]
