"""Records of bodies, and their poses as arrays."""

import math

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.sim_node.bodies import BodyIndex, BodyRecord, frame_of, pose_of, rotated
from semmap.nodes.sim_node.models.parts import about, product, rotation_matrix
from semmap.schemas.entities import Pose
from semmap.schemas.joints import Joint

MJCF = """<mujoco><worldbody>
  <body name="shelf" pos="5 0 1" euler="0 0 90"><geom type="box" size="1 1 1"/>
    <body><joint name="door" type="hinge" axis="0 0 1"/><geom type="box" size="0.1 0.1 0.1"/></body>
    <body><joint name="knob" type="ball"/><geom type="box" size="0.1 0.1 0.1"/></body>
  </body>
  <body name="can" pos="0 3 2"><freejoint/><geom type="box" size="0.1 0.1 0.1"/></body>
  <body name="cup" pos="0 4 2"><freejoint/><geom type="box" size="0.1 0.1 0.1"/></body>
</worldbody></mujoco>"""
ANGLE = st.floats(-3.0, 3.0)
TURN = st.builds(lambda a, b: product(about("z", a), about("x", b)), ANGLE, ANGLE)
LENGTH = st.floats(-5.0, 5.0)
POINT = st.tuples(LENGTH, LENGTH, LENGTH)


def record(name, **more):
    given = {
        "class_": None,
        "model": "",
        "size_m": (1.0, 1.0, 1.0),
        "origin_m": (0.0, 0.0, -0.5),
        "ordered": Pose(position_m=(0.0, 0.0, 0.0)),
        "fixed": False,
        "entity": False,
        "masks": [],
    }
    return BodyRecord(name=name, **given | more)


@pytest.fixture(scope="module")
def scene():
    model = mujoco.MjModel.from_xml_string(MJCF)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    joints = (Joint(name="door", kind="hinge"), Joint(name="knob", kind="ball"))
    records = {
        "can": record("can"),
        "shelf": record(
            "shelf", fixed=True, joints=joints, joint_names=("door", "knob"), origin_m=(1, 0, -1)
        ),
        "cup": record("cup", ghost=True),
    }
    numbers = {name: model.body(name).id for name in records}
    return model, data, BodyIndex.of(model, records, numbers)


def test_a_body_is_static_if_it_is_fixed_or_a_ghost():
    assert not record("cup").static
    assert record("cup", fixed=True).static
    assert record("cup", ghost=True).static


def test_others_are_told_what_the_record_says_and_where_its_joints_stand():
    joints = (Joint(name="door", kind="hinge"), Joint(name="drawer", kind="slide"))
    told = record(
        "cup",
        joints=joints,
        commit=3,
        shape_commit=2,
        joint_commit=4,
        part_of="tray",
        robot=True,
        held_by="hand",
        grip=Pose(position_m=(1.0, 0.0, 0.0)),
        grip_commit=5,
        in_the_way="box",
    ).message(Pose(position_m=(1.0, 2.0, 3.0)), resting=True, positions=[0.5, 0.25])
    assert [joint.position for joint in told.joints] == [0.5, 0.25]
    assert (told.commit, told.shape_commit, told.joint_commit, told.grip_commit) == (3, 2, 4, 5)
    assert (told.part_of, told.robot, told.held_by, told.grip.position_m) == ("tray", True, "hand", (1, 0, 0))
    assert (told.pose.position_m, told.resting, told.fixed, told.entity) == ((1, 2, 3), True, False, False)
    assert (told.ghost, told.in_the_way) == (False, "")  # nothing is in the way of what is solid
    ghost = record("cup", ghost=True, in_the_way="box").message(told.pose, resting=False)
    assert (ghost.ghost, ghost.in_the_way, ghost.resting) == (True, "box", False)


def test_an_index_finds_the_free_joints_of_those_that_can_move(scene):
    model, _, index = scene
    assert index.names == ("can", "shelf", "cup")
    assert index.row == {"can": 0, "shelf": 1, "cup": 2}
    assert index.qpos.tolist() == [model.jnt_qposadr[2], -1, -1]
    assert index.dof.tolist() == [model.jnt_dofadr[2], -1, -1]
    assert index.body.tolist() == [model.body(name).id for name in index.names]
    assert index.ghost.tolist() == [False, False, True]
    assert index.joint_row == {"door": 0, "knob": 1}
    assert index.joint_body.tolist() == [1, 1]
    assert index.joint_ball.tolist() == [False, True]
    assert index.joint_qpos.tolist() == [0, 1]
    assert index.joint_dof.tolist() == [0, 1]


def test_poses_are_those_of_bottom_centres(scene):
    model, data, index = scene
    poses = index.poses(data)
    assert poses[0, :3] == pytest.approx((0.0, 3.0, 1.5))
    assert poses[1, :3] == pytest.approx((5.0, 1.0, 0.0))  # (1, 0, -1) in its frame, which is turned
    assert poses[1, 3:] == pytest.approx(about("z", math.pi / 2))
    other = mujoco.MjData(model)
    mujoco.mj_kinematics(model, other)
    other.qpos[index.qpos[0]] = 7.0  # what moves is where its joint has it, also before kinematics
    assert index.poses(other)[0, :3] == pytest.approx((7.0, 3.0, 1.5))


def test_a_joint_stands_at_its_angle_and_a_ball_joint_at_that_from_its_reference(scene):
    model, _, index = scene
    data = mujoco.MjData(model)
    data.qpos[0] = 0.7
    for turn_rad in (0.4, -0.4):
        data.qpos[1:5] = about("y", turn_rad)
        assert index.positions(data) == pytest.approx((0.7, 0.4))
    data.qpos[1:5] *= -1.0
    assert index.positions(data) == pytest.approx((0.7, 0.4))


def test_without_bodies_there_is_nothing_to_find():
    model = mujoco.MjModel.from_xml_string("<mujoco/>")
    index = BodyIndex.of(model, {}, {})
    assert index.poses(mujoco.MjData(model)).shape == (0, 7)
    assert index.positions(mujoco.MjData(model)).shape == (0,)
    assert index.tree.tolist() == []


def test_bodies_none_of_which_can_move_have_no_addresses():
    model = mujoco.MjModel.from_xml_string('<mujoco><worldbody><body name="a"/></worldbody></mujoco>')
    index = BodyIndex.of(model, {"a": record("a", fixed=True)}, {"a": 1})
    assert (index.qpos.tolist(), index.dof.tolist(), index.tree.tolist()) == ([-1], [-1], [-1])


@given(TURN, POINT)
def test_vectors_are_rotated_as_by_the_matrix(turn, vector):
    by_matrix = rotation_matrix(turn) @ vector
    assert rotated(np.array([turn, turn]), np.array([vector, vector])) == pytest.approx(
        np.array([by_matrix, by_matrix]), abs=1e-9
    )


@given(TURN, POINT, POINT, st.floats(0.9995, 1.0005))
def test_the_frame_of_a_body_has_its_bottom_centre_at_the_pose(turn, place, origin, factor):
    """The quaternion is normalised."""
    pose = Pose(position_m=place, orientation_wxyz=tuple(factor * value for value in turn))
    position, quaternion = frame_of(pose, origin)
    assert np.linalg.norm(quaternion) == pytest.approx(1.0)
    assert quaternion == pytest.approx(turn)
    assert position + rotated(quaternion[None], np.array([origin]))[0] == pytest.approx(place, abs=1e-9)


def test_a_row_of_poses_is_a_pose():
    pose = pose_of(np.array([1.0, 2.0, 3.0, 0.5, -0.5, 0.5, 0.5]))
    assert pose == Pose(position_m=(1.0, 2.0, 3.0), orientation_wxyz=(0.5, -0.5, 0.5, 0.5))
