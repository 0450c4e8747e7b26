"""The newest pose of tracked entities, which poses are committed, and problems."""

from __future__ import annotations

import pytest
from msgspec import structs

from semmap.nodes.coordinator.config import LiveRules, Thresholds
from semmap.nodes.coordinator.live.live_poses import LivePoses
from semmap.schemas import errors
from semmap.schemas.entities import Entity, Pose
from tests.coordinator.reconciler.test_reconcile import at, entity

SECOND = 1_000_000_000


def tracked(name: str = "robot1", pose: Pose | None = None, source: str = "stream") -> dict[str, Entity]:
    return {name: structs.replace(entity(name, pose or at(0.0)), tracked=source)}


@pytest.fixture
def poses() -> LivePoses:
    return LivePoses(LiveRules(), Thresholds())


def drive(poses: LivePoses, entities: dict[str, Entity], seconds: float, start_s: float = 0.0) -> list[str]:
    """Send 50 poses a second at 0.5 m/s, and return the reasons of the commits due at 10 Hz."""
    due: list[str] = []
    for i in range(int(50 * seconds)):
        now_s = start_s + 0.02 * i
        poses.take("robot1", at(0.5 * now_s), int(now_s * SECOND), now_s, "stream")
        if i % 5 == 0:
            due += [d.reason for d in poses.due(entities, now_s)]
    return due


def test_the_newest_pose_is_used_and_has_an_age(poses):
    poses.take("robot1", at(1.0), 1 * SECOND, 100.0, "stream")
    poses.take("robot1", at(2.0), 2 * SECOND, 101.0, "stream")
    live = poses.live("robot1", 101.5)
    assert (live.pose, live.age_s, live.stale, live.source) == (at(2.0), 0.5, False, "stream")


@pytest.mark.parametrize(("later_s", "stale"), [(0.0, False), (2.0, False), (2.01, True)])
def test_a_pose_is_stale_when_nothing_has_come_for_longer_than_the_rules_allow(poses, later_s, stale):
    poses.take("robot1", at(1.0), 1 * SECOND, 100.0, "stream")
    assert poses.live("robot1", 100.0 + later_s).stale is stale


def test_what_is_no_longer_tracked_or_tracked_from_elsewhere_is_forgotten(poses):
    for name in ("robot1", "robot2", "robot3"):
        poses.take(name, at(1.0), SECOND, 100.0, "stream")
    poses.forget({**tracked("robot1"), **tracked("robot2", source="sim")})
    assert [poses.live(name, 100.0) is None for name in ("robot1", "robot2", "robot3")] == [False, True, True]


def test_late_poses_are_ignored_and_a_changed_clock_is_followed(poses):
    poses.take("robot1", at(1.0), 100 * SECOND, 0.0, "stream")
    poses.take("robot1", at(9.0), 99 * SECOND, 0.1, "stream")
    assert poses.live("robot1", 0.1).pose == at(1.0)
    poses.take("robot1", at(2.0), 50 * SECOND, 0.2, "stream")
    assert poses.live("robot1", 0.2).pose == at(2.0)


def test_a_moving_entity_is_committed_once_when_it_stops(poses):
    entities = tracked()
    assert drive(poses, entities, 10.0) == []
    stopped = poses.live("robot1", 10.0).pose
    for i in range(100):
        poses.take("robot1", stopped, (11 * SECOND) + i, 10.0 + 0.02 * i, "stream")
    due = list(poses.due(entities, 12.0))
    assert [(d.reason, d.pose) for d in due] == [("robot1 stopped", stopped)]
    assert not list(poses.due(tracked(pose=stopped), 12.0))


def test_it_is_committed_periodically_if_configured():
    poses = LivePoses(LiveRules(journal_every_s=2.0), Thresholds())
    entities = tracked()
    reasons: list[str] = []
    for i in range(500):
        now_s = 0.02 * i
        poses.take("robot1", at(0.5 * now_s), int(now_s * SECOND), now_s, "stream")
        for due in poses.due(entities, now_s):
            reasons.append(due.reason)
            entities = tracked(pose=due.pose)
            poses.note_commit("robot1", now_s, refused=False)
    assert reasons == ["robot1 is moving"] * 4


def test_the_last_pose_of_a_stream_is_committed_and_reported(poses):
    drive(poses, tracked(), 2.0)
    last = poses.live("robot1", 2.0).pose
    assert poses.live("robot1", 30.0).stale
    assert poses.current(30.0) == {}
    (due,) = poses.due(tracked(), 30.0)
    assert (due.pose, due.reason) == (last, "robot1: no more live poses received")
    assert list(poses.problems(tracked(), 30.0)) == ["robot1: its live pose is stale: none received for 28 s"]


def test_a_refused_commit_is_tried_again_after_a_while_only(poses):
    poses.take("robot1", at(3.0), SECOND, 0.0, "stream")
    assert len(list(poses.due(tracked(), 1.5))) == 1
    poses.note_commit("robot1", 1.5, refused=True)
    assert not list(poses.due(tracked(), 1.6))
    assert len(list(poses.due(tracked(), 7.0))) == 1


def test_a_jump_is_accepted_and_reported(poses):
    poses.take("robot1", at(0.0), SECOND, 0.0, "stream")
    poses.take("robot1", at(4.0), 2 * SECOND, 0.1, "stream")
    assert poses.live("robot1", 0.1).pose == at(4.0)
    (said,) = poses.problems(tracked(pose=at(4.0)), 1.1)
    assert said == "robot1: its live pose jumped 4.00 m within 0.1 s, 1 s ago"


def test_a_streamed_robot_is_named_while_it_is_away_from_its_committed_pose(poses):
    drive(poses, tracked(), 2.0)
    assert list(poses.displaced(tracked(), 2.0)) == ["robot1 is moving: 0.99 m from its committed pose"]
    assert list(poses.displaced(tracked(), 3.5)) == ["robot1 stands still: 0.99 m from its committed pose"]
    assert list(poses.displaced(tracked(pose=at(0.99)), 3.5)) == []
    assert list(poses.displaced(tracked(source="sim"), 2.0)) == []
    assert list(poses.displaced(tracked(), 30.0)) == []  # its stream has ended


def test_driving_is_not_a_jump(poses):
    drive(poses, tracked(), 3.0)
    assert list(poses.problems(tracked(), 3.0)) == []


def malformed():
    raise errors.BadRequest("at must be 3 numbers")


@pytest.mark.parametrize(
    ("name", "read", "said"),
    [
        ("robto1", lambda: (at(1.0), 1), "no entity is named 'robto1'; did you mean robot"),
        ("chair1", lambda: (at(1.0), 1), "chair1 is not tracked; to have it follow"),
        ("robot2", lambda: (at(1.0), 1), "robot2 is tracked from the simulator; to"),
        ("robot1", malformed, "at must be 3 numbers"),
    ],
)  # fmt: skip
def test_rejected_poses_are_reported(poses, name, read, said):
    entities = {**tracked(), **tracked("robot2", source="sim"), "chair1": entity("chair1", at(0.0))}
    for now_s in (0.0, 0.1):
        poses.read(name, read, entities, now_s)
    told = [text for text in poses.problems({}, 1.0) if said in text]
    assert len(told) == 1
    assert told[0].startswith(f"semmap/live/{name}: ignored (2 times): ")
    assert list(poses.problems({}, 100.0)) == []
    assert name == "robot1" or poses.live(name, 0.1) is None


def test_the_number_of_stored_wrong_names_is_limited(poses):
    for i in range(1000):
        poses.read(f"ghost{i}", lambda: (at(0.0), 1), {}, 0.0)
    assert len(list(poses.problems({}, 1.0))) == 50


def test_a_tracked_entity_without_poses_is_reported(poses):
    assert "no live pose has been received yet; publish poses on semmap/live/robot1" in next(
        poses.problems(tracked(), 0.0)
    )
    assert "it has no body in the simulator" in next(poses.problems(tracked(source="sim"), 0.0))


def test_an_entity_that_is_no_longer_tracked_is_forgotten(poses):
    poses.take("robot1", at(1.0), 1, 0.0, "stream")
    poses.forget(tracked(source="sim"))
    assert poses.live("robot1", 0.0) is None
