"""Joints are reconciled like poses: the last change wins, and a second pass finds no action."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec import structs

from semmap.nodes.coordinator.reconciler.observed_state import (
    ObservedState,
    describe_joint_change,
    joint_statements,
)
from semmap.nodes.coordinator.reconciler.reconcile import Actions, body_order
from semmap.schemas.entities import Entity
from semmap.schemas.joints import Joint, openness
from semmap.schemas.scenes import Body
from tests.coordinator.reconciler.test_reconcile import at, body, entity, look, provenance

DOOR = Joint(name="door", kind="hinge", lower=0.0, upper=1.6, closed=0.0)


def fridge(commit: int = 1, source: str = "operator", **said) -> Entity:
    known = entity("chair1", at(0.0))
    return structs.replace(
        known, properties=said, joint_provenance=provenance(commit, source) if said else None
    )


def standing(share: float, *, joint_commit: int = 1, resting: bool = True) -> Body:
    door = structs.replace(DOOR, position=DOOR.position_at(share))
    known = body("chair1", at(0.0), resting=resting)
    return structs.replace(known, joints=(door,), joint_commit=joint_commit)


def test_nothing_is_stated_about_a_closed_door_by_default():
    assert look([fridge()], [standing(0.0)]) == Actions()


def test_the_map_follows_a_door_that_was_opened():
    assert look([fridge()], [standing(0.4)]).opened == ("chair1",)
    assert look([fridge(isOpen=False)], [standing(0.4)]).opened == ("chair1",)
    assert look([fridge(openness=0.1, isOpen=True)], [standing(0.4)]).opened == ("chair1",)


def test_it_does_not_follow_one_that_still_moves():
    assert look([fridge()], [standing(0.4, resting=False)]) == Actions()


def test_a_later_statement_is_ordered():
    (wanted,) = look([fridge(2, isOpen=True)], [standing(0.0)]).joints
    assert (wanted.name, wanted.positions, wanted.commit) == ("chair1", {"door": 1.6}, 2)


def test_a_statement_that_already_holds_is_ordered_without_motion():
    """Otherwise a later manual opening would be taken for an earlier one."""
    (wanted,) = look([fridge(2, isOpen=True)], [standing(0.4)]).joints
    assert (wanted.positions, wanted.commit) == ({}, 2)


def test_a_moving_joint_is_ordered_even_at_its_target():
    """It may be closing because of an earlier command."""
    (wanted,) = look([fridge(3, isOpen=True)], [standing(0.9, joint_commit=2, resting=False)]).joints
    assert (wanted.positions, wanted.commit) == ({"door": 1.6}, 3)


def test_commands_are_exact_and_small_manual_changes_are_tolerated():
    (wanted,) = look([fridge(2, isOpen=False, openness=0.0)], [standing(0.015)]).joints
    assert (wanted.positions, wanted.commit) == ({"door": 0.0}, 2)
    assert look([fridge(2, isOpen=False, openness=0.0)], [standing(0.015, joint_commit=2)]) == Actions()


def test_after_an_order_the_reached_position_counts():
    assert look([fridge(2, isOpen=True)], [standing(0.0, joint_commit=2)]).opened == ("chair1",)


def test_a_statement_from_the_scene_is_not_ordered():
    said = fridge(5, "scene", isOpen=True, openness=0.4, jointPositions="door=0.64")
    assert look([said], [standing(0.4)]) == Actions()
    assert look([said], [standing(0.0)]).opened == ("chair1",)


def test_positions_override_openness():
    said = fridge(1, isOpen=True, openness=0.4, jointPositions="door=1.6")
    assert look([said], [standing(1.0)]) == Actions()


def test_under_truth_scene_the_map_always_follows():
    assert look([fridge(9, isOpen=False)], [standing(1.0)], "scene").opened == ("chair1",)


def test_a_body_is_ordered_as_open_as_the_map_says():
    said = fridge(3, isOpen=True, openness=0.4, hasColor=("red",))
    ordered = body_order(said, at(0.0))
    assert ordered.properties == {"isOpen": True, "openness": 0.4}
    assert ordered.commit == 3


@given(st.floats(0.0, 1.0))
def test_once_the_map_has_followed_it_agrees(share):
    there = standing(share)
    settled = ObservedState.of({"chair1": fridge()}, {}, {"chair1": there.joints})
    (edit,) = settled.edits({"chair1": fridge()})
    said = {one.property: _value(one.values[0]) for one in edit.set}
    assert look([fridge(2, "scene", **said)], [there]) == Actions()
    assert said["isOpen"] is (openness(there.joints) > 0.05)


def test_statements_made_since_are_not_overwritten():
    settled = ObservedState.of({"chair1": fridge()}, {}, {"chair1": standing(1.0).joints})
    assert settled.edits({"chair1": fridge(4, isOpen=False)}) == []
    assert settled.edits({}) == []


def test_of_a_joint_that_opens_nothing_only_the_position_is_stated():
    (said,) = joint_statements((Joint(name="knob", kind="hinge", position=0.5),))
    assert (said.property, said.values) == ("jointPositions", ("knob=0.5",))


def _value(text: str) -> bool | float | str:
    if text in ("true", "false"):
        return text == "true"
    try:
        return float(text)
    except ValueError:
        return text


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_a_reset_puts_joints_where_the_map_says(share):
    from semmap.nodes.coordinator.reconciler.reconcile import joint_order

    wanted = joint_order(fridge(2, openness=share), standing(0.25))
    assert wanted.positions == {"door": pytest.approx(1.6 * share)}


KNOB = Joint(name="knob", kind="hinge", lower=-1.5, upper=0.0, closed=0.0, switch=True)


def stove(share: float, door: float = 0.0, *, joint_commit: int = 1) -> Body:
    known = standing(door, joint_commit=joint_commit)
    return structs.replace(
        known, joints=(*known.joints, structs.replace(KNOB, position=KNOB.position_at(share)))
    )


def switched(commit: int = 2, source: str = "operator", **said) -> Entity:
    known = entity("chair1", at(0.0))
    return structs.replace(known, properties=said, switch_provenance=provenance(commit, source))


def test_the_map_follows_a_switch_that_was_turned():
    assert look([fridge()], [stove(1.0)]).opened == ("chair1",)
    said = switched(1, isSwitchedOn=False)
    assert look([said], [stove(0.6)]).opened == ("chair1",)
    assert look([said], [stove(0.4)]) == Actions()
    assert look([said], [stove(0.0, door=0.5)]).opened == ("chair1",)


def test_a_statement_about_a_switch_does_not_move_doors():
    (wanted,) = look([switched(isSwitchedOn=True)], [stove(0.0)]).joints
    assert (wanted.positions, wanted.commit) == ({"door": 0.0, "knob": -1.5}, 2)
    exact = switched(isSwitchedOn=True, switchPositions="knob=-0.9", isOpen=True)
    (wanted,) = look([exact], [stove(0.0)]).joints
    assert wanted.positions == {"door": 1.6, "knob": -0.9}


def test_how_switches_stand_is_stated_apart_from_doors():
    said = {one.property: one.values[0] for one in joint_statements(stove(0.6, door=0.5).joints)}
    assert said == {
        "isOpen": "true",
        "openness": "0.5",
        "jointPositions": "door=0.8",
        "isSwitchedOn": "true",
        "switchPositions": "knob=-0.9",
    }


@pytest.mark.parametrize(
    ("share", "door", "before", "told"),
    [
        (1.0, 0.0, {}, "was switched on"),
        (0.0, 0.0, {"isSwitchedOn": True}, "was switched off"),
        (0.8, 0.0, {"isSwitchedOn": True}, "has knob=-1.2"),
        (0.0, 0.5, {}, "was opened to 50%"),
        (1.0, 0.5, {"isOpen": False}, "was opened to 50% and was switched on"),
    ],
)
def test_only_changes_are_described(share, door, before, told):
    assert describe_joint_change(stove(share, door).joints, before) == told
