"""Sleep of two free MuJoCo boxes and a floor that never wakes."""

import mujoco
import numpy as np
import pytest

from semmap.nodes.sim_node.physics import sleep

BOXES = """<mujoco><option><flag sleep="enable"/></option><worldbody>
  <geom type="plane" size="0 0 1"/>
  <body name="a" pos="0 0 0.1"><freejoint/><geom type="box" size="0.1 0.1 0.1"/></body>
  <body name="b" pos="3 0 0.1"><freejoint/><geom type="box" size="0.1 0.1 0.1"/></body>
</worldbody></mujoco>"""
TREES = np.array([0, 1, -1])


@pytest.fixture
def scene():
    model = mujoco.MjModel.from_xml_string(BOXES)
    data = mujoco.MjData(model)
    return model, data


@pytest.fixture
def lulled(scene):
    model, data = scene
    mujoco.mj_step(model, data, nstep=1000)
    return model, data


def test_bodies_that_have_stood_for_a_while_sleep_and_what_has_no_tree_always_does(scene):
    model, data = scene
    mujoco.mj_step(model, data)
    assert not sleep.all_asleep(data)
    assert sleep.awake(data) == 2
    assert sleep.sleeping(data, TREES).tolist() == [False, False, True]
    assert sleep.asleep_or_ready(data, TREES).tolist() == [False, False, True]
    mujoco.mj_step(model, data, nstep=1000)
    assert sleep.all_asleep(data)
    assert sleep.awake(data) == 0
    assert sleep.sleeping(data, TREES).tolist() == [True, True, True]
    assert sleep.asleep_or_ready(data, TREES).tolist() == [True, True, True]


def test_one_that_is_woken_is_awake_with_the_next_step_and_the_other_sleeps_on(lulled):
    model, data = lulled
    sleep.wake(data, 0)
    assert not sleep.all_asleep(data)
    assert sleep.awake(data) == 1
    assert sleep.asleep_or_ready(data, TREES).tolist() == [False, True, True]
    mujoco.mj_step(model, data)
    assert sleep.sleeping(data, TREES).tolist() == [False, True, True]


def test_one_that_is_about_to_sleep_stays_awake_when_it_is_woken(lulled):
    model, data = lulled
    for tree in (0, 1):
        sleep.wake(data, tree)
    mujoco.mj_step(model, data)
    assert sleep.asleep_or_ready(data, TREES).tolist() == [False, False, True]
    sleep.let_sleep(data, TREES)
    assert sleep.asleep_or_ready(data, TREES).tolist() == [True, True, True]
    sleep.wake(data, 1)
    mujoco.mj_step(model, data)
    assert sleep.sleeping(data, TREES).tolist() == [True, False, True]


def test_what_has_no_tree_is_not_woken(lulled):
    _, data = lulled
    sleep.wake(data, -1)
    assert sleep.all_asleep(data)


@pytest.mark.parametrize("push", ["a force", "a speed"])
def test_what_is_pushed_does_not_sleep(lulled, push):
    _, data = lulled
    if push == "a force":
        data.xfrc_applied[1, 0] = 1.0
    else:
        data.qvel[0] = 1.0
    assert not sleep.all_asleep(data)
