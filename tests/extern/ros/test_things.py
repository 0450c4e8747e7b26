"""Poses and sizes of entities, robots and what they hold."""

import pytest
from msgspec import structs

from semmap.nodes.extern.ros.things import located_things
from semmap.ontology.model_shapes import ConvexPart, ModelShape
from semmap.schemas.joints import Joint
from tests.extern.ros.made import by_name
from tests.recorder.messages import body, entity, pose

PART = ConvexPart(centre=(0.0, 0.0, 0.1), straight=((0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1)))
SHAPE = ModelShape(size_m=(0.2, 0.2, 0.2), parts=(PART,))


def part(name, whole, **others):
    return entity(name, "Device", properties={"isDirectPartOf": whole}, **others)


@pytest.fixture
def kitchen():
    robot = structs.replace(entity("robot1", "Robot", at=pose(5.0)), types=("Device", "Robot"))
    held = {"isGraspedBy": "hand", "graspPose": "0 0 0.5 1 0 0 0"}
    return by_name(
        robot,
        part("arm", "robot1"),
        part("hand", "arm", at=pose(6.0)),
        part("finger", "hand"),
        entity("tray1", "Tray", properties=held),
        entity("cup1", "Cup", properties={"isGraspedBy": "tray1", "graspPose": "0 0 0.1 1 0 0 0"}),
        entity("lid1", "Lid", properties={"isGraspedBy": "pot1"}),
        entity("pot1", "Pot", at=pose(1.0)),
    )


def test_the_joints_are_those_of_the_body():
    jointed = body("c", joints=(Joint(name="door", kind="hinge", position=1.0),))
    (found,) = located_things(by_name(entity("c")), {"c": jointed}, {}).values()
    assert found.joint_positions == (("door", 1.0),)


def test_a_size_that_is_not_stated_is_that_of_the_shape():
    both = by_name(entity("a"), entity("b", size_m=(1.0, 1.0, 1.0)), entity("c"))
    shapes = {"a": SHAPE, "b": SHAPE}
    found = located_things(both, {}, {}, lambda of: shapes.get(of.name))
    assert [found[name].size_m for name in "abc"] == [SHAPE.size_m, (1.0, 1.0, 1.0), None]
    assert found["a"].parts == (PART,)


def test_a_robot_and_its_parts_are_marked(kitchen):
    found = located_things(kitchen, {}, {})
    assert {name for name, each in found.items() if each.robot} == {"robot1", "arm", "hand", "finger"}


def test_the_bodies_of_a_robot_are_parts_of_it(kitchen):
    bodies = {"robot9": body("robot9", robot=True), "grip9": body("grip9", part_of="robot9")}
    entities = {**kitchen, **by_name(entity("robot9"), entity("grip9"))}
    found = located_things(entities, bodies, {})
    assert found["robot9"].robot
    assert found["grip9"].robot


def test_what_is_on_a_held_tray_is_held_by_the_hand(kitchen):
    found = located_things(kitchen, {}, {})
    assert found["tray1"].grasp == found["cup1"].grasp == ("hand", ("hand", "finger"))
    assert found["lid1"].grasp is None


def test_held_objects_are_where_their_holder_is(kitchen):
    found = located_things(kitchen, {}, {"hand": pose(7.0)})
    assert found["tray1"].pose.position_m == pytest.approx((7.0, 0.0, 0.5))
    assert found["cup1"].pose.position_m == pytest.approx((7.0, 0.0, 0.6))
    assert located_things(kitchen, {}, {})["cup1"].pose.position_m == pytest.approx((6.0, 0.0, 0.6))


def test_two_that_hold_each_other_end():
    grips = [{"isGraspedBy": other, "graspPose": "0 0 1 1 0 0 0"} for other in "ba"]
    found = located_things(
        by_name(entity("a", properties=grips[0]), entity("b", properties=grips[1])), {}, {}
    )
    assert found["a"].grasp is found["b"].grasp is None
