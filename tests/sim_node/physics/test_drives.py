"""Moving joints: limited speed and force, until they arrive or are blocked."""

import mujoco
import numpy as np
import pytest

from semmap.nodes.sim_node.bodies import BodyIndex
from semmap.nodes.sim_node.physics.drives import STEPS_A_PUSH, Drives
from semmap.schemas.joints import Joint
from tests.sim_node.test_bodies import record

SCENE = """<mujoco>
  <option timestep="0.002" integrator="{integrator}"><flag eulerdamp="{eulerdamp}"/></option>
  <worldbody>
    <body name="box" pos="0 0 1">
      <geom type="box" size="0.1 0.1 0.1" contype="0" conaffinity="0"/>
      <body name="leaf">
        <joint name="door" type="hinge" axis="0 0 1" pos="0 0.3 0" frictionloss="0.2" damping="0.05"/>
        <geom type="box" size="0.01 0.3 0.4" mass="3" contype="0" conaffinity="0"/>
      </body>
      <body name="tray">
        <joint name="drawer" type="slide" axis="0 0 1" frictionloss="0.2"/>
        <geom type="box" size="0.2 0.2 0.1" mass="{mass}" contype="0" conaffinity="0"/>
      </body>
    </body>
    {wall}
  </worldbody>
</mujoco>"""
NAMES = ("door", "drawer")
EULER = {"integrator": "Euler", "eulerdamp": "enable"}


def scene(wall="", mass=2.0, **how):
    model = mujoco.MjModel.from_xml_string(SCENE.format(wall=wall, mass=mass, **EULER | how))
    data = mujoco.MjData(model)
    joints = (Joint(name="door", kind="hinge"), Joint(name="drawer", kind="slide"))
    box = record("box", fixed=True, joints=joints, joint_names=NAMES)
    return model, data, BodyIndex.of(model, {"box": box}, {"box": 1})


def until_done(drives, model, data, index, most_s=10.0):
    """Return the rows that arrived, the maximum speed (2,), and the time."""
    arrived, fastest = [], np.zeros(2)
    while drives and data.time < most_s:
        mujoco.mj_forward(model, data)
        arrived += drives.push(model, data, index)
        mujoco.mj_step(model, data, nstep=STEPS_A_PUSH)
        fastest = np.maximum(fastest, np.abs(data.qvel))
    return arrived, fastest, data.time


@pytest.mark.parametrize(
    "how",
    [
        {},
        {"integrator": "implicitfast"},
        {"integrator": "RK4"},
        {"eulerdamp": "disable"},
    ],
    ids=str,
)
@pytest.mark.parametrize("share", [1.0, -1.0])
def test_joints_arrive_exactly_and_no_faster_than_they_may(how, share):
    model, data, index = scene(**how)
    damping = model.dof_damping.copy()
    drives = Drives()
    assert not drives
    drives.begin({"door": share * 1.2, "drawer": share * 0.4}, 0.0)
    assert drives
    assert drives.rows(index) == [0, 1]
    arrived, fastest, took_s = until_done(drives, model, data, index)
    assert sorted(arrived) == [0, 1]
    assert data.qpos == pytest.approx((share * 1.2, share * 0.4), abs=0.005)
    assert 1.2 < fastest[0] < 1.7
    assert 0.4 < fastest[1] < 0.6
    assert 0.8 < took_s < 2.5
    assert model.dof_damping == pytest.approx(damping)  # as it was
    assert not drives


def test_a_drawer_is_held_against_its_own_weight():
    model, data, index = scene(mass=40.0)
    drives = Drives()
    drives.begin({"drawer": 0.4}, 0.0)
    arrived, fastest, _ = until_done(drives, model, data, index)
    assert arrived == [1]
    assert fastest[1] < 0.6


def test_one_that_is_there_already_arrives_at_once_and_exactly():
    model, data, index = scene()
    data.qpos[:] = 0.003, 0.0005
    data.qvel[:] = 1.0
    drives = Drives()
    drives.begin({"door": 0.0, "drawer": 0.0}, 0.0)
    assert drives.push(model, data, index) == [0, 1]
    assert data.qpos.tolist() == [0.0, 0.0]
    assert data.qvel.tolist() == [0.0, 0.0]
    assert not drives


def test_one_that_something_stops_is_let_go_of_where_it_is():
    model, data, index = scene()
    drives = Drives()
    drives.begin({"door": 1.2}, 0.0)
    for _ in range(100):
        mujoco.mj_forward(model, data)
        assert drives.push(model, data, index) == []
        if not drives:
            break
        data.time += 0.01  # and it does not move
    assert 0.4 < data.time < 0.45
    assert data.qpos[0] == 0.0
    assert data.qfrc_applied[0] == 0.0
    assert model.dof_damping[0] == pytest.approx(0.05)


def test_a_drive_that_is_begun_anew_goes_to_the_newer_place():
    model, data, index = scene()
    drives = Drives()
    drives.begin({"door": 1.2}, 0.0)
    mujoco.mj_forward(model, data)
    drives.push(model, data, index)
    drives.begin({"door": -0.3}, data.time)
    assert model.dof_damping[0] == pytest.approx(0.05)
    until_done(drives, model, data, index)
    assert data.qpos[0] == pytest.approx(-0.3, abs=0.005)


def test_drives_can_be_stopped_one_by_one():
    model, data, index = scene()
    drives = Drives()
    drives.begin({"door": 1.2, "drawer": 0.4}, 0.0)
    mujoco.mj_forward(model, data)
    drives.push(model, data, index)
    drives.stop(["door", "unknown"])
    assert drives.rows(index) == [1]
    assert model.dof_damping[0] == pytest.approx(0.05)


def test_after_another_compilation_the_joint_is_braked_in_the_new_model():
    model, data, index = scene()
    drives = Drives()
    drives.begin({"door": 1.2}, 0.0)
    drives.push(model, data, index)
    braked = model.dof_damping[0]
    assert braked == pytest.approx(0.05 + 1.0 / 1.5)
    drives.push(model, data, index)
    assert model.dof_damping[0] == braked  # once only
    again, data, index = scene()
    drives.push(again, data, index)
    assert again.dof_damping[0] == pytest.approx(braked)


def test_the_joints_of_a_body_that_is_gone_are_forgotten():
    model, data, _ = scene()
    drives = Drives()
    drives.begin({"door": 1.2}, 0.0)
    nothing = BodyIndex.of(model, {}, {})
    assert drives.rows(nothing) == []
    assert drives.push(model, data, nothing) == []
    assert not drives
