import math
import random

import numpy as np
import pytest

from semmap.nodes.extern.ros.planning_scene import follow_scene, forget_scene, planning_scene
from semmap.nodes.extern.ros.robots import Grasp
from semmap.nodes.extern.ros.types import decode, encode
from semmap.ontology.model_shapes import ConvexPart
from semmap.schemas.entities import Pose, compose
from semmap.schemas.scenes import Leaf, Surface
from tests.extern.ros.made import AT, by_name, thing
from tests.extern.ros.planner import ADD, MOVE, REMOVE, Planner

HELD = Grasp("hand", ("hand", "finger"))


@pytest.fixture
def scene_of():
    def scene_of(now, before=(), surfaces=None):
        said = planning_scene(by_name(*now), by_name(*before), surfaces or {}, AT)
        return None if said is None else decode(encode(said), "moveit_msgs/msg/PlanningScene")

    return scene_of


def test_a_scene_to_plan_in_says_what_came_moved_and_went(scene_of):
    before = [thing("stays"), thing("moves"), thing("goes"), thing("grows")]
    now = [thing("stays"), thing("moves", at=(2, 2, 0)), thing("grows", size_m=(1, 1, 1)), thing("comes")]
    said = scene_of(now, before)
    assert said.is_diff
    assert said.robot_state.is_diff
    assert {o.id: o.operation for o in said.world.collision_objects} == {
        "moves": MOVE, "goes": REMOVE, "grows": ADD, "comes": ADD,
    }  # fmt: skip


def test_a_scene_that_did_not_change_is_not_said(scene_of):
    assert scene_of([thing()], [thing(at=(1.0004, 2, 0.7))]) is None


def test_an_obstacle_has_its_class_and_its_box(scene_of):
    (said,) = scene_of([thing()]).world.collision_objects
    assert said.type.key == "Cup"
    assert said.primitives[0].dimensions.tolist() == [0.08, 0.08, 0.1]
    assert said.primitive_poses[0].position.z == 0.05


def test_an_entity_without_a_size_and_a_place_are_not_obstacles(scene_of):
    assert scene_of([thing(size_m=None), thing("k", place=True)]) is None
    assert scene_of([thing(size_m=None)], [thing()]).world.collision_objects[0].operation == REMOVE


def test_a_door_that_moves_is_sent_again_where_it_is(scene_of):
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 0, 1]], "<f4")
    leaf = Leaf(joint="door", kind="hinge", axis=(0, 0, 1), anchor=(0, 0, 0), first=0, count=3)
    door = Surface(
        points=corners.tobytes(),
        normals=corners.tobytes(),
        colours=b"",
        triangles=np.arange(3, dtype="<u4").tobytes(),
        leaves=(leaf,),
    )
    opened = thing(joint_positions=(("door", math.pi / 2),))
    (said,) = scene_of([opened], [thing()], {"cup1": door}).world.collision_objects
    assert said.operation == ADD
    vertices = sorted((v.x, v.y, v.z) for v in said.meshes[0].vertices)
    assert np.array(vertices) == pytest.approx(np.array([(0, 0, 0), (0, 0, 1), (0, 1, 0)]), abs=1e-6)
    assert scene_of([opened], [opened], {"cup1": door}) is None


def test_an_obstacle_may_be_what_it_looks_like(scene_of):
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], "<f4")
    surface = Surface(
        points=corners.tobytes(),
        normals=b"",
        colours=b"",
        triangles=np.arange(6, dtype="<u4").tobytes(),
    )
    (said,) = scene_of([thing()], surfaces={"cup1": surface}).world.collision_objects
    (mesh,) = said.meshes
    assert not said.primitives
    assert len(mesh.vertices) == 4  # corners that triangles share are one
    where = [(v.x, v.y, v.z) for v in mesh.vertices]
    triangles = [[where[i] for i in t.vertex_indices] for t in mesh.triangles]
    assert triangles == [[(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(1, 0, 0), (1, 1, 0), (0, 1, 0)]]


def test_an_obstacle_has_the_parts_of_its_shape(scene_of):
    board = ConvexPart(centre=(0, 0, 0.7), straight=((0.5, 0, 0), (0, 0.4, 0), (0, 0, 0.01)))
    leg = ConvexPart(centre=(0, 0, 0.35), straight=((0, 0, 0.35),), round=((0.05, 0, 0), (0, 0.05, 0)))
    (table,) = scene_of([thing("table1", parts=(board, leg))]).world.collision_objects
    assert [(p.type, p.dimensions.tolist()) for p in table.primitives] == [
        (1, [1.0, 0.8, 0.02]),
        (3, [0.7, 0.05]),
    ]
    assert [pose.position.z for pose in table.primitive_poses] == [0.7, 0.35]


def test_a_robot_is_not_an_obstacle(scene_of):
    assert scene_of([thing("hand", robot=True)]) is None


def test_a_grasped_object_is_attached_to_the_link_and_no_longer_in_the_world(scene_of):
    held = thing(grasp=HELD)
    taken = scene_of([held], [thing()])
    (attached,) = taken.robot_state.attached_collision_objects
    assert (attached.link_name, attached.touch_links) == ("hand", ["hand", "finger"])
    assert (attached.object.id, attached.object.operation) == ("cup1", ADD)
    assert attached.object.primitives
    assert [(o.id, o.operation) for o in taken.world.collision_objects] == [("cup1", REMOVE)]
    carried = thing(grasp=HELD, at=(5, 5, 1))
    assert scene_of([carried], [held]) is None  # it moves with the link
    (new,) = scene_of([carried]).robot_state.attached_collision_objects
    assert new.object.pose.position.x == 5
    assert scene_of([carried]).world.collision_objects == []


def test_a_released_object_is_detached_and_an_obstacle_again(scene_of):
    released = scene_of([thing()], [thing(grasp=HELD)])
    (detached,) = released.robot_state.attached_collision_objects
    assert (detached.link_name, detached.object.id, detached.object.operation) == ("hand", "cup1", REMOVE)
    (back,) = released.world.collision_objects
    assert (back.id, back.operation) == ("cup1", ADD)
    assert back.primitives


def test_an_object_that_was_removed_while_held_does_not_stay_in_the_world(scene_of):
    gone = scene_of([], [thing(grasp=HELD)])
    assert [a.object.operation for a in gone.robot_state.attached_collision_objects] == [REMOVE]
    assert [(o.id, o.operation) for o in gone.world.collision_objects] == [("cup1", REMOVE)]


def test_an_object_that_another_hand_takes_is_attached_again(scene_of):
    passed = scene_of([thing(grasp=Grasp("left", ("left",)))], [thing(grasp=HELD)])
    (attached,) = passed.robot_state.attached_collision_objects
    assert (attached.link_name, attached.object.operation) == ("left", ADD)
    assert passed.world.collision_objects == []


def test_an_object_that_moves_in_the_hand_is_attached_again(scene_of):
    hand, cup = thing("hand", robot=True), thing(grasp=HELD)
    moved = [thing("hand", robot=True, at=(1, 2, 1), yaw=1.0), thing(grasp=HELD, at=(1, 2, 1), yaw=1.0)]
    assert scene_of(moved, [hand, cup]) is None
    slipped = scene_of([hand, thing(grasp=HELD, at=(1.0, 2.0, 0.75))], [hand, cup])
    (attached,) = slipped.robot_state.attached_collision_objects
    assert (attached.link_name, attached.object.operation) == ("hand", ADD)
    assert attached.object.pose.position.z == 0.75
    assert scene_of([hand, thing(grasp=HELD, yaw=0.1)], [hand, cup]) is not None


def test_small_changes_that_add_up_are_sent(scene_of):
    """A cup slips by 4 mm and another one slides by 0.6 mm a step, while the hand moves and turns."""
    planner, sent, counts = Planner(), {}, []
    for step in range(20):
        hand = thing("hand", robot=True, at=(step / 10, 2.0, 1.0), yaw=step / 10)
        grip = Pose(position_m=(0.1, 0.0, -0.004 * step))
        slipping = thing(grasp=HELD)._replace(pose=compose(hand.pose, grip))
        now = by_name(hand, slipping, thing("cup2", at=(0.0006 * step, 0.0, 0.0)))
        if (scene := scene_of(now.values(), sent.values())) is not None:
            planner.take(scene)
        counts.append(0 if scene is None else len(scene.robot_state.attached_collision_objects))
        sent = follow_scene(sent, now)
        assert planner.poses["cup2"].position.x == pytest.approx(0.0006 * step, abs=1e-3)
        assert sent["cup1"].pose.position_m[:2] == pytest.approx(slipping.pose.position_m[:2])
        assert sent["cup1"].pose.position_m[2] == pytest.approx(slipping.pose.position_m[2], abs=0.005)
    assert counts == [1, 0] * 10, "two steps are more than the tolerance"


def test_a_whole_scene_detaches_what_was_let_go_since_the_last_one(scene_of):
    sent = by_name(thing("gone"), thing("kept"), thing(grasp=HELD), thing("plate1", grasp=HELD))
    now = by_name(thing("kept"), thing(), thing("plate1", grasp=HELD))
    whole = scene_of(now.values(), forget_scene(sent, now).values())
    assert {(a.object.id, a.object.operation) for a in whole.robot_state.attached_collision_objects} == {
        ("cup1", REMOVE),
        ("plate1", ADD),
    }
    assert {(o.id, o.operation) for o in whole.world.collision_objects} == {
        ("gone", REMOVE), ("kept", ADD), ("cup1", ADD),
    }  # fmt: skip


@pytest.mark.parametrize("seed", range(12))
def test_a_planner_that_follows_the_differences_has_the_objects_of_the_map(scene_of, seed):
    """Objects come, move, grow, are held by either hand, and are sent again at any time."""
    lots, planner, sent = random.Random(seed), Planner(), {}
    for _ in range(40):
        now = by_name(thing("hand", robot=True, at=(0, lots.random(), 1)), thing("left", robot=True))
        for name in ("cup1", "cup2", "plate1"):
            grasp = lots.choice([None, HELD, Grasp("left", ("left",))])
            height = lots.choice([0.1, 0.2])
            if lots.random() < 0.8:
                now[name] = thing(name, at=(lots.random(), 2, 1), size_m=(0.1, 0.1, height), grasp=grasp)
        before = forget_scene(sent, now) if lots.random() < 0.3 else sent
        if (scene := scene_of(now.values(), before.values())) is not None:
            planner.take(scene)
        sent = follow_scene(before, now)
        objects = {name: each for name, each in now.items() if not each.robot}
        assert planner.attached == {n: each.grasp.link for n, each in objects.items() if each.grasp}
        assert planner.obstacles.keys() == {n for n, each in objects.items() if not each.grasp}
        for name, each in objects.items():
            if not each.grasp:
                assert planner.obstacles[name].primitives or planner.obstacles[name].operation == MOVE
            assert planner.poses[name].position.x == pytest.approx(each.pose.position_m[0], abs=0.01)
