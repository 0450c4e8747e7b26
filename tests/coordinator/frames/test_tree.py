"""The tree of frames: poses up and down it, cycles, missing parents and stale ones."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.coordinator.frames.tree import ORIGIN, Link, Tree, pose_in_frame
from semmap.schemas import errors
from semmap.schemas.entities import (
    Pose,
    angle_rad,
    compose,
    distance_m,
    inverse,
    orientation_from_yaw,
    relative,
)

_METRES = st.floats(-100.0, 100.0)
_PARTS = st.tuples(*[st.floats(-1.0, 1.0)] * 4).filter(lambda q: math.hypot(*q) > 0.1)


@st.composite
def poses(draw) -> Pose:
    quaternion = draw(_PARTS)
    length = math.hypot(*quaternion)
    return Pose(
        position_m=draw(st.tuples(_METRES, _METRES, _METRES)),
        orientation_wxyz=tuple(value / length for value in quaternion),
    )


def assert_same(a: Pose, b: Pose) -> None:
    assert distance_m(a, b) < 1e-6
    assert angle_rad(a, b) < 1e-5


@given(poses())
def test_a_frame_and_its_inverse_are_nothing(pose):
    assert_same(compose(pose, inverse(pose)), ORIGIN)
    assert_same(compose(inverse(pose), pose), ORIGIN)
    assert_same(inverse(inverse(pose)), pose)


@given(poses(), poses(), poses())
def test_composing_is_associative(a, b, c):
    assert_same(compose(compose(a, b), c), compose(a, compose(b, c)))


@given(poses(), poses())
def test_what_is_seen_from_a_frame_is_where_it_was(frame, pose):
    assert_same(compose(frame, relative(pose, frame)), pose)
    assert_same(relative(compose(frame, pose), frame), pose)


@given(st.lists(poses(), min_size=1, max_size=6))
def test_a_chain_is_its_links_composed(links):
    names = [f"frame{i}" for i in range(len(links))]
    parents = ["map", *names]
    tree = tree_of({n: Link(p, pose, "stream") for n, p, pose in zip(names, parents, links, strict=False)})
    wanted = ORIGIN
    for pose in links:
        wanted = compose(wanted, pose)
    assert_same(tree.map_pose(names[-1]), wanted)


def tree_of(links: dict[str, Link]) -> Tree:
    return Tree(links.get, lambda: links)


def at(x: float, y: float = 0.0, yaw: float = 0.0) -> Pose:
    return Pose(position_m=(x, y, 0.0), orientation_wxyz=orientation_from_yaw(yaw))


ROBOT = {
    "robot1": Link("map", at(2.0, 1.0, math.pi / 2), "sim", 0.1),
    "robot1_gripper": Link("robot1", at(0.5), "sim", 0.1),
    "robot1/lidar": Link("robot1", at(0.2), "stream", 0.1),
}


def test_in_front_of_a_robot_that_looks_along_y_is_along_y():
    tree = tree_of(ROBOT)
    assert tree.map_pose("robot1_gripper").position_m == pytest.approx((2.0, 1.5, 0.0))
    assert tree.map_pose("map") == ORIGIN
    assert pose_in_frame(tree.map_pose("robot1"), at(2.0, 3.0)).position_m == (2.0, 0.0, 0.0)


def test_a_part_may_be_written_with_a_slash():
    tree = tree_of(ROBOT)
    assert tree.resolve("robot1/gripper") == "robot1_gripper"
    assert tree.resolve("robot1/lidar") == "robot1/lidar"


def test_an_unknown_frame_is_reported_with_similar_ones():
    with pytest.raises(errors.UnknownName, match=r"unknown frame 'robot1/lidr'.*robot1/lidar"):
        tree_of(ROBOT).resolve("robot1/lidr")
    assert tree_of(ROBOT).is_missing("robot1/lidr")


def test_a_parent_that_is_missing_is_named():
    tree = tree_of({"lidar": Link("robt1", at(1.0), "stream"), **ROBOT})
    assert tree.is_missing("lidar")
    with pytest.raises(errors.Refused, match=r"lidar is in the unknown frame 'robt1'.*robot1"):
        tree.map_pose("lidar")


def test_a_cycle_is_reported_and_not_followed():
    tree = tree_of({"a": Link("b", at(1.0), "stream"), "b": Link("a", at(1.0), "stream")})
    with pytest.raises(errors.Refused, match="form a cycle: a in b in a"):
        tree.map_pose("a")
    assert not tree.is_missing("a")
    told = {frame.name: frame for frame in tree.frames()}
    assert set(told) == {"map", "a", "b"}
    assert told["a"].map_pose is None
    assert "cycle" in told["b"].problem


def test_a_stale_frame_cannot_be_used_nor_can_those_in_it():
    stale = Link("map", at(1.0), "stream", 9.0, stale=True, problem="the frame base is stale")
    tree = tree_of({"base": stale, "arm": Link("base", at(1.0), "stream", 0.1)})
    for name in ("base", "arm"):
        with pytest.raises(errors.Refused, match="the frame base is stale"):
            tree.map_pose(name)
    told = {frame.name: frame for frame in tree.frames()}
    assert told["base"].stale
    assert told["base"].pose == at(1.0)
    assert told["arm"].problem == "the frame base is stale"


def test_parents_come_before_children_and_a_family_is_what_is_above_and_below():
    tree = tree_of(
        {**ROBOT, "cup1": Link("map", at(0.0), "map"), "beam": Link("robot1/lidar", at(1), "stream")}
    )
    names = [frame.name for frame in tree.frames()]
    assert names == ["map", "cup1", "robot1", "robot1/lidar", "beam", "robot1_gripper"]
    assert [f.name for f in tree.frames("robot1/lidar")] == ["map", "robot1", "robot1/lidar", "beam"]
    assert [f.name for f in tree.frames("map")] == ["map"] or len(list(tree.frames("map"))) == len(names)


def test_a_frame_is_missing_if_it_or_one_above_it_does_not_exist():
    links = {
        "robot1": Link("map", ORIGIN, "stream"),
        "hand1": Link("robot1", ORIGIN, "stream"),
        "lost1": Link("gone1", ORIGIN, "stream"),
        "below1": Link("lost1", ORIGIN, "stream"),
        "a": Link("b", ORIGIN, "stream"),
        "b": Link("a", ORIGIN, "stream"),
    }
    tree = tree_of(links)
    found = {name: tree.is_missing(name) for name in (*links, "map", "unknown1")}
    assert {name for name, is_missing in found.items() if is_missing} == {"lost1", "below1", "unknown1"}
