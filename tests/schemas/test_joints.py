"""Openness and joint positions, and their properties in a map."""

import pytest
from msgspec import structs

from semmap.schemas import joints
from semmap.schemas.joints import Joint

DOOR = Joint(name="door", kind="hinge", lower=0.0, upper=1.6, closed=0.0)
LID = Joint(name="lid", kind="hinge", lower=-2.0, upper=0.0, closed=0.0)
KNOB = Joint(name="knob", kind="hinge")
BALL = Joint(name="ball", kind="ball", position=0.3)


def at(joint: Joint, position: float) -> Joint:
    return Joint(
        **{n: getattr(joint, n) for n in ("name", "kind", "lower", "upper", "closed", "switch")},
        position=position,
    )


@pytest.mark.parametrize(
    ("joint", "position", "share"), [(DOOR, 0.4, 0.25), (LID, -2.0, 1.0), (LID, 0.0, 0.0)]
)
def test_openness_is_the_share_of_the_way_from_the_closed_end(joint, position, share):
    assert at(joint, position).openness == pytest.approx(share)
    assert joint.position_at(share) == pytest.approx(position)


def test_beyond_its_limits_a_joint_is_just_open_or_shut():
    assert at(DOOR, 1.7).openness == 1.0
    assert at(DOOR, -0.01).openness == 0.0


def test_what_opens_nothing_has_no_openness():
    assert (KNOB.openness, BALL.openness) == (None, None)
    assert joints.openness([KNOB, BALL]) is None


def test_a_thing_is_as_open_as_the_joint_that_is_open_furthest():
    assert joints.openness([at(DOOR, 0.4), at(LID, -1.0), KNOB]) == pytest.approx(0.5)


def test_positions_are_read_as_they_are_written():
    text = joints.positions_text([at(DOOR, 0.12345), at(LID, -1e-9)])
    assert text == "door=0.123 lid=0"
    assert joints.positions_of(text) == {"door": 0.123, "lid": 0.0}


def test_malformed_positions_are_ignored():
    assert joints.positions_of("door=wide =1 lid 2 hatch=nan cover=-inf flap=0.5") == {"flap": 0.5}


def test_the_most_exact_statement_counts():
    said = {"isOpen": False, "openness": 0.5, "jointPositions": "door=1"}
    assert joints.stated([DOOR, LID], said) == {"door": 1.0}
    del said["jointPositions"]
    assert joints.stated([DOOR, LID, KNOB], said) == {"door": 0.8, "lid": -1.0}
    assert joints.stated([DOOR], {"isOpen": True}) == {"door": 1.6}
    assert joints.stated([DOOR], {"hasColor": ("red",)}) is None


@pytest.mark.parametrize(
    ("joint", "said"),
    [
        (DOOR, "door closed (0 rad)"),
        (at(DOOR, 0.8), "door open to 50% (0.8 rad)"),
        (KNOB, "knob at 0 rad"),
        (
            Joint(name="drawer", kind="slide", lower=0.0, upper=0.4, closed=0.0, position=0.4),
            "drawer open to 100% (0.4 m)",
        ),
    ],
)
def test_joints_as_text(joint, said):
    assert joints.in_words(joint) == said


SWITCH = Joint(name="light", kind="hinge", lower=-0.7, upper=0.0, closed=0.0, switch=True)


def test_a_switch_opens_nothing_and_is_on_from_half_of_its_way():
    assert (SWITCH.opens, SWITCH.openness, joints.openness([SWITCH])) == (False, None, None)
    assert [at(SWITCH, angle).is_on for angle in (0.0, -0.3, -0.36, -0.7)] == [False, False, True, True]
    assert at(SWITCH, -0.35).share == pytest.approx(0.5)
    assert joints.is_on([DOOR]) is None
    assert joints.is_on([DOOR, SWITCH, at(SWITCH, -0.7)]) is True
    assert joints.in_words(at(SWITCH, -0.7)) == "light on (-0.7 rad)"


def test_of_switches_and_of_all_else_the_most_exact_statement_counts():
    both = [DOOR, SWITCH]
    said = {"isOpen": True, "isSwitchedOn": True}
    assert joints.stated(both, said) == {"door": 1.6, "light": -0.7}
    assert joints.stated(both, {**said, "switchPositions": "light=-0.1"}) == {"door": 1.6, "light": -0.1}
    assert joints.stated(both, {"isSwitchedOn": False}) == {"light": 0.0}


def test_switch_assertions_do_not_affect_doors():
    ajar = structs.replace(DOOR, initial=0.2)
    assert joints.wanted([ajar, SWITCH], {"isSwitchedOn": True}) == {"door": 0.2, "light": -0.7}
    assert joints.wanted([ajar, SWITCH], {"openness": 1.0}) == {"door": 1.6, "light": 0.0}
    assert joints.wanted([ajar, SWITCH], {}) == {"door": 0.2, "light": 0.0}
    assert joints.wanted([KNOB], {"isOpen": True}) == {}
