import pytest
from msgspec import structs

from semmap.nodes.drawing.scene_state import SceneState
from semmap.schemas.joints import Joint
from tests.recorder.messages import body, pose, poses, scene


def taken():
    state = SceneState()
    state.take(scene(body("a"), body("b", at=pose(1.0))))
    return state


def test_poses_of_another_version_or_run_ask_for_a_snapshot():
    assert not SceneState().matches(poses({}))
    assert taken().matches(poses({"a": pose()}))
    assert not taken().matches(poses({"a": pose()}, version=2))


def test_only_what_moved_is_told():
    state = taken()
    assert dict(state.follow(poses({"a": pose(), "b": pose(1.0)}))) == {"a": pose(), "b": pose(1.0)}
    assert dict(state.follow(poses({"a": pose(), "b": pose(1.5)}))) == {"b": pose(1.5)}
    assert state.bodies["b"].pose == pose(1.5)
    assert dict(state.follow(poses({"a": pose(), "b": pose(1.5)}))) == {}


def test_a_slow_creep_is_told_in_the_end():
    state = taken()
    list(state.follow(poses({"a": pose(), "b": pose(1.0)})))
    creep = [dict(state.follow(poses({"a": pose(i * 1e-4), "b": pose(1.0)}))) for i in range(1, 4)]
    assert creep == [{}, {}, {"a": pose(3 * 1e-4)}]


def test_an_unknown_body_is_left_alone():
    assert dict(taken().follow(poses({"z": pose()}))) == {}


def test_a_scene_may_become_empty():
    state = taken()
    list(state.follow(poses({"a": pose(), "b": pose(1.0)})))
    state.take(scene())
    assert dict(state.follow(poses({}))) == {}


def test_a_joint_that_moves_is_told_though_its_body_stands():
    state = SceneState()
    door = Joint(name="door", kind="hinge")
    state.take(scene(body("a"), body("b", joints=(door,))))
    still = poses({"a": pose(), "b": pose()})
    list(state.follow(structs.replace(still, joints=(0.0,), joint_commits=(1,))))
    moved = dict(state.follow(structs.replace(still, joints=(0.5,), joint_commits=(1,))))
    assert moved == {"b": pose()}
    assert state.bodies["b"].joints[0].position == 0.5


NAN, INF = float("nan"), float("inf")


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({}, ""),
        ({"poses": ()}, "0 numbers for the poses of 2 bodies"),
        ({"poses": (0.0,) * 13}, "13 numbers for the poses of 2 bodies"),
        ({"poses": (0.0,) * 21}, "21 numbers"),
        ({"poses": (NAN, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0) * 2}, "not finite"),
        ({"poses": (0.0, 0.0, INF, 1.0, 0.0, 0.0, 0.0) * 2}, "not finite"),
        ({"poses": (0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0) * 2}, "unit length"),
        ({"poses": (0.0,) * 14}, "unit length"),
        ({"joints": (1.0, 2.0)}, "2 positions for 0 joints"),
        ({"sim_time_s": NAN}, "not finite"),
        ({"stamp_ns": -1}, "not a time"),
        ({"stamp_ns": 1 << 63}, "not a time"),
        ({"names": ("a",)}, "14 numbers for the poses of 1 bodies"),
    ],
)
def test_the_problem_of_forged_poses_is_found(changes, problem):
    forged = structs.replace(poses({"a": pose(), "b": pose(1.0)}), **changes)
    found = taken().find_problem(forged)
    assert problem in found
    assert bool(found) == bool(problem)
