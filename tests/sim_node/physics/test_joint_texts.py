"""Which joints of a world are switches, and at which end they are off."""

import itertools

import mujoco
import pytest

from semmap.nodes.sim_node.physics.joint_texts import JointTexts
from semmap.nodes.sim_node.world import World
from semmap.schemas.scenes import JointOrder
from tests.sim_node.orders import bodies

STOVE = """<mujoco><compiler angle="radian"/><custom>
<text name="semmap:stove" data="Oven"/><text name="semmap-off:lever" data="upper"/>
<text name="semmap-closed:knob_of_the_lid" data="lower"/><text name="semmap-off:nothing" data="lower"/>
<text name="semmap-off:flame" data="left"/>
</custom><worldbody><geom type="plane" size="0 0 .1"/>
<body name="stove" pos="0 0 .5"><geom type="box" size=".3 .3 .5"/>
  <body name="leaf" pos="-.3 0 0"><joint name="door" axis="0 1 0" range="0 1.5"/>
    <geom type="box" size=".01 .2 .2" mass="1" contype="0" conaffinity="0"/></body>
  <body name="knob 1" pos="-.35 .1 .4"><joint name="dial_1" axis="1 0 0" range="-1.5 0" armature=".1"/>
    <geom type="cylinder" size=".02 .02" mass=".1" contype="0" conaffinity="0"/></body>
  <body name="cooker" pos="0 .1 .6"><joint name="flame" type="slide" axis="0 0 1" range="0 .01"/>
    <geom type="box" size=".05 .05 .005" mass=".1" contype="0" conaffinity="0"/></body>
  <body name="stick" pos="-.35 -.1 .4"><joint name="lever" axis="1 0 0" range="0 1"/>
    <geom type="box" size=".01 .01 .05" mass=".1" contype="0" conaffinity="0"/></body>
  <body name="top" pos="0 -.1 .6"><joint name="knob_of_the_lid" axis="0 1 0" range="0 1"/>
    <geom type="box" size=".05 .05 .005" mass=".1" contype="0" conaffinity="0"/></body>
</body></worldbody>
<equality><joint joint1="flame" joint2="dial_1" polycoef="0 -.0066 0 0 0"/></equality>
</mujoco>"""


@pytest.fixture
def stove() -> World:
    return World(mujoco.MjSpec.from_string(STOVE))


def joints(world):
    return {joint.name: joint for joint in bodies(world)["stove"].joints}


def test_by_a_text_or_by_its_name_a_joint_is_a_switch(stove):
    found = joints(stove)
    assert {name for name, joint in found.items() if joint.switches} == {"dial_1", "lever"}
    assert {name for name, joint in found.items() if joint.opens} == {"door", "knob_of_the_lid"}
    assert (found["lever"].closed, found["lever"].is_on) == (1.0, True)
    assert (found["dial_1"].closed, found["dial_1"].is_on) == (0.0, False)


def test_what_a_switch_moves_opens_nothing(stove):
    flame = joints(stove)["flame"]
    assert (flame.opens, flame.switches, flame.position) == (False, False, 0.0)


def test_what_is_said_in_vain_is_named(stove):
    assert stove.ignored == ["nothing (no such joint)", "flame (off at 'left'; use lower or upper)"]


def test_to_open_it_leaves_its_switches_alone_unless_they_are_named(stove):
    stove.move_joints([JointOrder(name="stove", openness=1.0)])
    stove.step(4.0)
    assert joints(stove)["door"].openness == pytest.approx(1.0, abs=0.02)
    assert joints(stove)["dial_1"].is_on is False
    stove.move_joints([JointOrder(name="stove", joint="dial_1", openness=1.0)])
    stove.step(4.0)
    assert joints(stove)["dial_1"].is_on is True
    assert joints(stove)["flame"].position > 0.005


@pytest.mark.parametrize(
    ("joint", "body", "switch"),
    [
        ("knob_Joint_1", "knob 1", True),
        ("light_switch", "hook", True),
        ("hinge", "lightswitchroot", True),
        ("PowerButton", "panel", True),
        ("door_knob", "leaf", False),
        ("dial", "clock", True),
        ("radial_joint", "wheel", False),
        ("", "lid", False),
    ],
)
def test_words_that_mean_a_switch(joint, body, switch):
    name = f'name="{joint}"' if joint else ""
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><worldbody><body name="{body}"><joint {name}/><geom size=".1"/></body></worldbody></mujoco>'
    )
    assert JointTexts({}, {}).is_switch(model, 0) is switch


@pytest.mark.parametrize("integrator", ["Euler", "RK4", "implicitfast"])
def test_what_is_light_goes_to_its_end_and_no_further(integrator):
    """A switch of 20 g has a ten-thousandth of a door's inertia."""
    option = f'</custom><option integrator="{integrator}"/>'
    world = World(mujoco.MjSpec.from_string(STOVE.replace("</custom>", option)))
    damping = world.model.dof_damping.copy()
    assert world.move_joints([JointOrder(name="stove", joint="lever", openness=0.0)]).failed == {}
    seen = []
    for _ in range(30):
        world.step(0.05)
        seen.append(joints(world)["lever"].position)
    assert seen[-1] == pytest.approx(1.0, abs=0.01)
    assert all(after >= before - 0.01 for before, after in itertools.pairwise(seen))
    assert max(seen) < 1.02
    assert world.model.dof_damping.tolist() == damping.tolist()
