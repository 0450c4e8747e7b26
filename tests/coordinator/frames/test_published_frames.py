"""Published frames: which are stored, which are ignored and why, and which are stale."""

from __future__ import annotations

from semmap.nodes.coordinator.frames.published_frames import PublishedFrames
from semmap.schemas.frames import FramePose


def say(published, name, parent, now_s=0.0, *, taken=(), stamp_ns=1, **fields):
    message = FramePose(parent=parent, **fields)
    published.take(name, lambda: (message, stamp_ns), taken, now_s)


def test_the_newest_pose_is_used_and_a_late_one_is_ignored():
    published = PublishedFrames(2.0)
    say(published, "lidar", "robot1", at=(1.0, 0.0, 0.0), stamp_ns=2_000)
    say(published, "lidar", "robot1", at=(2.0, 0.0, 0.0), stamp_ns=1_000)
    assert published.link("lidar", 0.0).pose.position_m == (1.0, 0.0, 0.0)
    say(published, "lidar", "robot1", at=(3.0, 0.0, 0.0), stamp_ns=3_000)
    assert published.link("lidar", 0.0).pose.position_m == (3.0, 0.0, 0.0)


def test_a_silent_frame_is_stale_reported_for_a_minute_and_then_removed():
    published = PublishedFrames(2.0)
    say(published, "lidar", "robot1")
    say(published, "mount", "robot1", fixed=True)
    assert not published.link("lidar", 1.9).stale
    link = published.link("lidar", 12.0)
    assert link.stale
    assert "stale: no message on semmap/frame/lidar for 12 s" in link.problem
    assert list(published.problems(12.0)) == [link.problem]
    assert not list(published.problems(70.0))
    published.forget(700.0)
    assert list(published) == ["mount"]
    assert not published.link("mount", 700.0).stale


def test_a_cycle_is_ignored_and_existing_frames_are_kept():
    published = PublishedFrames(2.0)
    say(published, "a", "map")
    say(published, "b", "a")
    say(published, "c", "b")
    say(published, "a", "c")
    say(published, "a", "c")
    say(published, "d", "d")
    assert published.link("a", 0.0).parent == "map"
    assert "d" not in list(published)
    assert list(published.problems(1.0)) == [
        "semmap/frame/a: ignored (2 times): the frames form a cycle: a in c in b in a",
        "semmap/frame/d: ignored: the frames form a cycle: d in d",
    ]
    say(published, "b", "map")  # a frame may change its parent
    say(published, "a", "c")
    assert published.link("a", 0.0).parent == "c"


def test_entities_and_the_map_keep_their_names():
    published = PublishedFrames(2.0)
    say(published, "robot1", "map", taken={"robot1"})
    say(published, "map", "robot1")
    assert not list(published)
    assert any("semmap track robot1" in problem for problem in published.problems(0.0))


def test_a_frame_is_deleted():
    published = PublishedFrames(2.0)
    say(published, "lidar", "robot1", fixed=True)
    published.take("lidar", lambda: None, (), 1.0)
    assert published.link("lidar", 1.0) is None


def test_an_invalid_pose_is_reported():
    published = PublishedFrames(2.0)
    say(published, "lidar", "robot1", yaw=1.0, orientation=(1.0, 0.0, 0.0, 0.0))
    assert not list(published)
    assert any("yaw or orientation" in problem for problem in published.problems(0.0))


def test_the_age_of_a_frame_is_the_time_since_its_last_message():
    published = PublishedFrames(2.0)
    say(published, "lidar", "robot1", 100.0)
    assert published.link("lidar", 101.5).age_s == 1.5
    assert published.link("lidar", 99.0).age_s == 0.0  # read before the message was received
    assert published.link("lidar", 103.0).age_s == 3.0
