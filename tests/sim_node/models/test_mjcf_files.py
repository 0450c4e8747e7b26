"""A user's MJCF models have joints, and notes on what is omitted."""

import math

import pytest

from semmap.nodes.sim_node.models.parts import Role
from semmap.nodes.sim_node.models.sources import Models
from semmap.nodes.sim_node.models.write_shapes import own_notes, own_shapes
from semmap.nodes.sim_node.world import World
from semmap.schemas.scenes import JointOrder
from tests.sim_node.orders import bodies, order, pose

CHEST = """<mujoco>
  <custom><text name="semmap-closed:lid hinge" data="upper"/></custom>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="chest">
      <freejoint/>
      <geom type="box" size="0.2 0.3 0.01" pos="0 0 0.01"/>
      <geom type="box" size="0.01 0.3 0.1" pos="-0.19 0 0.12"/>
      <geom type="box" size="0.2 0.01 0.1" pos="0 -0.29 0.12"/>
      <geom type="box" size="0.2 0.01 0.1" pos="0 0.29 0.12"/>
      <body name="lid" pos="-0.2 0 0.22">
        <joint name="lid hinge" type="hinge" axis="0 1 0" range="-100 0"/>
        <geom type="box" size="0.2 0.3 0.01" pos="0.2 0 0.01"/>
        <body name="knob" pos="0.2 0 0.03">
          <joint name="turn" type="hinge" axis="0 0 1" range="-10 10"/>
          <geom type="sphere" size="0.01"/>
        </body>
      </body>
      <body name="drawer" pos="0 0 0.03">
        <joint type="slide" axis="1 0 0" range="0 0.2" frictionloss="2"/>
        <geom type="box" size="0.17 0.27 0.005" pos="0 0 0"/>
        <geom type="box" size="0.005 0.27 0.08" pos="0.18 0 0.08"/>
        <geom type="box" size="0.005 0.27 0.08" pos="-0.165 0 0.08"/>
        <geom type="box" size="0.17 0.005 0.08" pos="0 0.265 0.08"/>
        <geom type="box" size="0.17 0.005 0.08" pos="0 -0.265 0.08"/>
      </body>
    </body>
  </worldbody>
</mujoco>"""

ODD = """<mujoco>
  <worldbody>
    <body name="base">
      <geom type="box" size="0.1 0.1 0.1"/>
      <body name="wheel" pos="0 0 0.15">
        <joint name="spin" type="hinge" axis="0 0 1"/>
        <geom type="cylinder" size="0.08 0.02"/>
      </body>
      <body name="ball" pos="0.2 0 0">
        <joint name="socket" type="ball"/>
        <geom name="tip" type="sphere" size="0.03"/>
      </body>
      <body name="table" pos="0 0.3 0">
        <joint name="along" type="slide" axis="1 0 0" range="-0.1 0.1"/>
        <joint name="across" type="slide" axis="0 1 0" range="-0.1 0.1"/>
        <geom type="box" size="0.05 0.05 0.05"/>
      </body>
    </body>
  </worldbody>
  <tendon><fixed name="string"><joint joint="along" coef="1"/></fixed></tendon>
  <actuator><motor name="motor" joint="spin"/><motor joint="along"/></actuator>
  <equality><joint joint1="along" joint2="across"/></equality>
</mujoco>"""

HUNG = """<mujoco><worldbody>
  <body name="arm"><joint name="shoulder" type="hinge" axis="0 0 1" range="-90 90"/>
    <geom type="box" size="0.2 0.02 0.02" pos="0.2 0 0.1"/>
    <body name="hand" pos="0.4 0 0.1"><joint name="wrist" type="hinge" axis="0 1 0" range="0 90"/>
      <geom type="box" size="0.05 0.02 0.02" pos="0.05 0 0"/></body>
  </body>
</worldbody></mujoco>"""


@pytest.fixture
def folder(tmp_path):
    for name, text in {"chest": CHEST, "odd": ODD, "hung": HUNG}.items():
        (tmp_path / f"{name}.xml").write_text(text)
    return tmp_path


def joints(model):
    return {leaf.joint.name: leaf.joint for leaf in model.leaves}


def test_a_lid_and_a_drawer_come_with_their_limits(folder):
    found = joints(Models(folder)("chest", None))
    assert found.keys() == {"lid_hinge", "drawer"}
    lid, drawer = found["lid_hinge"], found["drawer"]
    assert (lid.kind, lid.range, lid.closed) == ("hinge", pytest.approx((math.radians(-100), 0.0)), 0.0)
    assert (drawer.kind, drawer.range, drawer.closed) == ("slide", pytest.approx((0.0, 0.2)), 0.0)
    assert drawer.friction >= 2.0
    assert Models(folder)("chest", None).notes == (
        "turn does not move, because lid_hinge already moves that body",
    )


def test_a_text_says_which_end_is_closed(folder):
    (folder / "chest.xml").write_text(CHEST.replace('data="upper"', 'data="lower"'))
    assert joints(Models(folder)("chest", None))["lid_hinge"].closed == pytest.approx(math.radians(-100))


@pytest.mark.parametrize("size_m", [None, (0.8, 0.6, 0.25)])
def test_it_opens_in_the_simulator(folder, size_m):
    world = World(models=Models(folder))
    assert world.spawn([order("chest1", "chest", pose(0.0, 0.0), size_m=size_m)]).failed == {}
    world.step(1.0)
    for share in (1.0, 0.0):
        assert world.move_joints([JointOrder(name="chest1", openness=share)]).failed == {}
        world.step(4.0)
        chest = bodies(world)["chest1"]
        assert [joint.openness for joint in chest.joints] == pytest.approx([share, share], abs=0.02)
        assert chest.resting
    if size_m:
        assert chest.joints[1].upper == pytest.approx(
            0.2 * size_m[0] / Models(folder)("chest", None).size_m[0]
        )


def test_joints_that_open_nothing_are_told_and_what_cannot_come_is_said(folder):
    odd = Models(folder)("odd", None)
    assert joints(odd).keys() == {"spin", "along"}
    assert joints(odd)["spin"].range is None
    assert odd.notes == (
        "socket does not move, because it is a ball joint",
        "across does not move, because along already moves that body",
        "1 tendon (string) omitted",
        "2 actuators (motor) omitted",
        "1 equality constraint omitted",
    )
    world = World(models=Models(folder))
    assert world.spawn([order("odd1", "odd", pose(0.0, 0.0))]).failed == {}
    world.step(1.0)
    spin, _ = bodies(world)["odd1"].joints
    assert spin.openness is None
    assert world.move_joints([JointOrder(name="odd1", positions={"spin": 7.0})]).failed == {}
    world.step(8.0)
    assert bodies(world)["odd1"].joints[0].position == pytest.approx(7.0, abs=0.02)


def test_what_everything_hangs_on_moves_nothing(folder):
    assert joints(Models(folder)("hung", None)).keys() == {"wrist"}
    assert Models(folder)("hung", None).notes == ()


def test_the_knowledge_base_is_told_of_them(folder):
    shape = own_shapes(folder)["chest"]
    assert [leaf.name for leaf in shape.leaves] == ["lid_hinge", "drawer"]
    (tray,) = shape.leaves[1].interiors
    assert tray.high[0] - tray.low[0] == pytest.approx(0.34, abs=0.03)
    assert shape.leaves[1].limits == pytest.approx((0.0, 0.2))


def test_notes_are_told_of_those_files_that_are_a_class_s_model(folder):
    (folder / "broken.xml").write_text("<mujoco")
    assert own_notes(folder, {"chest", "hung", "broken"}) == [
        "chest.xml: turn does not move, because lid_hinge already moves that body"
    ]
    (told,) = own_notes(folder, {"odd.xml"})
    assert told.endswith(
        "because along already moves that body; 1 tendon (string) omitted;"
        " 2 actuators (motor) omitted; 1 equality constraint omitted"
    )


COLOURED = """<mujoco>
  <asset><material name="green" rgba="0 1 0 1"/><material name="blue" rgba="0 0 1 1"/></asset>
  <worldbody><body name="block">
    <geom type="box" size="0.1 0.1 0.1" material="green" rgba="1 0 0 1"/>
    <geom type="box" size="0.1 0.1 0.1" pos="0 0 0.2" material="blue"/>
    <geom type="box" size="0.1 0.1 0.1" pos="0 0 0.4" rgba="1 0 0 1"/>
    <geom type="sphere" size="0.02" pos="0 0 0.5" rgba="1 1 0 1" contype="0" conaffinity="0"/>
    <geom type="box" size="0.1 0.1 0.25" pos="0 0 0.25" rgba="1 1 1 0"/>
  </body></worldbody>
</mujoco>"""


def test_a_part_has_the_colour_of_its_material_and_collides_or_is_seen_as_in_the_file(tmp_path):
    (tmp_path / "block.xml").write_text(COLOURED)
    parts = Models(tmp_path)("block", None).parts
    assert [(part.role, part.colour) for part in parts] == [
        (Role.BOTH, (0.0, 1.0, 0.0)),
        (Role.BOTH, (0.0, 0.0, 1.0)),
        (Role.BOTH, (1.0, 0.0, 0.0)),
        (Role.VISUAL, (1.0, 1.0, 0.0)),
        (Role.COLLISION, (1.0, 1.0, 1.0)),
    ]
