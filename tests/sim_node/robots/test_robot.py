"""The robot that ships with semmap stands, drives, is stopped by walls, and can fall over."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest

from semmap.nodes.sim_node.config import RobotConfig
from semmap.nodes.sim_node.models.sources import Models
from semmap.nodes.sim_node.robots.robot import SHIPPED, RobotSensor
from semmap.nodes.sim_node.vision.view import camera_names, camera_view
from semmap.nodes.sim_node.world_file import open_world
from semmap.ontology import FLAT_WORLD
from semmap.schemas.entities import Pose, compose
from semmap.schemas.errors import BadFile, Refused
from semmap.schemas.scenes import BodyOrder, DriveBase, Placement

AT = (7.5, 2.0, 0.0)


@pytest.fixture
def world():
    return open_world(FLAT_WORLD, Models(), robot=RobotConfig(SHIPPED["porter"], at_m=AT, yaw_rad=1.0))


def until_it_ends(world, most_s: float = 60.0) -> str:
    for _ in range(int(most_s / 0.02)):
        world.step(0.02)
        if ended := world.ended():
            return ended["robot1"]
    return "never"


def test_it_stands_where_it_is_put_and_sleeps(world):
    body, gripper = world.scene().bodies
    assert (gripper.name, gripper.class_, gripper.part_of) == ("robot1_gripper", "Device", "robot1")
    assert gripper.robot
    assert not any(joint.opens for joint in (*body.joints, *gripper.joints))
    assert (body.name, body.class_, body.robot, body.ghost) == ("robot1", "robot", True, False)
    assert body.pose.position_m == pytest.approx(AT, abs=1e-3)
    assert body.pose.yaw_rad == pytest.approx(1.0, abs=1e-3)
    world.step(3.0)
    assert world.asleep
    assert world.poses().resting == (True, True)
    assert world.pose("robot1").position_m == pytest.approx(AT, abs=2e-3)


def test_what_is_part_of_it_does_not_rest_either_once_it_is_put_elsewhere(world):
    """Otherwise a client would store the old pose of the gripper."""
    world.step(3.0)
    x, y, z = AT
    world.move([Placement(name="robot1", pose=Pose(position_m=(x + 0.5, y, z)), commit=3)])
    assert world.poses().resting == (False, False)
    world.step(3.0)
    assert world.poses().resting == (True, True)
    assert world.pose("robot1_gripper").position_m[0] > x + 0.4


def test_it_drives_through_points_and_faces_where_it_is_to(world):
    world.drive(DriveBase(name="robot1", to=((8.5, 2.0), (8.5, 2.8)), yaw=0.0))
    world.step(1.0)
    assert world.poses().resting[0] is False
    assert until_it_ends(world) == "there"
    pose = world.pose("robot1")
    assert pose.position_m == pytest.approx((8.5, 2.8, 0.0), abs=0.02)
    assert pose.yaw_rad == pytest.approx(0.0, abs=0.03)
    world.step(3.0)
    assert world.asleep


def test_it_goes_no_faster_than_it_is_told(world):
    world.drive(DriveBase(name="robot1", to=((9.3, 2.0),), speed=0.2))
    fastest = 0.0
    for _ in range(200):
        world.step(0.02)
        fastest = max(fastest, float(np.linalg.norm(world.data.qvel[:2])))
    assert 0.15 < fastest < 0.22


def test_a_wall_stops_it_and_that_is_said(world):
    world.drive(DriveBase(name="robot1", to=((7.5, -3.0),)))
    assert until_it_ends(world) == "blocked"
    assert world.pose("robot1").position_m[1] > 0.2
    assert world.pose("robot1").position_m[2] == pytest.approx(0.0, abs=0.01)


def test_another_course_takes_the_place_of_one_and_no_points_end_it(world):
    world.drive(DriveBase(name="robot1", to=((9.0, 2.0),)))
    world.step(1.0)
    world.drive(DriveBase(name="robot1", to=((8.0, 2.5),)))
    assert world.ended() == {"robot1": "stopped"}
    world.drive(DriveBase(name="robot1"))
    assert world.ended() == {"robot1": "stopped"}
    world.step(3.0)
    assert world.asleep


def test_what_has_fallen_over_does_not_drive(world):
    lying = Pose(position_m=(7.5, 2.0, 0.3), orientation_wxyz=(math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0))
    world.move([Placement(name="robot1", pose=lying)])
    world.step(2.0)
    assert world.scene().bodies[0].has_fallen
    said = r"robot1 has fallen over at .*; to put it upright: semmap move robot1 --at .* 0 --yaw 0$"
    with pytest.raises(Refused, match=said):
        world.drive(DriveBase(name="robot1", to=((9.0, 2.0),)))
    world.move([Placement(name="robot1", pose=Pose(position_m=AT))])
    assert not world.scene().bodies[0].has_fallen
    world.drive(DriveBase(name="robot1", to=((9.0, 2.0),)))
    assert until_it_ends(world) == "there"


def test_who_is_knocked_over_on_its_way_is_said_to_have_fallen(world):
    world.drive(DriveBase(name="robot1", to=((9.0, 2.0),)))
    world.step(0.5)
    world.data.qpos[3:7] = (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)
    assert until_it_ends(world) == "fallen"


def test_it_stays_where_it_is_while_others_come(world):
    """Compilation keeps its joints, its actuators and its drive command."""
    world.drive(DriveBase(name="robot1", to=((8.5, 2.0),)))
    world.step(1.0)
    places = [Pose(position_m=(20.0 + 2.0 * i, 0.0, 0.0)) for i in range(20)]
    orders = [
        BodyOrder(name=f"fridge{i}", class_="Fridge", model="fridge", pose=pose, commit=1)
        for i, pose in enumerate(places)
    ]
    world.spawn(orders)
    assert until_it_ends(world) == "there"


def test_without_room_it_is_a_ghost_that_cannot_drive(world):
    table = BodyOrder(
        name="table1", class_="Table", model="table", pose=Pose(position_m=(9.0, 2.0, 0.0)), commit=1
    )
    world.spawn([table])
    world.step(1.0)
    world.move([Placement(name="robot1", pose=Pose(position_m=(9.0, 2.0, 0.0)))])
    world.step(0.5)
    if next(body for body in world.scene().bodies if body.name == "robot1").ghost:
        with pytest.raises(Refused, match="held where it is"):
            world.drive(DriveBase(name="robot1", to=((8.0, 2.0),)))
    world.move([Placement(name="robot1", pose=Pose(position_m=AT))])
    world.drive(DriveBase(name="robot1", to=((7.2, 2.0),)))
    assert until_it_ends(world) == "there"


def test_what_is_no_robot_does_not_drive(world):
    with pytest.raises(Refused, match="no body named"):
        world.drive(DriveBase(name="nobody1", to=((1.0, 1.0),)))
    with pytest.raises(Refused, match="too far"):
        world.drive(DriveBase(name="robot1", to=((9000.0, 1.0),)))
    world.spawn(
        [BodyOrder(name="cup1", class_="Cup", model="cup", pose=Pose(position_m=(3.0, 1.0, 0.0)), commit=1)]
    )
    with pytest.raises(Refused, match="velocity actuators"):
        world.drive(DriveBase(name="cup1", to=((1.0, 1.0),)))


def test_its_camera_moves_with_it(world):
    assert "robot1_head" in camera_names(world.model)

    def eye():
        model, data, _ = world.snapshot()
        return camera_view(model, data, "robot1_head", 64, 48).map_from_camera

    world.step(0.1)
    before = eye()
    forward = before[:3, 2]
    assert math.atan2(forward[1], forward[0]) == pytest.approx(1.0, abs=0.01)
    assert forward[2] == pytest.approx(-0.309, abs=0.01)
    world.drive(DriveBase(name="robot1", to=((8.5, 2.0),)))
    assert until_it_ends(world) == "there"
    moved = eye()[:3, 3] - before[:3, 3]
    assert 0.8 < float(np.linalg.norm(moved[:2])) < 1.2


def test_its_arm_moves_and_it_does_not_tip_over(world):
    model, data = world.model, world.data
    for joint, position in (("shoulder_pitch", 1.4), ("elbow", -0.6)):
        data.ctrl[model.actuator(f"robot1_{joint}").id] = position
    world.drive(DriveBase(name="robot1", to=((8.3, 2.0),)))  # it wakes
    assert until_it_ends(world) == "there"
    elbow = model.joint("robot1_elbow").qposadr[0]
    assert data.qpos[elbow] == pytest.approx(-0.6, abs=0.05)
    assert world.pose("robot1").position_m[2] == pytest.approx(0.0, abs=0.005)


@pytest.mark.parametrize(
    ("mjcf", "said"),
    [
        ("<mujoco><worldbody/></mujoco>", "it has none"),
        (
            "<mujoco><worldbody><body name='a'/><body name='b'/></worldbody></mujoco>",
            "one top-level body; it has a, b",
        ),
        ("<mujoco><worldbody><body><geom size='-1'/></body></worldbody></mujoco>", "cannot compile"),
        ("not xml", "cannot compile"),
    ],
)
def test_what_is_no_robot_is_refused(tmp_path, mjcf, said):
    path = tmp_path / "robot.xml"
    path.write_text(mjcf)
    with pytest.raises(BadFile, match=said):
        open_world(FLAT_WORLD, Models(), robot=RobotConfig(path))
    with pytest.raises(BadFile):
        open_world(FLAT_WORLD, Models(), robot=RobotConfig(tmp_path / "none.xml"))


def test_a_robot_without_a_free_joint_gets_one_and_one_with_a_taken_name_is_refused(tmp_path):
    path = tmp_path / "box.xml"
    path.write_text(
        "<mujoco><worldbody><geom type='plane' size='1 1 1'/><body name='box'>"
        "<geom type='box' size='.2 .2 .2'/></body></worldbody></mujoco>"
    )
    world = open_world(None, Models(), robot=RobotConfig(path, name="box1", at_m=(1.0, 2.0, 0.2)))
    world.step(1.0)
    assert world.pose("box1").position_m == pytest.approx((1.0, 2.0, 0.0), abs=2e-3)
    floors = np.count_nonzero(world.model.geom_type == int(mujoco.mjtGeom.mjGEOM_PLANE))
    assert floors == 1
    scene = tmp_path / "world.xml"
    scene.write_text("<mujoco><worldbody><body name='box1'><geom size='.1'/></body></worldbody></mujoco>")
    with pytest.raises(BadFile, match="--robot-name"):
        open_world(scene, Models(), robot=RobotConfig(path, name="box1"))


def test_where_its_camera_is_and_who_carries_it_is_told(world):
    told = {camera.camera: camera for camera in world.cameras()}
    head = told["robot1_head"]
    assert head.part_of == "robot1"
    view = camera_view(world.model, world.data, "robot1_head", 64, 48).map_from_camera
    ahead = compose(head.pose, Pose(position_m=(0.1, 0.2, 1.0))).position_m
    assert ahead == pytest.approx(tuple((view @ [0.1, 0.2, 1.0, 1.0])[:3]), abs=1e-6)
    assert {camera.part_of for name, camera in told.items() if name != "robot1_head"} <= {""}


def commits(world) -> tuple[int, ...]:
    return world.poses().commits


def test_nobody_has_placed_it_until_the_map_does(world):
    assert commits(world) == (-1, -1)
    there = Pose(position_m=(8.5, 1.5, 0.0))
    assert world.move([Placement(name="robot1", pose=there, commit=7)]).failed == {}
    assert commits(world) == (7, 0)  # its gripper goes along
    assert world.pose("robot1").position_m == pytest.approx((8.5, 1.5, 0.0), abs=2e-3)


@pytest.mark.parametrize("by", ["hand", "drive"])
def test_who_moves_or_drives_it_has_placed_it_too(world, by):
    if by == "hand":
        world.move([Placement(name="robot1", pose=Pose(position_m=(8.5, 1.5, 0.0)))])
    else:
        world.drive(DriveBase(name="robot1", to=((8.5, 2.0),)))
    assert commits(world) == (0, 0)


def test_who_lifts_it_ends_its_course(world):
    world.drive(DriveBase(name="robot1", to=((9.3, 2.0),)))
    world.step(1.0)
    there = Pose(position_m=(8.5, 1.2, 0.0))
    world.move([Placement(name="robot1", pose=there)])
    assert world.ended() == {"robot1": "stopped"}
    world.step(3.0)
    assert world.pose("robot1").position_m == pytest.approx(there.position_m, abs=0.02)


def test_its_state_moves_the_model_of_its_file_to_where_it_is(tmp_path):
    file = tmp_path / "arm.xml"
    file.write_text(
        """<mujoco><worldbody><body name="base" pos="0.1 0.2 0.5" quat="0.6 0.8 0 0"><geom size="0.1"/>
        <joint type="free"/><body pos="0.3 0 0"><joint name="elbow"/><geom size="0.1"/>
        <body name="hand" pos="0 0.4 0"><joint name="slide" type="slide"/><geom size="0.1"/>
        </body></body></body></worldbody></mujoco>"""
    )
    robot = RobotConfig(file, name="r", at_m=(1.0, 2.0, 0.0), yaw_rad=0.7)
    world = open_world(None, Models(), robot=robot)
    world.data.joint("r_elbow").qpos, world.data.joint("r_slide").qpos = 0.4, 0.3
    world.move([Placement(name="r", pose=Pose(position_m=(-1.0, 0.5, 0.0)))])
    mujoco.mj_kinematics(world.model, world.data)
    state = RobotSensor(robot).state(world.model, world.data, 7)
    assert (state.joints.keys(), state.stamp_ns) == ({"elbow", "slide"}, 7)
    own = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(own)
    for name, value in state.joints.items():
        data.joint(name).qpos = value
    mujoco.mj_kinematics(own, data)
    hand = compose(state.require_pose(), Pose(position_m=tuple(data.body("hand").xpos)))
    assert hand.position_m == pytest.approx(world.data.body("r_hand").xpos, abs=1e-6)
