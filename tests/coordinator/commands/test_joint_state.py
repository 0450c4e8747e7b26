"""A body on a joint without limits is neither open nor closed."""

import pytest

from semmap.nodes.coordinator.commands.joint_state import reserve_for_scene
from semmap.schemas import commands as c
from semmap.schemas import errors
from semmap.schemas.joints import Joint
from tests.coordinator.scene.test_joint_commands import HINGE, SWITCH, body

BALL = Joint(name="neck1", kind="ball")
ELBOW = Joint(name="elbow", kind="hinge", lower=-1.0, upper=1.0)
DOOR = Joint(name="door", kind="hinge", lower=0.0, upper=1.0, closed=0.0)
BODIES = {"thing1": body(DOOR, SWITCH)}
NO = "thing1 has no door, lid or drawer that could be open or shut: its joint"
TOLD = "; for its joint positions, see jointPositions in: semmap get thing1"


@pytest.fixture
def home(dispatcher):
    dispatcher.change(c.Add(class_="Chair", name="thing1", at=(0.0, 0.0, 0.0)))
    return dispatcher


def have(home, *joints):
    home.map.bodies = lambda: {"thing1": body(*joints)}


@pytest.mark.parametrize(
    ("joints", "why"),
    [
        ((BALL,), "neck1 is a ball joint"),
        ((HINGE, SWITCH), "hinge1 has no limits, so it has no closed position"),
        ((ELBOW,), "elbow is that of a robot, or coupled to another joint"),
    ],
)
@pytest.mark.parametrize(
    "command",
    [
        c.Set(name="thing1", property="isOpen", values=(True,)),
        c.Set(name="thing1", property="dm:isOpen", values=(False,)),
        c.Set(name="thing1", property="openness", values=(0.5,)),
        c.Update(name="thing1", set=("isOpen=true",)),
        c.Batch(changes=(c.Set(name="thing1", property="is open", values=(True,)),)),
    ],
)
def test_opening_it_is_rejected_with_the_reason(home, joints, why, command):
    have(home, *joints)
    before = home.map.seq
    with pytest.raises(errors.Refused) as refused:
        home.change(command)
    assert str(refused.value) == f"{NO} {why}{TOLD}"
    assert home.map.seq == before


@pytest.mark.parametrize("joints", [(), (SWITCH,), (BALL, DOOR)])
def test_bodies_that_open_and_unknown_ones_may_be_set(home, joints):
    have(home, *joints)
    home.change(c.Set(name="thing1", property="isOpen", values=(True,)))
    assert home.map.entity("thing1").properties["isOpen"] is True


def test_other_properties_may_be_set(home):
    have(home, BALL)
    home.change(c.Set(name="thing1", property="note", values=("loose",)))
    assert home.map.entity("thing1").properties["note"] == ("loose",)


def test_what_the_scene_determines_is_rejected_with_the_command_to_use(home):
    home.change(c.Add(class_="Chair", name="hand1", at=(2.0, 0.0, 0.0)))
    home.map.reserve = lambda transaction: reserve_for_scene(transaction, BODIES)
    joint, switch = "open thing1, or semmap close", "open thing1 --joint knob1, or semmap close"
    grip = "attach thing1 --to HOLDER, or semmap detach"
    for command, what, how in (
        (c.Set(name="thing1", property="isSwitchedOn", values=(True,)), "isSwitchedOn", switch),
        (c.Set(name="thing1", property="is open", values=(True,)), "isOpen", joint),
        (c.Update(name="thing1", set=("openness=0.5",)), "openness", joint),
        (c.Set(name="thing1", property="jointPositions", values=("door=1",)), "jointPositions", joint),
        (c.Set(name="thing1", property="isGraspedBy", values=("hand1",)), "isGraspedBy", grip),
        (c.Set(name="thing1", property="è tenuto da", values=("hand1",)), "isGraspedBy", grip),
        (c.Set(name="hand1", property="grasps", values=("thing1",)), "isGraspedBy", grip),
        (
            c.Batch(changes=(c.Update(name="hand1", set=("grasps=thing1",)),)),
            "isGraspedBy",
            grip,
        ),
    ):
        before = home.map.seq
        with pytest.raises(errors.Refused) as told:
            home.change(command)
        assert told.value.text == (
            f"{what} of thing1 follows from the scene, which is the source of truth (--truth scene);"
            f" to change it: semmap {how}"
        )
        assert home.map.seq == before


@pytest.mark.parametrize(
    "command",
    [
        c.Set(name="thing1", property="note", values=("red",)),
        c.Update(name="thing1", at=(0.0, 0.0, 1.0)),
        c.Remove(names=("thing1",)),
        c.Set(name="hand1", property="isOpen", values=(True,)),
        c.Set(name="hand1", property="isGraspedBy", values=("thing1",)),
        c.Set(name="thing1", property="isGraspedBy", values=("hand1",), source="scene"),
    ],
)
def test_other_changes_are_of_the_map(home, command):
    home.change(c.Add(class_="Chair", name="hand1", at=(2.0, 0.0, 0.0)))
    home.map.reserve = lambda transaction: reserve_for_scene(transaction, BODIES)
    before = home.map.seq
    home.change(command)
    assert home.map.seq == before + 1
