"""Current poses of entities and cameras, their sources, and their parent frames."""

from __future__ import annotations

import math

import pytest
from msgspec import structs

from semmap.nodes.coordinator.frames.links import EntityLinks, camera_links
from semmap.nodes.coordinator.frames.tree import Link
from semmap.schemas.entities import Live, Pose, orientation_from_yaw
from semmap.schemas.scenes import CameraPose
from tests.coordinator.reconciler.test_reconcile import at, body, entity


def one(name, pose, *, part_of="", tracked="", place=False):
    said = {"isDirectPartOf": part_of} if part_of else {}
    return structs.replace(entity(name, pose, place=place), properties=said, tracked=tracked)


def links(*entities, live=None, bodies=()):
    return EntityLinks(
        {e.name: e for e in entities},
        lambda e: (live or {}).get(e.name),
        {b.name: b for b in bodies},
        lambda: 0.25,
    )


def lives(pose, *, stale=False, source="stream", age_s=0.5):
    return Live(pose=pose, stamp_ns=1, age_s=age_s, source=source, stale=stale)


def test_an_unknown_name_has_no_link():
    assert links().link("chair1") is None


def test_an_entity_is_where_the_map_says():
    assert links(one("chair1", at(1.0))).link("chair1") == Link("map", at(1.0), "map")


def test_an_entity_without_a_position_has_a_problem():
    link = links(one("chair1", None)).link("chair1")
    assert (link.parent, link.pose, link.source) == ("map", None, "map")
    assert link.problem == "chair1 has no position, so it cannot be used as a frame"


def test_what_is_tracked_is_where_it_was_last_seen():
    link = links(one("robot1", at(1.0), tracked="sim"), live={"robot1": lives(at(3.0), source="sim")}).link(
        "robot1"
    )
    assert link == Link("map", at(3.0), "sim", 0.5)


def test_a_stale_pose_is_reported():
    link = links(
        one("robot1", at(1.0), tracked="stream"), live={"robot1": lives(at(3.0), stale=True, age_s=30.0)}
    ).link("robot1")
    problem = "the live pose of robot1 is stale: none received for 30 s"
    assert link == Link("map", at(3.0), "stream", 30.0, stale=True, problem=problem)


@pytest.mark.parametrize("tracked", ["sim", "stream"])
def test_a_tracked_entity_without_live_pose_is_stale_at_its_committed_pose(tracked):
    link = links(one("robot1", at(1.0), tracked=tracked)).link("robot1")
    assert (link.pose, link.source, link.age_s, link.stale) == (at(1.0), tracked, None, True)
    assert link.problem.endswith("its current pose is unknown: no live pose has been received yet")


def test_a_robot_is_where_its_body_is_and_a_chair_where_the_map_says():
    bodies = [structs.replace(body("robot1", at(5.0)), robot=True), body("chair1", at(5.0))]
    found = links(one("robot1", at(1.0)), one("chair1", at(1.0)), bodies=bodies)
    assert found.link("robot1") == Link("map", at(5.0), "sim", 0.25)
    assert found.link("chair1") == Link("map", at(1.0), "map")


def test_a_part_is_in_the_frame_of_its_whole():
    turned = Pose(position_m=(1.0, 1.0, 0.0), orientation_wxyz=orientation_from_yaw(math.pi / 2))
    found = links(one("oven1", turned), one("door1", Pose(position_m=(1.0, 3.0, 0.5)), part_of="oven1"))
    link = found.link("door1")
    assert (link.parent, link.source) == ("oven1", "map")
    assert link.pose.position_m == pytest.approx((2.0, 0.0, 0.5))


def test_an_untracked_part_moves_with_its_whole():
    """Its committed pose relative to its whole is kept."""
    arm, robot = one("arm1", at(1.5), part_of="robot1"), one("robot1", at(1.0), tracked="sim")
    live = {"robot1": lives(at(7.0), source="sim")}
    assert links(arm, robot, live=live).link("arm1").pose.position_m == pytest.approx((0.5, 0.0, 0.0))


def test_a_tracked_part_is_where_it_is_seen_on_its_whole_as_that_is_seen():
    arm, robot = one("arm1", at(1.5), part_of="robot1", tracked="sim"), one("robot1", at(1.0), tracked="sim")
    live = {"robot1": lives(at(7.0), source="sim"), "arm1": lives(at(9.0), source="sim")}
    assert links(arm, robot, live=live).link("arm1").pose.position_m == pytest.approx((2.0, 0.0, 0.0))


@pytest.mark.parametrize(
    "whole",
    [
        one("whole1", None),
        one("whole1", at(0.0), place=True),
        one("whole1", at(0.0), part_of="part1"),
        one("another1", at(0.0)),
    ],
    ids=["nowhere", "a place", "part of its part", "unknown"],
)
def test_a_part_is_in_the_map_s_frame_where_its_whole_is_no_frame(whole):
    link = links(one("part1", at(1.0), part_of="whole1"), whole).link("part1")
    assert (link.parent, link.pose) == ("map", at(1.0))


def test_a_part_without_a_position_is_in_the_map_s_frame():
    link = links(one("part1", None, part_of="whole1"), one("whole1", at(1.0))).link("part1")
    assert (link.parent, link.pose) == ("map", None)


def test_a_part_of_a_part_is_in_the_frame_of_the_nearest():
    found = links(
        one("knob1", at(3.0), part_of="door1"), one("door1", at(2.0), part_of="oven1"), one("oven1", at(1.0))
    )
    assert [found.link(name).parent for name in ("knob1", "door1", "oven1")] == ["door1", "oven1", "map"]


def test_what_stands_above_parts_of_one_another_has_no_frame_of_its_own():
    found = links(
        one("c", at(3.0), part_of="a"), one("a", at(1.0), part_of="b"), one("b", at(2.0), part_of="a")
    )
    assert [found.link(name).parent for name in "abc"] == ["map", "map", "map"]


def test_a_camera_is_in_the_frame_of_what_carries_it():
    cameras = [
        CameraPose(camera="eye", part_of="robot1", pose=at(3.0)),
        CameraPose(camera="wall", part_of="", pose=at(4.0)),
        CameraPose(camera="lost", part_of="ghost1", pose=at(5.0)),
    ]
    found = camera_links(cameras, {"robot1": at(1.0), "": at(9.0)}.get)
    assert found["eye"].parent == "robot1"
    assert found["eye"].pose.position_m == pytest.approx((2.0, 0.0, 0.0))
    assert found["wall"] == Link("map", at(4.0), "camera")
    assert found["lost"] == Link("map", at(5.0), "camera")
