"""The engine: bodies get slots or are compiled, keep their state, are stepped, and rest."""

import threading

import mujoco
import numpy as np
import pytest

from semmap.nodes.sim_node.bodies import StoredBody
from semmap.nodes.sim_node.body_classes import BodyClasses
from semmap.nodes.sim_node.models.library import build as library_model
from semmap.nodes.sim_node.order_validation import validate_spawn
from semmap.nodes.sim_node.physics import base_scene
from semmap.nodes.sim_node.physics.engine import Engine
from semmap.nodes.sim_node.vision.view import look_at
from semmap.schemas.entities import Pose, distance_m
from tests.conftest import PATIENCE_S
from tests.sim_node.orders import order, pose

KITCHEN = """<mujoco><worldbody>
  <geom type="plane" size="0 0 1"/>
  <body name="shelf_1" pos="5 0 0.5"><geom type="box" size="0.2 0.5 0.5"/></body>
  <body name="crate" pos="6 0 0.2"><freejoint/><geom type="box" size="0.2 0.2 0.2"/></body>
  <body name="chest" pos="8 0 0.2"><freejoint/><geom type="box" size="0.2 0.2 0.1"/>
    <body name="lid" pos="0 0 0.2"><joint name="hinge" axis="0 1 0" range="0 90"/>
      <geom type="box" size="0.2 0.2 0.02" pos="0 0 0"/></body></body>
</worldbody></mujoco>"""


def engine(*orders, mjcf=None):
    ground = base_scene.bare_floor() if mjcf is None else mujoco.MjSpec.from_string(mjcf)
    made = Engine(ground, lambda: None, BodyClasses(class_map={"lid": "lid"}))
    add(made, *orders)
    return made


def add(engine, *orders, **records):
    accepted, failed = validate_spawn(orders, library_model, engine.has)
    assert failed == {}
    for name, changes in records.items():
        for key, value in changes.items():
            setattr(accepted[name][0], key, value)
    engine.add(list(accepted.values()))


def where(engine, name):
    return engine.poses()[engine.index.row[name], :3]


def asleep(engine, name):
    return engine.data.tree_asleep[engine.index.tree[engine.index.row[name]]] >= 0


def cans(count=3):
    return [order(f"can{i}", "can", pose(float(i), 0.0)) for i in range(count)]


def test_a_small_newcomer_takes_a_slot_and_the_model_stays():
    world = engine(*cans())
    model, revision = world.model, world.revision
    add(world, order("cup1", "cup", pose(0.0, 2.0)))
    assert world.model is model
    assert world.revision == revision + 1
    assert where(world, "cup1") == pytest.approx((0.0, 2.0, 0.0))
    assert not world.resting[world.index.row["cup1"]]


def test_a_newcomer_takes_the_smallest_slot_that_will_do():
    world = engine()
    before = sorted(slot.geoms for slot in world._free_slots if not slot.static)
    add(world, order("can1", "can", pose(0.0, 0.0)))
    assert world._slots["can1"].geoms == before[0]
    assert sorted(slot.geoms for slot in world._free_slots if not slot.static) == before[1:]


def test_what_opens_is_compiled_and_others_keep_their_state():
    world = engine(order("can1", "can", pose(0.0, 0.0, 1.0)))
    world.step(0.1)
    state = world.data.qpos[:7].copy(), world.data.qvel[:6].copy(), world.data.time
    model = world.model
    add(world, order("fridge1", "fridge", pose(3.0, 0.0)))
    assert world.model is not model
    address, dof = world.index.qpos[0], world.index.dof[0]
    assert world.data.qpos[address : address + 7].tolist() == state[0].tolist()
    assert world.data.qvel[dof : dof + 6].tolist() == state[1].tolist()
    assert world.data.time == state[2]


def test_what_leaves_gives_its_slot_back_and_the_rest_stays():
    world = engine(*cans())
    world.step(2.0)
    model, vacant = world.model, len(world._free_slots)
    world.remove(["can1"])
    assert world.model is model
    assert len(world._free_slots) == vacant + 1
    assert world.index.names == ("can0", "can2")
    assert world.resting.tolist() == [True, True]
    assert not world.has("can1")
    assert world.shape("can1") is None


def test_what_opens_is_compiled_away():
    world = engine(order("fridge1", "fridge", pose(3.0, 0.0)), *cans(1))
    model = world.model
    world.remove(["fridge1"])
    assert world.model is not model
    assert len(world.index.joint) == 0


def test_bodies_of_the_world_are_known_and_may_be_taken_away():
    world = engine(mjcf=KITCHEN)
    assert world.index.names == ("shelf_1", "crate", "chest", "lid")
    assert world.has("crate")
    assert world.shape("crate") is None
    assert world.resting.tolist() == [True, False, False, False]
    world.remove(["chest", "lid"])
    assert world.index.names == ("shelf_1", "crate")
    assert not world.has("chest")
    add(world, order("chest", "can", pose(0.0, 0.0)))
    assert world.shape("chest") is not None


def test_a_body_is_put_elsewhere_without_speed():
    world = engine(order("can1", "can", pose(0.0, 0.0, 1.0)))
    world.step(0.2)
    world.put({"can1": pose(3.0, 2.0, 0.5, yaw=1.0)})
    assert where(world, "can1") == pytest.approx((3.0, 2.0, 0.5))
    dof = world.index.dof[0]
    assert world.data.qvel[dof : dof + 6].tolist() == [0.0] * 6
    world.lift(0, 0.25)
    assert where(world, "can1") == pytest.approx((3.0, 2.0, 0.75))


def test_a_fixed_body_hangs_in_the_air_and_is_set_down_by_holding_it_elsewhere():
    world = engine(order("lamp1", "light", pose(0.0, 0.0, 2.0), fixed=True))
    world.step(1.0)
    assert where(world, "lamp1") == pytest.approx((0.0, 0.0, 2.0))
    assert world.resting.tolist() == [True]
    world.hold({"lamp1": pose(1.0, 0.0, 2.0)})
    assert where(world, "lamp1") == pytest.approx((1.0, 0.0, 2.0))
    assert world.index.tree.tolist() == [-1]


def test_a_body_that_turns_into_a_ghost_hangs_and_falls_when_it_is_solid_again():
    world = engine(order("can1", "can", pose(0.0, 0.0, 1.0)))
    world.records["can1"].ghost = True
    world.hold({"can1": pose(0.0, 0.0, 1.0)})
    world.step(0.5)
    assert where(world, "can1")[2] == pytest.approx(1.0)
    world.records["can1"].ghost = False
    world.hold({"can1": pose(0.0, 0.0, 1.0)})
    world.step(0.2)
    assert where(world, "can1")[2] < 0.9


def test_a_body_of_the_world_that_turns_into_a_ghost_hangs_where_it_is_held():
    world = engine(mjcf=KITCHEN)
    world.records["crate"].ghost = True
    world.hold({"crate": pose(6.0, 0.0, 1.0)})
    world.step(0.5)
    assert where(world, "crate") == pytest.approx((6.0, 0.0, 1.0))


def test_bodies_fall_rest_and_sleep_and_then_time_passes_at_once():
    world = engine(*cans(1))
    assert not world.asleep
    assert world.awake > 0
    world.step(2.0)
    assert world.asleep
    assert world.resting.all()
    assert world.data.time == pytest.approx(2.0)
    before = world.poses()
    world.step(1e6)
    assert world.data.time == pytest.approx(1e6 + 2.0)
    assert (world.poses() == before).all()


def test_a_step_lets_just_its_time_pass():
    world = engine(order("can1", "can", pose(0.0, 0.0, 50.0)))
    for duration_s in (0.002, 0.05, 0.052, 0.5):
        before = world.data.time
        world.step(duration_s)
        assert world.data.time - before == pytest.approx(duration_s)


def test_one_that_is_woken_is_awake_and_the_others_sleep_on():
    world = engine(*cans())
    world.step(2.0)
    world.wake(["can1", "missing"])
    assert not world.asleep
    world.step(0.002)
    assert [asleep(world, f"can{i}") for i in range(3)] == [True, False, True]
    assert world.resting.all()  # it has not moved


def test_what_is_taken_in_hand_does_not_rest_before_it_was_still():
    world = engine(*cans(), order("lamp1", "light", pose(0.0, 5.0, 2.0), fixed=True))
    world.step(2.0)
    world.disturb([world.index.row["can1"], world.index.row["lamp1"]])
    assert world.resting.tolist() == [True, False, True, True]
    world.step(0.05)
    assert world.resting[:3].tolist() == [True, False, True]
    world.step(0.5)
    assert world.resting.all()


def test_newcomers_leave_those_who_rest_in_peace():
    world = engine(*cans())
    world.step(2.0)
    add(world, order("fridge1", "fridge", pose(5.0, 5.0)))  # the model is recompiled
    assert world.resting.tolist() == [True, True, True, False]
    world.step(0.004)
    assert [asleep(world, f"can{i}") for i in range(3)] == [True] * 3
    assert world.resting.tolist() == [True, True, True, False]


def test_a_body_whose_motion_runs_out_of_bounds_stops_and_the_others_do_not_mind():
    world = engine(*cans(2))
    world.step(1.0)
    dof = world.index.dof[0]
    world.data.qvel[dof] = np.nan
    world.wake(["can0", "can1"])
    world.step(0.1)
    assert np.isfinite(world.data.qpos).all()
    assert np.isfinite(world.data.qvel).all()
    assert where(world, "can0") == pytest.approx((0.0, 0.0, 0.0), abs=0.01)
    assert where(world, "can1") == pytest.approx((1.0, 0.0, 0.0), abs=0.001)


def test_a_door_that_is_driven_arrives_and_its_body_rests_only_then():
    world = engine(order("fridge1", "fridge", pose(0.0, 0.0)), *cans(0))
    world.step(2.0)
    assert world.asleep
    world.drive("fridge1", {"door": 1.0})
    assert not world.asleep
    assert not world.resting[0]
    world.step(0.2)
    assert not world.resting[0]
    position = world.positions()[world.index.joint_row["fridge1/door"]]
    assert 0.01 < position < 0.9
    world.step(3.0)
    row = world.index.joint_row["fridge1/door"]
    assert world.positions()[row] == pytest.approx(1.0, abs=0.005)
    assert world.positions()[1 - row] == pytest.approx(0.0, abs=0.005)
    assert world.resting.all()
    assert world.asleep


def test_joints_are_put_where_their_record_says_and_their_drive_ends():
    world = engine(order("fridge1", "fridge", pose(0.0, 0.0)))
    world.step(1.0)
    world.drive("fridge1", {"door": 1.0})
    world.step(0.3)
    world.set_joints(["fridge1"])
    assert world.positions() == pytest.approx([0.0, 0.0])
    assert world.data.qvel[world.index.joint_dof].tolist() == [0.0, 0.0]
    world.step(1.0)
    assert world.positions() == pytest.approx([0.0, 0.0], abs=0.01)


def test_an_open_door_stays_open_when_the_model_is_compiled_anew():
    world = engine(order("fridge1", "fridge", pose(0.0, 0.0)), mjcf=KITCHEN)
    world.drive("fridge1", {"door": 1.0})
    world.drive("lid", {"hinge": 0.8})
    world.step(3.0)
    before = world.positions().copy()
    assert before.max() > 0.9
    add(world, order("oven1", "oven", pose(0.0, 3.0)))
    assert world.positions()[: len(before)] == pytest.approx(before)
    assert world.positions()[len(before) :] == pytest.approx([0.0])


def test_what_is_removed_is_no_longer_driven():
    world = engine(order("fridge1", "fridge", pose(0.0, 0.0)))
    world.step(1.0)
    world.drive("fridge1", {"door": 1.0})
    world.remove(["fridge1"])
    world.step(0.1)
    assert world.asleep


def hold(world, name, holder, grip=(0.0, 0.0, 0.3)):
    world.records[name].held_by = holder
    world.records[name].grip = Pose(position_m=grip)
    world.grip([name])


def test_what_is_held_goes_with_its_holder_and_falls_when_that_is_gone():
    world = engine(*cans(2))
    hold(world, "can1", "can0")
    assert where(world, "can1") == pytest.approx((0.0, 0.0, 0.3))
    world.step(0.2)
    assert where(world, "can1") == pytest.approx((0.0, 0.0, 0.3), abs=0.01)
    world.put({"can0": pose(4.0, 0.0)})
    world.carry(["can0"])
    assert where(world, "can1") == pytest.approx((4.0, 0.0, 0.3), abs=0.01)
    world.remove(["can0"])
    record = world.records["can1"]
    assert (record.held_by, record.grip, record.grip_commit) == ("", None, -1)
    world.step(0.3)
    assert where(world, "can1")[2] < 0.1


def test_what_holds_nothing_of_these_is_not_carried():
    world = engine(*cans(3))
    hold(world, "can1", "can0")
    world.put({"can0": pose(4.0, 0.0)})
    world.carry(["can2"])
    assert where(world, "can1") == pytest.approx((0.0, 0.0, 0.3), abs=0.01)


def test_holds_stay_when_others_come():
    world = engine(*cans(2))
    hold(world, "can1", "can0")
    add(world, order("cup1", "cup", pose(3.0, 3.0)))
    world.step(0.3)
    assert where(world, "can1") == pytest.approx((0.0, 0.0, 0.3), abs=0.01)


def test_a_camera_can_be_aimed():
    world = engine(*cans(1))
    world.aim(base_scene.OVERVIEW, look_at(np.array([1.0, 2.0, 3.0]), np.zeros(3), 4, 3, 1.0))
    mujoco.mj_camlight(world.model, world.data)
    assert world.data.cam_xpos[0] == pytest.approx((1.0, 2.0, 3.0))
    assert world.model.cam_fovy[0] == pytest.approx(np.degrees(1.0))


def test_obstacles_have_the_current_poses_of_bodies():
    world = engine(*cans(1))
    world.put({"can0": pose(4.0, 0.0, 1.0)})
    assert world.obstacles().body_low[0] == pytest.approx((4.0 - 0.033, -0.033, 1.0), abs=0.002)


def test_others_are_heard_while_it_compiles_and_then_it_does_not(monkeypatch):
    is_heard, heard = threading.Event(), []
    compiled = Engine._compiled

    def compile_when_others_were_heard(engine, poses):
        assert is_heard.wait(PATIENCE_S)
        return compiled(engine, poses)

    def hear():
        heard.append(world.compiling)
        is_heard.set()

    world = engine()
    monkeypatch.setattr(world, "_while_waiting", hear)
    monkeypatch.setattr(Engine, "_compiled", compile_when_others_were_heard)
    add(world, order("fridge1", "fridge", pose(0.0, 0.0)))
    assert set(heard) == {True}
    assert world.compiling is False


def test_many_at_once_need_more_slots_than_there_are():
    world = engine(*cans(60))
    assert len(world.index.names) == 60
    world.step(0.5)
    assert all(distance_m(p, pose(float(i), 0.0)) < 0.01 for i, p in enumerate(_poses(world)))


def _poses(world):
    return [Pose(position_m=tuple(row[:3].tolist())) for row in world.poses()]


def test_bodies_are_restored_where_they_stood_free_or_fixed_or_held():
    world = engine(*cans(3), order("lamp1", "lamp", pose(0.0, 3.0, 1.0), fixed=True))
    grip = Pose(position_m=(0.0, 0.0, 0.3))
    world.restore(
        {
            "can0": StoredBody(pose(5.0, 1.0)),
            "lamp1": StoredBody(pose(2.0, 3.0, 1.5)),
            "can1": StoredBody(pose(2.0, 2.0, 0.3), {}, "can2", grip),
        }
    )
    assert where(world, "can0") == pytest.approx((5.0, 1.0, 0.0), abs=1e-6)
    assert where(world, "lamp1") == pytest.approx((2.0, 3.0, 1.5), abs=1e-6)
    record = world.records["can1"]
    assert (record.held_by, record.grip) == ("can2", grip)
    world.put({"can2": pose(4.0, 0.0)})
    world.carry(["can2"])
    assert where(world, "can1") == pytest.approx((4.0, 0.0, 0.3), abs=1e-6)


def test_a_body_that_was_held_by_one_that_is_gone_is_restored_free():
    world = engine(*cans(1))
    world.restore({"can0": StoredBody(pose(1.0, 1.0, 0.5), {}, "gone1", pose(0.0, 0.0))})
    record = world.records["can0"]
    assert (record.held_by, record.grip) == ("", None)
    assert where(world, "can0") == pytest.approx((1.0, 1.0, 0.5), abs=1e-6)


def test_joints_are_restored_if_they_have_as_many_coordinates_as_before():
    world = engine(order("fridge1", "fridge", pose(0.0, 0.0)))
    (joint, *_) = world.index.joint_coordinates("fridge1")
    world.restore({"fridge1": StoredBody(pose(0.0, 0.0), {joint: (0.7,), "another": (0.3,)})})
    assert world.data.qpos[world.index.joint_coordinates("fridge1")[joint]] == pytest.approx([0.7])
    world.restore({"fridge1": StoredBody(pose(0.0, 0.0), {joint: (0.1, 0.2)})})
    assert world.data.qpos[world.index.joint_coordinates("fridge1")[joint]] == pytest.approx([0.7])


def test_bodies_that_are_restored_where_they_are_cost_no_compilation():
    world = engine(order("lamp1", "lamp", pose(0.0, 3.0, 1.0), fixed=True), *cans(1))
    model = world.model
    world.restore({"lamp1": StoredBody(pose(0.0, 3.0, 1.0)), "can0": StoredBody(pose(3.0, 0.0))})
    assert world.model is model
