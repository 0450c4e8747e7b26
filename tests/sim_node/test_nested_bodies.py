"""Nested bodies of an MJCF world: which are separate bodies, and which have joints."""

import mujoco
import pytest

from semmap.nodes.sim_node.body_classes import BodyClasses
from semmap.nodes.sim_node.world import World
from semmap.schemas.scenes import JointOrder, Placement
from tests.household import household_classes
from tests.sim_node.orders import bodies, order, pose

KITCHEN = """<mujoco><compiler angle="radian"/><custom>
<text name="semmap:shut" data="Cabinet"/><text name="semmap:ghost" data="Cup"/>
<text name="semmap-closed:flap" data="upper"/><text name="semmap-closed:nothing" data="lower"/>
<text name="semmap-closed:wheel" data="middle"/>
</custom><worldbody><geom type="plane" size="0 0 .1"/>
<body name="desk" pos="2 0 .5"><geom type="box" size=".8 .4 .5"/>
  <body pos="0 0 .5">
    <body name="microwave_1" pos="0 0 .2"><geom type="box" size=".3 .2 .2"/>
      <body name="leaf"><joint name="door" pos=".3 -.22 0" axis="0 0 -1" range="-2 0"/>
        <geom type="box" size=".29 .01 .19" pos="0 -.22 .01" mass="1"/></body>
    </body>
  </body>
  <body name="shut" pos="0 .5 0"><joint name="flap" axis="0 0 1" range="0 1.5" frictionloss=".1"/>
    <geom type="box" size=".1 .1 .1" mass="1"/></body>
  <body name="cup 2"><geom type="box" size=".1 .1 .1" pos="0 0 2"/></body>
</body>
<body name="arm" pos="-2 0 1"><joint name="wheel" type="hinge"/><geom type="box" size=".1 .1 .1" mass="1"/>
  <body name="hand" pos="0 0 .3"><joint name="wrist" type="ball"/><geom type="sphere" size=".1"/></body>
</body>
</worldbody></mujoco>"""


@pytest.fixture
def kitchen() -> World:
    return World(mujoco.MjSpec.from_string(KITCHEN), classes=BodyClasses(household_classes()))


def test_by_a_text_or_a_name_like_a_class_a_part_is_a_body_of_its_own(kitchen):
    found = {name: (body.class_, body.part_of) for name, body in bodies(kitchen).items()}
    assert found == {
        "desk": ("Desk", ""),
        "microwave_1": ("Microwave", "desk"),
        "shut": ("Cabinet", "desk"),
        "cup_2": ("Cup", "desk"),
        "arm": ("Object", ""),
    }


def test_what_is_left_out_and_what_is_declared_in_vain_is_named(kitchen):
    assert set(kitchen.left_out) == {"leaf", "hand", "a nameless part of desk"}
    assert kitchen.ignored == [
        "ghost (no such body)",
        "nothing (no such joint)",
        "wheel (closed at 'middle'; use lower or upper)",
    ]


def test_a_joint_is_of_the_nearest_body_that_it_moves_or_is_part_of(kitchen):
    found = {name: [joint.name for joint in body.joints] for name, body in bodies(kitchen).items()}
    assert found == {
        "desk": [],
        "cup_2": [],
        "microwave_1": ["door"],
        "shut": ["flap"],
        "arm": ["wheel", "wrist"],
    }


def test_which_end_is_closed_is_told_by_a_text_or_where_it_stands_at_first(kitchen):
    there = bodies(kitchen)
    (door,), (flap,) = there["microwave_1"].joints, there["shut"].joints
    assert (door.closed, door.openness) == (0.0, 0.0)
    assert (flap.closed, flap.openness) == (1.5, 1.0)


def test_a_joint_without_limits_and_a_ball_open_nothing(kitchen):
    wheel, wrist = bodies(kitchen)["arm"].joints
    assert (wheel.kind, wheel.opens) == ("hinge", False)
    assert (wrist.kind, wrist.opens, wrist.position) == ("ball", False, 0.0)
    kitchen.data.qpos[kitchen.model.joint("wrist").qposadr[0] :][:4] = (0.0, 1.0, 0.0, 0.0)
    assert bodies(kitchen)["arm"].joints[1].position == pytest.approx(3.14159, abs=1e-3)


def test_a_door_of_a_foreign_world_opens(kitchen):
    kitchen.step(1.0)
    assert kitchen.move_joints([JointOrder(name="microwave_1", openness=1.0)]).failed == {}
    kitchen.step(3.0)
    (door,) = bodies(kitchen)["microwave_1"].joints
    assert door.position == pytest.approx(-2.0, abs=0.02)
    kitchen.spawn([order("cup1", "cup", pose(0.0, 5.0))])  # everything is recompiled
    there = bodies(kitchen)
    assert there["microwave_1"].joints[0].position == pytest.approx(-2.0, abs=0.02)
    assert there["microwave_1"].pose.position_m == pytest.approx((2.0, -0.015, 1.0), abs=0.02)


def test_what_is_held_is_put_nowhere_and_the_order_counts_as_tried(kitchen):
    before = bodies(kitchen)["microwave_1"].pose
    asked = [Placement(name="microwave_1", pose=pose(0.0, 0.0), commit=9), Placement(name="arm", pose=before)]
    assert kitchen.move(asked).failed == {
        "microwave_1": "microwave_1 is fixed by desk; only its joints can move it",
        "arm": "arm is fixed by its joint; only its joints can move it",
    }
    after = bodies(kitchen)["microwave_1"]
    assert (after.pose, after.commit) == (before, 9)
    kitchen.reset()
    assert bodies(kitchen)["microwave_1"].pose == before


def test_a_thousand_nested_bodies_are_read():
    part = '<body name="part_{}"><geom type="sphere" size=".01"/>'
    chains = "".join(
        "".join(part.format(10 * chain + depth) for depth in range(10)) + 10 * "</body>"
        for chain in range(100)
    )
    floor = '<geom type="plane" size="0 0 .1"/>'
    world = World(mujoco.MjSpec.from_string(f"<mujoco><worldbody>{floor}{chains}</worldbody></mujoco>"))
    assert len(world) + len(world.left_out) == 1000
    assert len(world) == 100


def test_what_has_no_name_is_a_body_if_anything_of_it_moves_and_else_is_told():
    ball = '<body><joint type="ball"/><geom size=".1"/></body>'
    nameless = f'<body pos="0 0 1"><geom size=".1"/>{ball}</body><body><geom size=".1" pos="3 0 0"/></body>'
    world = World(mujoco.MjSpec.from_string(f"<mujoco><worldbody>{nameless}</worldbody></mujoco>"))
    assert list(bodies(world)) == ["body_1"]
    assert [joint.kind for joint in bodies(world)["body_1"].joints] == ["ball"]
    assert world.left_out == ("a nameless part of body_1", "a nameless part of the ground")
