"""A body that differs from its committed pose is a disagreement, moving or not."""

from __future__ import annotations

import pytest
from msgspec import structs

from semmap.nodes.coordinator.reconciler.agreement import describe_displaced, describe_pending, find_displaced
from semmap.nodes.coordinator.reconciler.reconcile import Actions
from semmap.schemas.attachments import IS_GRASPED_BY
from semmap.schemas.entities import Entity
from semmap.schemas.joints import Joint
from semmap.schemas.scenes import Body
from tests.coordinator.reconciler.test_reconcile import THRESHOLDS, at, body, entity, look

ARM = Joint(name="arm", kind="hinge", lower=-1.0, upper=1.0)


def displaced(entities: list[Entity], bodies: list[Body], truth="map", unsaid=()) -> tuple[str, ...]:
    known, there = {e.name: e for e in entities}, {b.name: b for b in bodies}
    found = find_displaced(known, there, truth, THRESHOLDS, unsaid)
    return tuple(describe_displaced(known[name], there[name], THRESHOLDS) for name in found)


def tracked(name: str = "robot1", how: str = "sim") -> Entity:
    return structs.replace(entity(name, at(0.0)), tracked=how)


@pytest.mark.parametrize("truth", ["map", "scene", "perceived", "replayed"])
def test_a_driving_robot_is_named_with_its_distance_though_no_action_is_due(truth):
    robot = structs.replace(body("robot1", at(1.2), resting=False), robot=True)
    assert look([tracked()], [robot], truth) == Actions()
    assert displaced([tracked()], [robot], truth) == ("robot1 is moving: 1.2 m from its committed pose",)


def test_within_the_thresholds_a_body_agrees_while_it_moves():
    assert displaced([tracked()], [body("robot1", at(0.04, yaw=0.08), resting=False)]) == ()


def test_a_body_that_turns_on_the_spot_is_named_with_its_angle():
    turning = body("robot1", at(0.0, yaw=0.35), resting=False)
    assert displaced([tracked()], [turning]) == ("robot1 is moving: turned by 20° from its committed pose",)


def test_a_body_that_rests_where_nothing_will_be_done_about_it_is_named():
    """The pose of the robot comes from a stream, so the map does not follow its body."""
    assert displaced([tracked(how="stream")], [body("robot1", at(0.3))]) == (
        "robot1 stands still: 0.3 m from its committed pose",
    )


def test_a_door_that_moves_is_named():
    door = structs.replace(ARM, position=0.5)
    moving = structs.replace(body("fridge1", at(0.0), resting=False), joints=(door,))
    assert displaced([entity("fridge1", at(0.0))], [moving]) == (
        "fridge1 is moving: its joints are not at their committed positions",
    )
    assert displaced([entity("fridge1", at(0.0))], [moving], unsaid={"fridge1"}) == ()


def test_an_attached_body_is_where_its_holder_takes_it():
    held = structs.replace(body("cup1", at(3.0)), held_by="tray1")
    assert displaced([entity("cup1", at(0.0))], [held]) == ()
    committed = structs.replace(entity("cup1", at(0.0)), properties={IS_GRASPED_BY: "tray1"})
    assert displaced([committed], [body("cup1", at(3.0))]) == ()


def test_the_parts_of_a_robot_under_way_are_not_named_beside_it():
    robot = body("robot1", at(1.0), resting=False)
    arm = structs.replace(body("arm1", at(1.0), resting=False), part_of="robot1")
    hand = structs.replace(body("hand1", at(1.0), resting=False), part_of="arm1")
    entities = [tracked(name) for name in ("robot1", "arm1", "hand1")]
    assert [text.split()[0] for text in displaced(entities, [hand, arm, robot])] == ["robot1"]
    waving = structs.replace(robot, pose=at(0.0))
    assert [text.split()[0] for text in displaced(entities, [hand, arm, waving])] == ["arm1"]


def test_where_perception_updates_the_map_the_world_is_not_compared_with_it():
    assert displaced([entity("cup1", at(0.0))], [body("cup1", at(3.0))], "perceived") == ()


def test_a_body_without_an_entity_and_an_entity_without_a_pose_are_not_displaced():
    assert displaced([entity("cup1", None)], [body("cup1", at(3.0)), body("cup2", at(3.0))]) == ()


def test_pending_actions_are_described_once_for_each_entity():
    chair, cup = entity("chair1", at(0.0), shaped=2), entity("cup1", at(0.0))
    found = look([chair, cup], [body("chair1", at(0.0)), body("cup1", at(1.0))])
    assert describe_pending(found, ()) == (
        "chair1 has no body yet",
        "cup1 has a new pose that is not committed yet",
    )
    gone = look([], [body("chair1", at(0.0))])
    assert describe_pending(gone, ()) == ("chair1 has a body that is not removed yet",)


def test_a_scene_body_that_cannot_become_an_entity_is_not_waited_for():
    wanted = look([], [body("gizmo1", at(0.0), of_entity=False)], "scene")
    assert describe_pending(wanted, ()) == ("gizmo1 is a scene body that is not an entity yet",)
    assert describe_pending(wanted, {"gizmo1"}) == ()


def test_a_robot_that_does_not_come_to_rest_is_named_with_the_next_step():
    robot = structs.replace(body("robot1", at(0.0), resting=False), robot=True)
    (text,) = describe_pending(look([], [robot]), ())
    assert text == (
        "robot1 is a scene body that is not an entity yet: it does not rest;"
        " if it overlaps a wall, use semmap move robot1 --at X Y Z"
    )
