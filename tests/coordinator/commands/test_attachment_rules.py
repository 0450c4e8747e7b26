"""Which entity can be attached to which, with which contents, and at which pose."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec import structs

from semmap.nodes.coordinator.commands import attachment_rules
from semmap.schemas import errors
from semmap.schemas.attachments import pose_text
from semmap.schemas.entities import Pose, compose, distance_m, orientation_from_yaw
from tests.coordinator.reconciler.test_reconcile import body, entity, provenance

HERE = Pose(position_m=(1.0, 2.0, 0.0))


def thing(name, *, held_by="", part_of="", grip=None, since=1, **fields):
    """A chair that is attached since a commit, if given."""
    properties = {"isDirectPartOf": part_of} if part_of else {}
    if held_by:
        properties["isGraspedBy"] = held_by
    if grip is not None:
        properties["graspPose"] = pose_text(grip)
    return structs.replace(
        entity(name, HERE),
        properties=properties,
        grip_provenance=provenance(since) if held_by else None,
        **fields,
    )


def by_name(*entities):
    return {one.name: one for one in entities}


@pytest.mark.parametrize(
    ("word", "names", "meant"),
    [
        ("robot1/gripper", ("robot1_gripper",), "robot1_gripper"),
        ("robot1", ("robot1",), "robot1"),
        ("robot1/hand", ("robot1_gripper",), "robot1/hand"),
        ("a/b", ("a/b", "a_b"), "a/b"),
    ],
)
def test_a_part_may_be_named_with_a_slash(word, names, meant):
    assert attachment_rules.resolve_name(word, dict.fromkeys(names)) == meant


CUP, HAND = thing("cup1"), thing("hand1")
REFUSED = {
    "a place is not held": (
        thing("kitchen1", place=True),
        HAND,
        {},
        "kitchen1 is a place; only objects can be attached to each other",
    ),
    "a place holds nothing": (
        CUP,
        thing("kitchen1", place=True),
        {},
        "kitchen1 is a place; only objects can be attached to each other",
    ),
    "itself": (CUP, CUP, {}, "cup1 cannot be attached to itself"),
    "its own holder": (
        CUP,
        thing("hand1", held_by="cup1"),
        {},
        "hand1 is attached to cup1, so cup1 cannot be attached to it",
    ),
    "its own whole": (
        CUP,
        thing("hand1", part_of="cup1"),
        {},
        "hand1 is part of cup1, so cup1 cannot be attached to it",
    ),
    "another's": (
        thing("cup1", held_by="hand2"),
        HAND,
        {},
        "cup1 is already attached to hand2; first: semmap detach cup1",
    ),
    "fixed in the map": (
        thing("cup1", fixed=True),
        HAND,
        {},
        "cup1 is fixed, so it cannot be attached",
    ),
    "fixed in the scene": (
        CUP,
        HAND,
        {"cup1": structs.replace(body("cup1", HERE), fixed=True)},
        "cup1 is fixed, so it cannot be attached",
    ),
    "a part in the scene": (
        CUP,
        HAND,
        {"cup1": structs.replace(body("cup1", HERE), part_of="oven1")},
        "cup1 is part of oven1 and cannot be separated from it",
    ),
}


@pytest.mark.parametrize(("held", "holder", "bodies", "why"), REFUSED.values(), ids=REFUSED)
def test_an_impossible_attachment_is_rejected_with_the_reason(held, holder, bodies, why):
    with pytest.raises(errors.Refused) as refused:
        attachment_rules.require_attachable(held, holder, by_name(held, holder), bodies)
    assert str(refused.value) == why


def test_a_robot_cannot_be_attached_to_its_attached_object():
    robot, gripper, cup = (
        thing("robot1"),
        thing("gripper1", part_of="robot1"),
        thing("cup1", held_by="gripper1"),
    )
    with pytest.raises(errors.Refused, match=r"^cup1 moves with robot1, so robot1 cannot be attached to it$"):
        attachment_rules.require_attachable(robot, cup, by_name(robot, gripper, cup), {})


@pytest.mark.parametrize(
    ("held", "bodies"),
    [
        (CUP, {}),
        (CUP, {"cup1": body("cup1", HERE)}),
        (CUP, {"hand1": structs.replace(body("hand1", HERE), fixed=True)}),
        (thing("cup1", held_by="hand1"), {}),
    ],
    ids=["not in the scene", "free in the scene", "by what is fixed", "held by it already"],
)
def test_a_free_object_can_be_attached(held, bodies):
    attachment_rules.require_attachable(held, HAND, by_name(held, HAND), bodies)


def test_contents_are_the_supported_objects_that_can_be_attached():
    tray = thing("tray1")
    there = by_name(
        tray,
        HAND,
        thing("cup1"),
        thing("screw1", fixed=True),
        thing("straw1", held_by="cup1"),
        thing("spoon1"),
        thing("knob1"),
    )
    bodies = {"knob1": structs.replace(body("knob1", HERE), part_of="tray1"), "cup1": body("cup1", HERE)}
    borne = ("cup1", "screw1", "straw1", "unknown1", "spoon1", "knob1")
    assert attachment_rules.find_load(borne, tray, HAND, there, bodies) == ("cup1", "spoon1")


def test_an_object_is_not_attached_to_its_own_contents():
    table, robot, gripper = thing("table1"), thing("robot1"), thing("gripper1", part_of="robot1")
    there = by_name(table, robot, gripper)
    end = "is on or inside table1, so table1 cannot be attached to gripper1"
    for borne, who in (("gripper1",), "gripper1"), (("robot1",), "robot1, which carries gripper1,"):
        with pytest.raises(errors.Refused) as refused:
            attachment_rules.find_load(borne, table, gripper, there, {})
        assert str(refused.value) == f"{who} {end}"


def test_contents_were_attached_in_the_same_commit():
    tray = thing("tray1", held_by="hand1", since=5)
    held = by_name(
        tray,
        thing("spoon1", held_by="tray1", since=5),
        thing("cup1", held_by="tray1", since=5),
        thing("fork1", held_by="tray1", since=4),
        thing("bread1", held_by="hand1", since=5),
    )
    assert attachment_rules.find_attached_with(tray, held) == ("cup1", "spoon1")
    unknown = structs.replace(held["cup1"], grip_provenance=None)
    assert attachment_rules.find_attached_with(tray, {**held, "cup1": unknown}) == ("spoon1",)
    assert attachment_rules.find_attached_with(structs.replace(tray, grip_provenance=None), held) == ()


POSES = st.builds(
    lambda x, y, z, yaw: Pose(position_m=(x, y, z), orientation_wxyz=orientation_from_yaw(yaw)),
    *[st.floats(-50.0, 50.0)] * 3,
    st.floats(-math.pi, math.pi),
)


@given(POSES, POSES)
def test_fixed_objects_and_parts_cannot_be_attached(held, holder):
    grip = attachment_rules.compute_grip(held, holder, None, None)
    again = compose(holder, grip)
    assert distance_m(again, held) < 1e-5
    one = thing("cup1", held_by="hand1", grip=grip)
    there = attachment_rules.attached_pose(one, {"hand1": holder}.get)
    assert distance_m(there, held) < 1e-3


TURNED = Pose(position_m=(3.0, 2.0, 1.0), orientation_wxyz=orientation_from_yaw(0.5))


@pytest.mark.parametrize(
    ("held", "holder", "at", "yaw", "grip"),
    [
        (None, None, None, None, None),
        (TURNED, None, None, 1.0, None),
        (None, HERE, None, None, None),
        (None, None, (1.0, 0.0, 0.0), None, ((1.0, 0.0, 0.0), 0.0)),
        (None, None, (1.0, 0.0, 0.0), 1.0, ((1.0, 0.0, 0.0), 1.0)),
        (TURNED, HERE, None, None, ((2.0, 0.0, 1.0), 0.5)),
        (TURNED, HERE, (0.1, 0.2, 0.3), None, ((0.1, 0.2, 0.3), 0.5)),
        (TURNED, HERE, None, 1.0, ((2.0, 0.0, 1.0), 1.0)),
    ],
)
def test_a_grip_is_the_wanted_or_the_current_relative_pose(held, holder, at, yaw, grip):
    found = attachment_rules.compute_grip(held, holder, at, yaw)
    if grip is None:
        assert found is None
    else:
        position, angle = grip
        assert found.position_m == pytest.approx(position)
        assert found.yaw_rad == pytest.approx(angle)


def test_the_pose_of_an_attached_object_needs_a_known_holder_and_grip():
    gripped = thing("cup1", held_by="hand1", grip=HERE)
    assert attachment_rules.attached_pose(gripped, lambda name: None) is None
    assert attachment_rules.attached_pose(thing("cup1", held_by="hand1"), lambda name: HERE) is None
    assert attachment_rules.attached_pose(thing("cup1", grip=HERE), lambda name: HERE) is None
    assert attachment_rules.attached_pose(gripped, lambda name: HERE).position_m == (2.0, 4.0, 0.0)


def test_an_attached_object_cannot_be_moved():
    attachment_rules.require_detached(CUP)
    with pytest.raises(errors.Refused, match=r"^cup1 is attached to hand1; to move it, first: semmap detach"):
        attachment_rules.require_detached(thing("cup1", held_by="hand1"))


def test_an_entity_with_attached_objects_is_removed_only_with_them():
    held = by_name(
        thing("fork1", held_by="hand1"), thing("cup1", held_by="hand1"), thing("hat1", held_by="head1")
    )
    attachment_rules.require_no_attachments(("cup1",), held)
    attachment_rules.require_no_attachments(("hand1", "cup1", "fork1"), held)
    with pytest.raises(errors.Refused, match=r"^fork1 is attached to hand1; first: semmap detach fork1$"):
        attachment_rules.require_no_attachments(("hand1", "cup1"), held)
    with pytest.raises(
        errors.Refused, match=r"^cup1 and fork1 are attached to hand1; first: semmap detach cup1$"
    ):
        attachment_rules.require_no_attachments(("hand1",), held)


def at(x, y=0.0, z=0.0):
    return Pose(position_m=(x, y, z))


@pytest.mark.parametrize(
    ("cup", "hand", "away"),
    [
        (at(0.0), at(0.7), ""),  # half a metre of each is between their middles
        (at(0.0), at(0.9), "0.4"),
        (at(0.0), at(0.0, 0.0, 0.9), "0.4"),
        (at(0.0), at(4.5), "4"),
        (Pose(position_m=(0.0, 0.0, 0.0), orientation_wxyz=orientation_from_yaw(math.pi / 4)), at(0.9), ""),
        (None, at(9.0), ""),
    ],
)
def test_what_is_out_of_reach_is_not_attached(cup, hand, away):
    poses = {"cup1": cup, "hand1": hand}
    held, holder = (structs.replace(one, size_m=(0.5, 0.5, 0.5)) for one in (CUP, HAND))
    if not away:
        attachment_rules.require_in_reach(held, holder, poses.get, {})
        return
    with pytest.raises(errors.Refused) as told:
        attachment_rules.require_in_reach(held, holder, poses.get, {})
    assert told.value.text == (
        f"cup1 is {away} m away from hand1, farther than 0.3 m;"
        " move it there first, attach it --at a position, or add --force"
    )
    attachment_rules.require_in_reach(thing("cup1", held_by="hand1"), holder, poses.get, {})


def test_the_reach_is_that_of_the_bodies_in_the_scene():
    bodies = {name: body(name, at(x)) for name, x in (("cup1", 0.0), ("hand1", 5.0))}
    with pytest.raises(errors.Refused, match="m away from hand1"):
        attachment_rules.require_in_reach(CUP, HAND, lambda name: HERE, bodies)
