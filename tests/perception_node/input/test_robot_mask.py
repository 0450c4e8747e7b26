"""The robot's own body is left out of clouds."""

import json

import mujoco
import numpy as np
import pytest

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.projection import cloud_of
from semmap.nodes.perception_node.input.robot_mask import read_robot
from semmap.nodes.sim_node.robots.robot import SHIPPED
from semmap.nodes.sim_node.vision.raycast import raycast
from semmap.nodes.sim_node.vision.view import camera_view
from semmap.schemas.errors import BadFile

PORTER = str(SHIPPED["porter"])
JOINTS = {"shoulder_pitch": 1.2, "elbow": 0.2, "head_tilt": 0.5}
BASE = np.array([[0.0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 0], [0, 0, 0, 1]])
"""The robot stands at (1, 2) and looks along y."""
POST = """
<robot name="post"><link name="base"/><link name="post">
<collision><origin xyz="0 0 0.5"/><geometry><cylinder radius="0.05" length="1"/></geometry></collision>
<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="lift" type="prismatic"><parent link="base"/><child link="post"/><axis xyz="1 0 0"/>
<limit lower="0" upper="2" effort="1" velocity="1"/></joint></robot>
"""


def written(folder, **state):
    path = folder / "robot.json"
    path.write_text(json.dumps(state))
    return path


@pytest.fixture(scope="module")
def frame():
    """Return the robot's view of its arm and of a carton beside it: the cloud, and the pixels of both."""
    spec = mujoco.MjSpec()
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[5, 5, 0.1])
    spec.worldbody.add_geom(
        name="carton", type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.06, 0.05, 0.45], pos=[0.83, 2.55, 0.45]
    )
    place = spec.worldbody.add_frame(pos=BASE[:3, 3], quat=[0.5**0.5, 0, 0, 0.5**0.5])
    place.attach_body(mujoco.MjSpec.from_file(PORTER).body("porter"), "r_", "")
    model = spec.compile()
    data = mujoco.MjData(model)
    for name, value in JOINTS.items():
        data.joint(f"r_{name}").qpos[0] = value
    mujoco.mj_forward(model, data)
    view = camera_view(model, data, "r_head", 320, 240)
    rgb, depth, geom = raycast(model, data, view)
    of = np.append(model.geom_bodyid, -1)[geom]
    noisy = depth + np.random.default_rng(0).normal(0.0, 0.003, depth.shape).astype(np.float32)
    cloud = cloud_of(noisy, rgb, view.intrinsics, view.map_from_camera)
    return cloud, of > 0, geom == model.geom("carton").id


def test_the_arm_is_left_out_and_what_is_beside_it_stays(frame, tmp_path):
    cloud, arm, carton = frame
    assert arm.sum() > 2000
    assert carton.sum() > 500
    path = written(tmp_path, model=PORTER, joints=JOINTS, map_from_base=BASE.ravel().tolist())
    left = read_robot(path).remove_from(cloud)
    kept = left.points_camera[..., 2] > 0
    assert not kept[arm].any()
    assert kept[carton].mean() > 0.95
    assert kept[~arm].mean() > 0.97
    assert left.notes == ()


def test_joints_that_are_not_those_of_the_frame_leave_the_arm_in_part(frame, tmp_path):
    cloud, arm, _ = frame
    path = written(tmp_path, model=PORTER, map_from_base=BASE.tolist())
    kept = read_robot(path).remove_from(cloud).points_camera[..., 2] > 0
    assert kept[arm].mean() > 0.3


def test_a_urdf_is_read_and_what_is_before_it_stays(tmp_path):
    (tmp_path / "post.urdf").write_text(POST)
    robot = read_robot(written(tmp_path, model="post.urdf", joints={"lift": 1.0}))
    upright = np.array([[0.0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0.5], [0, 0, 0, 1]])  # looks along x
    points = np.array([[[0, 0, 0.95], [0, 0, 0.9], [0, 0, 1.3], [0.049, 0, 1], [0.06, 0, 1], [0.1, 0, 1]]])
    left = robot.remove_from(Cloud(points, map_from_camera=upright)).points_camera
    assert np.isfinite(left[0, :, 2]).tolist() == [False, True, False, False, False, True]
    nothing = robot.remove_from(Cloud(points + np.array([2.0, 0, 0]), map_from_camera=upright))
    assert "covers no point" in nothing.notes[0]


@pytest.mark.parametrize(
    ("state", "error"),
    [
        ({"model": "none.xml"}, "none.xml cannot be read: No such file"),
        ({"model": "robot.json"}, "robot.json cannot be read as MJCF or URDF: "),
        ({"model": PORTER, "joints": {"knee": 1.0}}, "has no joint 'knee'; its joints: elbow"),
        ({"model": PORTER, "map_from_base": [1.0]}, "map_from_base is not a 4 x 4 pose"),
        ({}, r"is not the state of a robot \(.*\): model is missing"),
    ],
)
def test_what_is_no_state_of_a_robot_is_told(tmp_path, state, error):
    with pytest.raises(BadFile, match=error):
        read_robot(written(tmp_path, **state))


def test_a_camera_without_a_pose_is_told(tmp_path):
    robot = read_robot(written(tmp_path, model=PORTER))
    with pytest.raises(BadFile, match="requires the camera's pose"):
        robot.remove_from(Cloud(np.ones((1, 1, 3))))
