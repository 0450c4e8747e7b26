"""What is said where nothing opens."""

import pytest

from nodes.coordinator.scene.opening import _require_joints
from schemas import commands as c
from schemas import errors
from schemas.entities import Pose
from schemas.joints import Joint
from schemas.scenes import Body


def body(*joints):
    return Body(
        name="thing1", class_="Object", model="box",
        pose=Pose(position_m=(0.0, 0.0, 0.0)), size_m=(1.0, 1.0, 1.0),
        fixed=True, entity=True, ghost=False, resting=True, commit=1, shape_commit=1, joints=joints,
    )  # fmt: skip


NO = "thing1 has no door, lid or drawer to open"
HINGE = Joint(name="hinge1", kind="hinge")
SWITCH = Joint(name="knob1", kind="hinge", lower=0.0, upper=1.0, closed=0.0, switch=True)


@pytest.mark.parametrize(
    ("joints", "said"),
    [
        ((), NO),
        ((HINGE,), f"{NO}: its joint hinge1 has no limits, of which one could be the closed one"),
        ((Joint(name="neck1", kind="ball"),), f"{NO}: its joint neck1 is a ball joint"),
        ((HINGE, SWITCH), f"{NO}; to switch it: semmap set thing1 isSwitchedOn true"),
    ],
)
def test_why_nothing_opens_is_told(joints, said):
    with pytest.raises(errors.Refused) as refused:
        _require_joints(c.Open(name="thing1"), body(*joints))
    assert str(refused.value) == said


def test_a_joint_with_limits_opens():
    _require_joints(
        c.Open(name="thing1"), body(Joint(name="door", kind="hinge", lower=0.0, upper=1.0, closed=0.0))
    )
