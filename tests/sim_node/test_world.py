import math
import threading

import mujoco
import numpy as np
import pytest

from semmap.nodes.sim_node.body_classes import BodyClasses
from semmap.nodes.sim_node.models.facets import surface_of
from semmap.nodes.sim_node.models.library import build as library_model
from semmap.nodes.sim_node.physics import base_scene
from semmap.nodes.sim_node.physics.base_scene import read_mjcf
from semmap.nodes.sim_node.physics.engine import Engine
from semmap.nodes.sim_node.placement.obstacles import Obstacles
from semmap.nodes.sim_node.vision.view import camera_names, overview
from semmap.nodes.sim_node.world import World
from semmap.schemas.entities import Pose, angle_rad, distance_m
from semmap.schemas.errors import BadFile, Refused
from semmap.schemas.scenes import DriveBase, GripOrder, JointOrder, Placement
from tests.conftest import PATIENCE_S
from tests.household import household_classes
from tests.sim_node.orders import bodies, hand, order, pose, spawned


def body(world, name):
    return next(body for body in world.scene().bodies if body.name == name)


def height(world, name):
    return body(world, name).pose.position_m[2]


def test_a_body_stands_where_it_was_ordered_and_comes_to_rest():
    world = World()
    spawned = world.spawn([order("chair1", "chair", pose(1, 2, yaw=0.5), commit=7)])
    assert spawned.failed == {}
    assert not spawned.bodies[0].resting
    world.step(1.0)
    chair = body(world, "chair1")
    assert distance_m(chair.pose, pose(1, 2)) < 0.001
    assert angle_rad(chair.pose, pose(1, 2, yaw=0.5)) < 0.001
    assert (chair.resting, chair.commit, chair.shape_commit, chair.entity) == (True, 7, 7, True)
    assert chair.size_m == pytest.approx((0.45, 0.45, 0.9))
    assert world.asleep


def test_other_bodies_keep_their_state_to_the_bit():
    world = World()
    world.spawn([order(f"can{i}", "can", pose(i, 0, 0.2)) for i in range(5)])
    world.step(0.05)  # in mid-air
    before = dict(zip(world.poses().names, np.reshape(world.poses().poses, (-1, 7)), strict=True))
    speeds = world.data.qvel[:30].copy()
    world.spawn([order("late", "cup", pose(0, 3))])
    after = dict(zip(world.poses().names, np.reshape(world.poses().poses, (-1, 7)), strict=True))
    assert all((before[name] == after[name]).all() for name in before)
    assert (world.data.qvel[:30] == speeds).all()
    world.delete(["can2"])
    kept = dict(zip(world.poses().names, np.reshape(world.poses().poses, (-1, 7)), strict=True))
    assert all((before[name] == kept[name]).all() for name in before if name != "can2")


def test_sleepers_sleep_on_when_others_come():
    world = World()
    world.spawn([order("table1", "table", pose(0, 0)), order("cup1", "cup", pose(0, 0, 0.75))])
    world.step(2.0)
    before = world.poses().poses
    world.spawn([order("far", "can", pose(5, 5))])
    world.step(0.01)
    assert world.poses().poses[: len(before)] == before


def test_sleepers_sleep_on_through_two_changes_at_once():
    world = World()
    world.spawn([order("table1", "table", pose(0, 0)), order("cup1", "cup", pose(0, 0, 0.75))])
    world.step(2.0)
    before = world.poses().poses
    fridges = [order(f"fridge{i}", "", pose(5, 5 + 0.1 * i), size_m=(0.6, 0.6, 1.8)) for i in range(2)]
    world.spawn(fridges)  # the second becomes a ghost, which takes a second compilation
    world.spawn([order("far", "can", pose(-5, 5))])
    world.step(0.01)
    assert world.poses().poses[: len(before)] == before


def test_many_deleted_at_once_leave_the_rest_as_it_was():
    world = World()
    world.spawn([order(f"can{i}", "can", pose(i * 0.2, 0, 0.3)) for i in range(40)])
    world.spawn([order("wall1", "wall", pose(0, 5), size_m=(4, 0.1, 2), fixed=True)])
    world.step(0.1)
    before = {b.name: b for b in world.scene().bodies}
    gone = [f"can{i}" for i in range(0, 40, 2)]
    assert set(world.delete([*gone, "missing"]).names) == set(gone)
    after = {b.name: b for b in world.scene().bodies}
    assert after == {name: value for name, value in before.items() if name not in gone}
    world.step(1.0)
    assert all(b.resting for b in world.scene().bodies)


def test_what_cannot_be_made_is_told_and_the_rest_is_made():
    world = World()
    world.spawn([order("cup1", "cup", pose(0, 0))])
    spawned = world.spawn(
        [
            order("cup1", "cup", pose(1, 0)),
            order("huge", "cup", pose(2, 0), size_m=(1000.0, 1.0, 1.0)),
            order("thin", "cup", pose(2, 0), size_m=(1e-5, 1.0, 1.0)),
            order("far", "cup", pose(9000, 0)),
            order("twice", "cup", pose(3, 0)),
            order("twice", "cup", pose(4, 0)),
            order("strange", "no_such_model", pose(5, 0)),
        ]
    )
    assert [b.name for b in spawned.bodies] == ["twice", "strange"]
    assert set(spawned.failed) == {"cup1", "huge", "thin", "far", "twice"}
    assert "already" in spawned.failed["cup1"]
    assert "1000 m" in spawned.failed["huge"]
    assert spawned.bodies[1].model == "box"
    assert spawned.bodies[1].size_m == pytest.approx((0.3, 0.3, 0.3))
    world.step(0.5)
    assert all(b.resting for b in world.scene().bodies)


def test_a_hand_lets_go_and_things_fall():
    world = World()
    world.spawn([order("cup1", "cup", pose(0, 0), commit=3)])
    world.step(1.0)
    moved = world.move(
        [hand("cup1", pose(2, 0, 0.5)), hand("missing", pose(0, 0)), hand("cup1", pose(1, 0, 0.4))]
    )
    assert [body.name for body in moved.bodies] == ["cup1"]
    assert "no body named missing" in moved.failed["missing"]
    assert not body(world, "cup1").resting
    world.step(1.0)
    cup = body(world, "cup1")
    assert cup.resting
    assert cup.commit == 3
    assert cup.pose.position_m == pytest.approx((1, 0, 0), abs=0.01)


def test_an_ordered_move_carries_its_commit():
    world = World()
    world.spawn([order("cup1", "cup", pose(0, 0), commit=3)])
    world.move([Placement(name="cup1", pose=pose(1, 1), commit=9)])
    assert world.poses().commits == (9,)
    assert body(world, "cup1").shape_commit == 3


def test_what_stood_on_a_thing_falls_when_it_goes():
    world = World()
    world.spawn(
        [
            order("table1", "table", pose(0, 0)),
            order("cup1", "cup", pose(0, 0.3, 0.75)),
            order("table2", "table", pose(5, 0)),
            order("cup2", "cup", pose(5, 0.3, 0.75)),
        ]
    )
    world.step(1.0)
    assert height(world, "cup1") == pytest.approx(0.75, abs=0.002)
    world.move([hand("table1", pose(0, 3))])
    world.delete(["table2"])
    world.step(1.5)
    assert height(world, "cup1") < 0.1
    assert height(world, "cup2") < 0.1


def test_fixed_bodies_hang_and_move_only_by_hand():
    world = World()
    world.spawn([order("shelf1", "shelf", pose(0, 0, 1.5), size_m=(0.3, 0.8, 0.2), fixed=True)])
    world.spawn([order("cup1", "cup", pose(0, 0, 1.75))])
    world.step(1.0)
    assert body(world, "shelf1").pose == pose(0, 0, 1.5)
    assert height(world, "cup1") == pytest.approx(1.7, abs=0.003)
    world.move([hand("shelf1", pose(0, 3, 1.0))])
    assert body(world, "shelf1").pose == pose(0, 3, 1.0)
    world.step(1.5)
    assert height(world, "cup1") < 0.1


def test_poses_and_scene_agree_and_versions_grow():
    world = World()
    first = world.poses()
    assert (first.names, first.poses, first.version) == ((), (), 0)
    world.spawn([order("cup1", "cup", pose(0, 0)), order("can1", "can", pose(1, 0))])
    world.step(0.5)
    poses, scene = world.poses(), world.scene()
    assert poses.version == scene.version == 1
    assert poses.run == scene.run != World().run
    for row, there in zip(np.reshape(poses.poses, (-1, 7)), scene.bodies, strict=True):
        assert tuple(row) == (*there.pose.position_m, *there.pose.orientation_wxyz)
    assert poses.sim_time_s == pytest.approx(0.5)
    world.delete(["cup1"])
    assert world.scene().version == 2


def test_reset_brings_everything_back_to_the_map():
    world = World()
    world.spawn([order("cup1", "cup", pose(0, 0)), order("table1", "table", pose(2, 0))])
    world.move([hand("cup1", pose(2, 0, 1.0)), Placement(name="table1", pose=pose(2, 1), commit=2)])
    world.step(1.0)
    world.reset()
    world.step(0.5)
    assert distance_m(body(world, "cup1").pose, pose(0, 0)) < 0.002
    assert distance_m(body(world, "table1").pose, pose(2, 1)) < 0.002


def compile_after(monkeypatch, event):
    """Let each compilation wait for an event, however fast the machine is."""
    compiled = Engine._compiled

    def wait_and_compile(*args):
        assert event.wait(PATIENCE_S)
        return compiled(*args)

    monkeypatch.setattr(Engine, "_compiled", wait_and_compile)


def test_others_hear_of_us_while_much_is_made(monkeypatch):
    worlds, heard = [], threading.Event()

    def while_waiting():
        if worlds and worlds[0].compiling:
            heard.set()

    world = World(while_waiting=while_waiting)
    worlds.append(world)
    compile_after(monkeypatch, heard)
    world.spawn([order(f"can{i}", "can", pose(0.5 * (i % 15), 0.5 * (i // 15))) for i in range(60)])
    assert len(world) == 60
    assert heard.is_set()
    assert not world.compiling


def test_time_goes_on_while_much_is_made(monkeypatch):
    told, heard = [], threading.Event()

    def while_waiting():
        if told:
            world.step(0.01)
            told.append(world.poses())
            heard.set()

    world = World(while_waiting=while_waiting)
    world.spawn([order("shelf1", "shelf", pose(5, 5), fixed=True), order("can1", "can", pose(0, 0, 50))])
    world.step(0.1)
    told.append(world.poses())
    compile_after(monkeypatch, heard)
    world.spawn(
        [order(f"can{i}", "can", pose(1 + 0.5 * (i % 15), 1 + 0.5 * (i // 15))) for i in range(2, 60)]
    )
    assert len(told) > 1  # time went on while the model was compiled
    assert all(poses.names == ("shelf1", "can1") for poses in told)
    fallen_s = told[-1].sim_time_s
    assert fallen_s > told[0].sim_time_s
    assert body(world, "can1").pose.position_m[2] == pytest.approx(50 - 9.81 * fallen_s**2 / 2, abs=0.01)
    assert len(world) == 60
    world.step(0.1)
    assert body(world, "can1").pose.position_m[2] == pytest.approx(
        50 - 9.81 * (fallen_s + 0.1) ** 2 / 2, abs=0.01
    )


def test_the_overview_passes_over_what_is_far_off():
    world = World()
    assert world.extent()[1] == pytest.approx((1, 1, 1))
    world.spawn([order(f"chair{i}", "chair", pose(2.0 * i, 0)) for i in range(5)])
    low, high = world.extent()
    world.spawn([order("lost", "cup", pose(400, -300))])
    assert world.extent()[0] == pytest.approx(low)
    assert world.extent()[1] == pytest.approx(high)
    assert (low[0], high[0]) == pytest.approx((-0.225, 8.225), abs=0.01)


def test_sleeping_time_costs_nothing_and_passes():
    world = World()
    world.spawn([order("cup1", "cup", pose(0, 0))])
    world.step(1.0)
    world.step(36_000.0)  # would take minutes if it were computed
    assert world.poses().sim_time_s == pytest.approx(36_001.0)


SCENE = """
<mujoco>
  <custom><text name="semmap:mug1" data="Cup"/></custom>
  <worldbody>
    <geom name="ground" type="plane" size="0 0 1"/>
    <geom name="partition" type="box" pos="0 9 1" size="3 0.1 1"/>
    <body name="table_2" pos="0 0 0.35"><geom type="box" size="0.5 0.5 0.35"/></body>
    <body name="mug1" pos="0 0 0.8"><freejoint/><geom type="cylinder" size="0.04 0.05"/></body>
    <body pos="2 0 0.1"><freejoint/><geom type="sphere" size="0.1"/></body>
    <body name="door" pos="4 0 0">
      <body pos="0 0 1"><joint type="hinge" axis="0 0 1"/><geom type="box" size="0.4 0.02 1"/></body>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.fixture
def own_world(tmp_path):
    path = tmp_path / "room.xml"
    path.write_text(SCENE)
    return World(read_mjcf(path))


def test_the_bodies_of_a_persons_world_are_in_the_scene(own_world):
    bodies = {b.name: b for b in own_world.scene().bodies}
    assert {name: b.class_ for name, b in bodies.items()} == {
        "table_2": "table",
        "mug1": "Cup",
        "body_3": "body",
        "door": "door",
    }
    assert [bodies[name].fixed for name in ("table_2", "mug1", "door")] == [True, False, True]
    assert not any(b.entity or b.commit for b in bodies.values())
    assert bodies["mug1"].size_m == pytest.approx((0.08, 0.08, 0.1))
    assert bodies["mug1"].pose.position_m == pytest.approx((0, 0, 0.75))
    own_world.step(1.0)
    assert height(own_world, "mug1") == pytest.approx(0.7, abs=0.002)


def test_entities_live_among_the_worlds_own(own_world):
    spawned = own_world.spawn([order("mug1", "cup", pose(1, 1)), order("can1", "can", pose(0, 0.2, 0))])
    assert set(spawned.failed) == {"mug1"}
    own_world.step(1.0)
    assert height(own_world, "can1") == pytest.approx(0.7, abs=0.003)  # lifted out of the table
    assert set(own_world.delete(["mug1", "can1"]).names) == {"mug1", "can1"}
    own_world.step(0.1)
    assert [b.name for b in own_world.scene().bodies] == ["table_2", "body_3", "door"]


def test_what_falls_off_a_world_comes_to_rest_below_it(tmp_path):
    path = tmp_path / "world.xml"
    path.write_text("<mujoco><worldbody><geom type='box' size='1 1 0.5' pos='0 0 1'/></worldbody></mujoco>")
    world = World(read_mjcf(path))
    world.spawn([order("on", "box", pose(0, 0, 1.5)), order("off", "box", pose(3, 0, 1.5))])
    world.step(3.0)
    on, off = world.scene().bodies
    assert on.resting
    assert off.resting
    assert on.pose.position_m == pytest.approx((0, 0, 1.5), abs=0.002)
    assert off.pose.position_m == pytest.approx((3, 0, 0.5), abs=0.002)


def test_cameras_have_names_that_can_be_keys(tmp_path):
    path = tmp_path / "world.xml"
    path.write_text(
        "<mujoco><worldbody><camera name='door'/><camera/><camera name='a/b *'/></worldbody></mujoco>"
    )
    assert camera_names(World(read_mjcf(path)).model) == ("door", "camera_2", "camera_3")


def test_names_that_are_given_are_nobody_elses(tmp_path):
    path = tmp_path / "world.xml"
    path.write_text(
        "<mujoco><worldbody><camera/><camera name='camera_1'/>"
        "<body><freejoint/><geom size='0.1'/></body>"
        "<body name='other'><freejoint name='joint_1'/><geom size='0.1' pos='1 0 0'/>"
        "<body name='body_1'><geom size='0.1' pos='1 0 0'/></body></body></worldbody></mujoco>"
    )
    world = World(read_mjcf(path))
    assert camera_names(world.model) == ("camera_2", "camera_1")
    assert [b.name for b in world.scene().bodies] == ["body_2", "other"]


def test_a_world_that_does_not_compile_is_refused(tmp_path):
    with pytest.raises(BadFile, match="cannot compile world file"):
        read_mjcf(tmp_path / "missing.xml")
    broken = tmp_path / "broken.xml"
    broken.write_text("<mujoco><worldbody><geom type='blob'/></worldbody></mujoco>")
    with pytest.raises(BadFile, match="cannot compile world file"):
        read_mjcf(broken)


DECLARED = """<mujoco><custom>
<text name="semmap:table_1" data="Table"/><text name="semmap:drawer" data="Drawer"/>
<text name="semmap:tabel_2" data="Table"/><text name="other" data="not ours"/>
</custom><worldbody><geom type="plane" size="0 0 .1"/>
<body name="table_1" pos="0 0 .4"><geom type="box" size=".4 .4 .4"/>
<body name="drawer" pos="0 0 .2"><geom type="box" size=".1 .1 .1"/></body></body>
</worldbody></mujoco>"""


def test_bodies_that_are_declared_in_vain_are_named():
    world = World(mujoco.MjSpec.from_string(DECLARED))
    assert world.ignored == ["tabel_2 (no such body)"]
    assert [(body.name, body.part_of) for body in world.scene().bodies] == [
        ("table_1", ""),
        ("drawer", "table_1"),
    ]
    assert World().ignored == []


def test_bodies_are_no_walls_whichever_way_they_came():
    world = World()
    world.spawn([order("cup1", "cup", pose(0, 0)), order("shelf1", "shelf", pose(2, 0), fixed=True)])
    before = world.walls()
    world.spawn([order("late", "cup", pose(0, 3)), order("later", "shelf", pose(4, 0), fixed=True)])
    assert world.walls() == before


ROVER = """<mujoco><worldbody>
  <geom type="plane" size="0 0 1"/>
  <camera name="above" pos="0 0 5"/>
  <body name="rover" pos="0 0 0.1"><freejoint name="rover_free"/>
    <geom type="box" size="0.3 0.3 0.1" mass="20"/>
    <camera name="eye" pos="0.3 0 0"/>
    <body name="gripper" pos="0.4 0 0"><joint name="finger" type="slide" axis="1 0 0" range="0 0.1"/>
      <geom type="box" size="0.05 0.05 0.05" mass="0.1"/></body>
    <body><geom type="box" size="0.01 0.01 0.1"/></body></body>
  <body name="shelf_1" pos="5 0 0.5"><geom type="box" size="0.2 0.5 0.5"/></body>
</worldbody>
<actuator>
  <general name="rover_drive_x" joint="rover_free" gear="1 0 0 0 0 0"/>
  <general name="rover_drive_y" joint="rover_free" gear="0 1 0 0 0 0"/>
  <general name="rover_drive_yaw" joint="rover_free" gear="0 0 0 0 0 1"/>
</actuator></mujoco>"""


@pytest.fixture
def rover():
    ground = mujoco.MjSpec.from_string(ROVER)
    world = World(ground, name="hall", classes=BodyClasses(class_map={"gripper": "Gripper"}))
    world.mark_robot("rover")
    return world


def commits(world):
    return dict(zip(world.poses().names, world.poses().commits, strict=True))


def test_a_robot_and_its_parts_have_been_placed_by_nobody_and_open_nothing(rover):
    assert commits(rover) == {"rover": -1, "gripper": -1, "shelf_1": 0}
    assert (body(rover, "rover").robot, body(rover, "gripper").robot) == (True, True)
    assert not body(rover, "shelf_1").robot
    assert [joint.closed for joint in body(rover, "gripper").joints] == [None]


def test_a_robot_that_is_moved_or_driven_has_been_placed_with_its_parts(rover):
    rover.move([hand("rover", pose(1.0, 1.0))])
    assert commits(rover) == {"rover": 0, "gripper": 0, "shelf_1": 0}


def test_what_else_is_moved_does_not_place_a_robot(rover):
    rover.spawn([order("can1", "can", pose(3, 3), commit=4)])
    rover.move([hand("can1", pose(2.0, 3.0))])
    assert commits(rover) == {"rover": -1, "gripper": -1, "shelf_1": 0, "can1": 4}


@pytest.mark.parametrize(
    ("asked", "why"),
    [
        (DriveBase(name="missing", to=((1.0, 0.0),)), "the scene has no body named missing"),
        (DriveBase(name="shelf_1", to=((1.0, 0.0),)), "shelf_1 cannot drive: its model has no velocity"),
        (DriveBase(name="rover", to=((1.0, 0.0), (900.0, 900.0))), r"\(900, 900\) is too far; .* 1000 m"),
    ],
    ids=["missing", "a shelf", "too far"],
)
def test_what_cannot_be_driven_there_has_a_reason(rover, asked, why):
    with pytest.raises(Refused, match=why):
        rover.drive(asked)
    assert rover.ended() == {}


def test_a_base_that_has_fallen_or_is_held_does_not_drive(rover):
    over = Pose(position_m=(0.0, 0.0, 0.5), orientation_wxyz=(math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0))
    rover.move([Placement(name="rover", pose=over)])
    with pytest.raises(Refused, match="rover"):
        rover.drive(DriveBase(name="rover", to=((1.0, 0.0),)))
    rover.drive(DriveBase(name="rover", to=()))  # to stop is possible all the same
    rover.move([hand("rover", pose(2.0, 0.0))])
    rover._engine.records["rover"].ghost = True
    with pytest.raises(Refused, match="another body occupies its place"):
        rover.drive(DriveBase(name="rover", to=((1.0, 0.0),)))


def test_a_base_drives_until_it_is_stopped_or_lifted_and_each_end_is_told_once(rover):
    rover.drive(DriveBase(name="rover", to=((1000.0, 0.0),)))
    assert commits(rover)["rover"] == 0
    assert not rover.asleep
    assert rover.ended() == {}
    rover.drive(DriveBase(name="rover", to=()))
    assert rover.ended() == {"rover": "stopped"}
    assert rover.ended() == {}
    rover.drive(DriveBase(name="rover", to=((4.0, 0.0),)))
    rover.move([hand("rover", pose(1.0, 1.0))])
    assert rover.ended() == {"rover": "stopped"}


def test_a_camera_is_told_with_who_carries_it(rover):
    above, eye = rover.cameras()
    assert (above.camera, above.part_of) == ("above", "")
    assert (eye.camera, eye.part_of) == ("eye", "rover")
    assert above.pose.position_m == pytest.approx((0.0, 0.0, 5.0))


def test_geoms_belong_to_the_body_that_they_are_a_part_of(rover):
    assert rover.body_names()[:5] == ["", "rover", "gripper", "rover", "shelf_1"]
    model, _, names = rover.snapshot()
    assert names == rover.body_names()
    assert rover.snapshot()[0] is model  # until bodies come or go
    rover.spawn([order("can1", "can", pose(3, 3))])
    assert rover.snapshot()[0] is not model
    assert "can1" in rover.snapshot()[2]


def test_a_world_s_own_geometry_stands_in_the_way_and_bodies_do_not(rover):
    assert rover.walls() == ()
    wall = mujoco.MjSpec.from_string(
        '<mujoco><worldbody><geom type="box" size="1 0.1 1" pos="0 0 1"/></worldbody></mujoco>'
    )
    assert len(World(wall).walls()) == 1


def test_the_tops_of_bodies_can_be_asked_for_also_within_a_box():
    world = World()
    boxes = [order(f"box{i}", "", pose(2.0 * i, 0), size_m=(0.4, 0.4, 0.3), commit=i) for i in range(3)]
    world.spawn(boxes)
    tops = world.tops()
    assert tops.keys() == {"box0", "box1", "box2"}
    assert tops["box1"] == pytest.approx((2.0, 0.0, 0.3))
    assert world.tops((np.array([3.0, -1, 0]), np.array([5.0, 1, 1]))).keys() == {"box2"}
    assert world.tops((np.array([3.0, -1, 0.2]), np.array([5.0, 1, 1]))).keys() == set()


def test_the_extent_is_that_of_all_bodies():
    world = World()
    world.spawn(
        [order(f"box{i}", "", pose(2.0 * i, 0, 0.5), size_m=(0.4, 0.4, 0.3), fixed=True) for i in range(3)]
    )
    low, high = world.extent()
    assert low == pytest.approx((-0.2, -0.2, 0.5))
    assert high == pytest.approx((4.2, 0.2, 0.8))
    assert len(world) == 3


def test_the_overview_looks_at_all_bodies():
    world = World()
    world.spawn([order("box1", "", pose(50.0, 20.0), size_m=(4.0, 4.0, 3.0))])
    world.aim_overview_camera()
    (camera,) = world.cameras()
    view = overview(*world.extent(), 4, 3, fovy_rad=base_scene.OVERVIEW_FOVY_RAD)
    assert camera.pose.position_m == pytest.approx(view.map_from_camera[:3, 3])


def test_each_order_to_hold_is_told_and_remembered_with_its_commit():
    world = World()
    world.spawn([order("tray1", "tray", pose(0, 0)), order("cup1", "cup", pose(0, 2, 1.0))])
    held = world.grip([GripOrder(name="cup1", holder="tray1")])
    (cup,) = held.bodies
    assert (cup.held_by, cup.grip_commit, held.failed) == ("tray1", 0, {})
    assert cup.grip.position_m == pytest.approx((0.0, 2.0, 1.0))  # where it is
    version = world.scene().version
    again = world.grip([GripOrder(name="cup1", holder="tray1")])
    assert again.bodies[0].grip == cup.grip
    assert world.scene().version == version
    world.grip([GripOrder(name="cup1", holder="tray1", grip=pose(0.0, 0.0, 0.5), commit=7)])
    assert body(world, "cup1").grip_commit == 7
    assert body(world, "cup1").pose.position_m == pytest.approx((0.0, 0.0, 0.5), abs=0.01)
    assert world.scene().version > version
    world.grip([GripOrder(name="cup1", holder="")])
    assert (body(world, "cup1").held_by, body(world, "cup1").grip) == ("", None)
    assert body(world, "cup1").grip_commit == 7


def test_held_by_another_it_is_held_where_it_is_then():
    world = World()
    trays = [order(f"tray{i}", "tray", pose(2.0 * i, 0)) for i in range(2)]
    world.spawn([*trays, order("cup1", "cup", pose(0, 2, 1.0))])
    world.grip([GripOrder(name="cup1", holder="tray0", commit=3)])
    world.grip([GripOrder(name="cup1", holder="tray1", commit=4)])
    assert body(world, "cup1").grip.position_m == pytest.approx((-2.0, 2.0, 1.0), abs=0.01)


def test_an_order_for_joints_counts_with_its_commit():
    world = World()
    world.spawn([order("fridge1", "fridge", pose(0, 0)), order("cup1", "cup", pose(3, 3))])
    assert world.joints_at_rest == 0
    world.step(2.0)
    assert world.joints_at_rest == 2
    moving = world.move_joints([JointOrder(name="fridge1", openness=1.0, commit=9)])
    assert (moving.failed, moving.bodies[0].joint_commit) == ({}, 9)
    assert world.poses().joint_commits == (9,)
    assert world.joints_at_rest == 0
    world.move_joints([JointOrder(name="fridge1", openness=0.5)])
    assert world.poses().joint_commits == (9,)


def test_an_order_to_move_counts_as_tried_also_where_it_fails():
    world = World()
    world.spawn([order("cup1", "cup", pose(0, 0))])
    failed = world.move(
        [
            Placement(name="cup1", pose=pose(0, 2000), commit=5),
            Placement(name="missing", pose=pose(0, 2), commit=6),
        ]
    ).failed
    assert failed.keys() == {"cup1", "missing"}
    assert commits(world) == {"cup1": 5}
    world.move([Placement(name="cup1", pose=pose(0, 3))])
    assert commits(world) == {"cup1": 5}
    world.reset()  # a hand has moved it, not the map
    assert body(world, "cup1").pose.position_m[:2] == pytest.approx((0.0, 0.0))


def test_reset_puts_joints_back_and_leaves_what_is_held():
    world = World()
    world.spawn([order("fridge1", "fridge", pose(0, 0)), order("cup1", "cup", pose(3, 3))])
    world.grip([GripOrder(name="cup1", holder="fridge1", commit=2)])
    world.move_joints([JointOrder(name="fridge1", openness=1.0)])
    world.step(3.0)
    assert world.reset() == 2
    assert world.poses().joints == pytest.approx((0.0, 0.0))
    assert body(world, "cup1").held_by == "fridge1"


def test_bodies_look_like_their_models_and_a_world_s_own_like_their_parts(rover):
    rover.spawn([order("can1", "can", pose(3, 3))])
    found = rover.surfaces(["can1", "shelf_1", "missing"]).surfaces
    assert found.keys() == {"can1", "shelf_1"}
    assert found["can1"] == surface_of(library_model("can", None))
    shelf = np.frombuffer(found["shelf_1"].points, "<f4").reshape(-1, 3)
    assert shelf.max(axis=0) == pytest.approx((0.2, 0.5, 1.0), abs=1e-5)
    assert shelf[:, 2].min() == pytest.approx(0.0, abs=1e-5)
    assert rover.surface().points == b""  # of an endless floor


def test_bodies_of_the_world_file_have_a_digest_of_their_surface_at_any_position():
    world = World(
        mujoco.MjSpec.from_string("""<mujoco><worldbody><geom type="plane" size="0 0 .1"/>
          <body name="cup1" pos="1 2 .05"><freejoint/><geom type="cylinder" size=".04 .05"/></body>
          <body name="cup2" pos="3.3 .7 .05" euler="0 0 40"><freejoint/>
            <geom type="cylinder" size=".04 .05"/></body>
          <body name="cup3" pos="5 0 .06"><freejoint/><geom type="cylinder" size=".04 .06"/></body>
          <body name="box1" pos="0 0 0"><geom type="box" size=".2 .2 .1" pos="0 0 .1"/>
            <body name="flap" pos="-.2 0 .21"><joint name="lid" axis="0 -1 0" range="0 100" damping="1"/>
              <geom type="box" size=".2 .2 .01" pos=".2 0 0"/></body></body>
        </worldbody></mujoco>""")
    )
    world.spawn([order("can1", "can", pose(3, 3))])
    before = {name: there.surface for name, there in bodies(world).items()}
    assert before["cup1"] == before["cup2"] != ""
    assert len({before[name] for name in ("cup1", "cup3", "box1")}) == 3
    assert before["can1"] == ""
    (closed,) = world.surfaces(["box1"]).surfaces.values()
    assert [leaf.joint for leaf in closed.leaves] == ["lid"]
    world.move_joints([JointOrder(name="box1", openness=1.0)])
    world.step(3.0)
    assert body(world, "box1").joints[0].position > 1.0
    assert world.surfaces(["box1"]).surfaces["box1"] == closed


@pytest.mark.parametrize("turn", ["0 0 0", "45 30 20", "10 80 -50"])
@pytest.mark.parametrize(
    "geom",
    [
        'type="sphere" size=".3"',
        'type="ellipsoid" size=".3 .2 .1"',
        'type="cylinder" size=".1 .4"',
        'type="capsule" size=".1 .4"',
        'type="box" size=".3 .2 .1"',
        'type="mesh" mesh="wedge"',
    ],
)
def test_the_size_of_a_body_of_the_world_file_is_that_of_its_surface(geom, turn):
    world = World(
        mujoco.MjSpec.from_string(f"""<mujoco>
          <asset><mesh name="wedge" vertex="0 0 0 .6 0 0 0 .6 0 0 0 .5 .6 0 .1"/></asset>
          <worldbody><body name="thing1" pos="1 2 3" euler="20 10 30"><geom {geom} euler="{turn}"/></body>
          </worldbody></mujoco>""")
    )
    points = np.frombuffer(world.surfaces(["thing1"]).surfaces["thing1"].points, "<f4").reshape(-1, 3)
    size = np.array(body(world, "thing1").size_m)
    low, high = points.min(axis=0), points.max(axis=0)
    assert high - low == pytest.approx(size, rel=0.05)  # round surfaces have facets
    assert low == pytest.approx((-size[0] / 2, -size[1] / 2, 0.0), abs=0.05 * size.max())


def test_names_that_are_not_there_are_not_deleted_and_each_is_once():
    world = World()
    world.spawn([order("cup1", "cup", pose(0, 0))])
    assert world.delete(["cup1", "missing", "cup1"]).names == ("cup1",)
    assert world.delete(["cup1"]).names == ()


def test_a_world_that_can_rest_can_be_asked_how_much_is_awake():
    world = World()
    world.spawn([order("cup1", "cup", pose(0, 0))])
    assert (world.asleep, world.awake > 0) == (False, True)
    world.step(2.0)
    assert (world.asleep, world.awake) == (True, 0)
    assert world.poses().sim_time_s == pytest.approx(2.0)
    assert world.scene().sim_time_s == pytest.approx(2.0)
    assert world.poses().version == world.scene().version
    assert world.poses().run == world.run


ODD = """<mujoco><worldbody><geom type="plane" size="0 0 .1"/>
<body name="mug 2" pos="0 0 .05"><freejoint/><geom type="cylinder" size=".04 .05"/></body>
<body name="mug_2" pos="1 0 .05"><freejoint/><geom type="cylinder" size=".04 .05"/></body>
<body name="shelf/1" pos="2 0 .5"><geom type="box" size=".2 .5 .5"/></body>
<body name="desk_caddy" pos="3 0 .05"><freejoint/><geom type="box" size=".1 .1 .05"/></body>
</worldbody></mujoco>"""


@pytest.fixture
def odd():
    return World(mujoco.MjSpec.from_string(ODD), classes=BodyClasses(household_classes()))


def test_bodies_with_other_names_have_the_names_of_their_entities(odd):
    found = {name: (there.body, there.class_) for name, there in bodies(odd).items()}
    assert found == {
        "mug_2_2": ("mug 2", "Cup"),
        "mug_2": ("", "Cup"),
        "shelf_1": ("shelf/1", "Shelf"),
        "desk_caddy": ("", "Object"),
    }
    assert odd.notes == (
        "2 bodies of the world have other names in the map: mug 2 is mug_2_2 and shelf/1 is shelf_1",
        "unknown class of 1 body of the world: desk_caddy; name the classes in a JSON file, such as"
        ' {"desk_caddy": "CLASS"}, and start with --class-map FILE',
    )


def test_bodies_with_other_names_are_moved_attached_and_deleted(odd):
    odd.step(0.5)
    odd.move([hand("mug_2_2", pose(4.0, 1.0))])
    odd.step(0.5)
    assert body(odd, "mug_2_2").pose.position_m == pytest.approx((4.0, 1.0, 0.0), abs=0.01)
    odd.move([hand("shelf_1", pose(5.0, 1.0))])
    assert body(odd, "shelf_1").pose.position_m == pytest.approx((5.0, 1.0, 0.0), abs=0.01)
    assert odd.grip([GripOrder(name="mug_2_2", holder="shelf_1")]).failed == {}
    odd.step(0.2)
    assert body(odd, "mug_2_2").held_by == "shelf_1"
    odd.delete(["shelf_1"])
    assert bodies(odd).keys() == {"mug_2_2", "mug_2", "desk_caddy"}


CHAIN = """<mujoco><option timestep=".02"/><worldbody><geom type="plane" size="0 0 .1"/>
<body name="cup_1" pos="0 0 .05"><freejoint/><geom type="cylinder" size=".04 .05"/></body>
<body name="chain_1" pos="1 0 1"><joint name="a" type="hinge" axis="0 1 0" stiffness="1e9" springref="3"/>
 <geom type="box" size=".1 .02 .02" mass=".01"/>
 <body name="link_2" pos=".1 0 0"><joint name="b" type="ball"/>
  <geom type="box" size=".1 .02 .02" mass=".01"/></body>
</body></worldbody></mujoco>"""


def test_a_body_that_is_not_stable_is_reported_once_and_the_others_go_on():
    world = World(mujoco.MjSpec.from_string(CHAIN))
    version = world.scene().version
    world.step(2.0)
    assert world.scene().unstable == ("chain_1",)
    assert world.scene().version == version + 1
    assert body(world, "cup_1").resting
    assert all(map(math.isfinite, world.poses().poses))


def test_hundreds_of_bodies_at_one_spot_are_a_low_tower_without_a_search_of_all_places(monkeypatch):
    tried = []
    hits = Obstacles.hits
    monkeypatch.setattr(Obstacles, "hits", lambda self, *args: tried.append(1) or hits(self, *args))
    world = World()
    count = 60
    world.spawn([order(f"cup{i}", "cup", pose(0.0, 0.0)) for i in range(count)])
    heights = sorted(there.pose.position_m[2] for there in bodies(world).values() if not there.ghost)
    assert 5 < len(heights) < 15
    assert np.diff(heights).min() > 0.05
    ghosts = [there for there in bodies(world).values() if there.ghost]
    assert all(there.in_the_way and there.pose == pose(0.0, 0.0) for there in ghosts)
    assert len(tried) < 20 * count


def test_only_bodies_that_exist_have_a_state_to_store():
    world = spawned(order("can1", "can", pose(1, 0)), order("fridge1", "fridge", pose(3, 0)))
    stored = world.stored_bodies(["can1", "fridge1", "gone1"])
    assert stored.keys() == {"can1", "fridge1"}
    assert stored["can1"].pose.position_m == pytest.approx((1.0, 0.0, 0.0), abs=1e-6)
    assert (stored["can1"].joints, stored["can1"].held_by) == ({}, "")
    assert stored["fridge1"].joints
    other = spawned(order("can1", "can", pose(0, 5)), order("fridge1", "fridge", pose(6, 6)))
    other.restore(stored)
    assert other.stored_bodies(["can1", "fridge1"]) == stored
