import math

import numpy as np
import pytest

from semmap.nodes.extern.ros import messages
from semmap.nodes.extern.ros.things import located_things
from semmap.nodes.extern.ros.types import decode, encode
from semmap.schemas.joints import Joint
from semmap.schemas.scenes import Leaf, Surface
from tests.extern.ros.made import AT, by_name, thing
from tests.recorder.messages import body, entity

ADD, REMOVE, MOVE = 0, 1, 3


def test_a_detection_is_the_box_around_the_middle():
    (found,) = messages.detections([thing(yaw=math.pi / 2, probability=0.5)], AT).detections
    assert (found.id, found.header.frame_id) == ("cup1", "map")
    assert (found.header.stamp.sec, found.header.stamp.nanosec) == (1, 500_000_002)
    assert found.bbox.center.position.z == pytest.approx(0.75)
    assert found.bbox.center.orientation.z == pytest.approx(math.sqrt(0.5))
    (hypothesis,) = found.results
    assert (hypothesis.hypothesis.class_id, hypothesis.hypothesis.score) == ("Cup", 0.5)


def test_a_place_is_not_a_detection_and_has_a_name_and_a_frame():
    room = thing("kitchen1", "Kitchen", place=True, size_m=(3.0, 3.0, 2.5))
    assert messages.detections([room], AT).detections == []
    assert [m.text for m in messages.markers([room], AT).markers] == ["", "kitchen1"]
    (frame,) = messages.transforms([room], AT).transforms
    assert (frame.header.frame_id, frame.child_frame_id) == ("map", "kitchen1")


def test_markers_begin_by_deleting_all_and_no_two_have_one_number():
    drawn = messages.markers([thing("a"), thing("b")], AT).markers
    assert drawn[0].action == 3
    assert len({(m.ns, m.id) for m in drawn[1:]}) == len(drawn) - 1 == 4


@pytest.fixture
def scene_of():
    def scene_of(now, before=(), surfaces=None):
        said = messages.planning_scene(by_name(*now), by_name(*before), surfaces or {}, AT)
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
    jointed = body("c", joints=(Joint(name="door", kind="hinge", position=1.0),))
    assert located_things([entity("c")], {"c": jointed}, {})["c"].joint_positions == (("door", 1.0),)


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
