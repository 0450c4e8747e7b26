"""Live poses without Zenoh: where an entity is, and what is committed and published."""

from __future__ import annotations

from concurrent.futures import Future
from types import SimpleNamespace

import pytest

from semmap.nodes.coordinator.config import CoordinatorConfig, LiveRules
from semmap.nodes.coordinator.live import feed as module
from semmap.nodes.coordinator.live.feed import LiveFeed
from semmap.schemas import codec, errors, keys
from semmap.schemas.attachments import pose_text
from semmap.schemas.entities import Pose
from semmap.schemas.live import LivePose, LivePoses
from tests.coordinator.reconciler.test_scene_report import NOW, body, entity
from tests.fake_node import FakeNode, FakeStream

HOME = Pose(position_m=(0.0, 0.0, 0.0))


def at(x):
    return Pose(position_m=(x, 0.0, 0.0))


class Feed:
    """A feed of a robot that publishes its pose, a ball of the simulator, and a cup in the robot's hand."""

    def __init__(self, monkeypatch, truth="map", live=LiveRules()):  # noqa: B008
        self.now_s = 100.0
        monkeypatch.setattr(module.time, "monotonic", lambda: self.now_s)
        self.stream, self.published = FakeStream(), []
        monkeypatch.setattr("semmap.nodes.bus.NewestSamples", lambda *_: self.stream)
        out = SimpleNamespace(
            put=lambda payload, encoding: self.published.append(codec.decode(bytes(payload), LivePoses))
        )
        monkeypatch.setattr("semmap.nodes.bus.publisher", lambda *_: out)
        grip = {"isGraspedBy": "robot1", "graspPose": pose_text(at(0.5))}
        self.entities = {
            "robot1": entity("robot1", pose=HOME, tracked="stream"),
            "ball1": entity("ball1", pose=HOME, tracked="sim"),
            "cup1": entity("cup1", pose=HOME, properties=grip, grip_provenance=NOW),
            "box1": entity("box1", pose=HOME),
        }
        self.map = SimpleNamespace(
            seq=1,
            entities=self.entities,
            tracked={name: self.entities[name] for name in ("robot1", "ball1")},
            held={"cup1": self.entities["cup1"]},
        )
        self.scene = SimpleNamespace(known=False, bodies={}, stamp_ns=1)
        self.changes, self.futures = [], []
        self.node = FakeNode(lambda call: None)
        self.live = LiveFeed(
            self.node, CoordinatorConfig(truth=truth, live=live), self.map, self.scene, self.change
        )

    def change(self, observed):
        self.changes.append(observed)
        self.futures.append(Future())
        return self.futures[-1]

    def receive(self, x, name="robot1"):
        self.stream.samples.append((keys.live_pose_key(name), LivePose(at=(x, 0.0, 0.0))))

    def tick(self, passed_s=0.0):
        self.now_s += passed_s
        self.node.tick()

    def x_of(self, name):
        return self.live.pose_of(name).position_m[0]


@pytest.fixture
def feed(monkeypatch):
    return Feed(monkeypatch)


def test_a_tracked_entity_is_where_its_newest_pose_is_until_that_is_stale(feed):
    assert feed.x_of("robot1") == 0.0
    assert feed.live.live_pose(feed.entities["robot1"]) is None
    feed.receive(1.0)
    assert feed.x_of("robot1") == 1.0
    feed.now_s += 2.0
    assert feed.x_of("robot1") == 1.0
    feed.now_s += 0.1
    assert feed.x_of("robot1") == 0.0
    assert feed.live.live_pose(feed.entities["robot1"]).stale


def test_an_attached_entity_is_where_its_holder_is(feed):
    assert feed.x_of("cup1") == pytest.approx(0.5)
    feed.receive(2.0)
    assert feed.x_of("cup1") == pytest.approx(2.5)
    feed.now_s += 1.5
    live = feed.live.live_pose(feed.entities["cup1"])
    assert (live.age_s, live.source, live.pose.position_m[0]) == (1.5, "stream", 2.5)


def test_an_entity_attached_to_an_untracked_one_has_the_age_of_now(feed):
    feed.entities["robot1"] = entity("robot1", pose=HOME)
    live = feed.live.live_pose(feed.entities["cup1"])
    assert (live.age_s, live.source) == (0.0, "stream")
    feed.scene.known, feed.scene.bodies = True, {"cup1": body("cup1", pose=at(3.0))}
    assert feed.live.live_pose(feed.entities["cup1"]).source == "sim"
    assert feed.live.live_pose(feed.entities["box1"]) is None


@pytest.mark.parametrize(
    ("truth", "known", "x"),
    [
        ("map", True, 3.0),
        ("scene", True, 3.0),
        ("perceived", True, 0.0),
        ("replayed", True, 0.0),
        ("map", False, 0.0),
    ],
)
def test_an_entity_is_where_its_body_is_if_bodies_follow_the_map(monkeypatch, truth, known, x):
    feed = Feed(monkeypatch, truth)
    feed.scene.known = known
    feed.scene.bodies = {name: body(name, pose=at(3.0)) for name in ("box1", "robot1")}
    assert feed.x_of("box1") == x
    assert feed.x_of("robot1") == 0.0  # its own stream has its pose
    assert feed.live.pose_of("unknown") is None


def test_entities_that_hold_each_other_have_their_committed_poses(feed):
    feed.entities["robot1"] = entity(
        "robot1", pose=at(7.0), properties={"isGraspedBy": "cup1", "graspPose": pose_text(at(0.5))}
    )
    assert feed.x_of("robot1") == pytest.approx(0.5)  # from where the map has the cup


def test_the_simulator_s_body_is_the_live_pose_of_what_is_tracked_from_it(feed):
    feed.scene.known = True
    feed.scene.bodies = {"ball1": body("ball1", pose=at(3.0)), "robot1": body("robot1", pose=at(9.0))}
    feed.live.on_scene()
    feed.tick(0.5)
    assert feed.live.scene_age_s() == 0.5
    live = feed.live.live_pose(feed.entities["ball1"])
    assert (live.source, live.pose, live.age_s) == ("sim", at(3.0), 0.5)
    assert feed.live.live_pose(feed.entities["robot1"]) is None


def test_a_robot_that_stops_is_committed_once(feed):
    feed.receive(1.0)
    feed.tick()
    assert feed.live.displaced() != ()
    assert feed.live.displaced(["ball1"]) == ()
    feed.receive(1.0)
    feed.tick(1.0)
    feed.tick()
    (change,) = feed.changes
    assert (change.source, change.reason, dict(change.poses)) == (
        "perception",
        "robot1 stopped",
        {"robot1": at(1.0)},
    )
    feed.map.tracked["robot1"] = feed.entities["robot1"] = entity("robot1", pose=at(1.0), tracked="stream")
    feed.futures[0].set_result(None)
    feed.tick()
    assert len(feed.changes) == 1
    assert feed.node.reports == []


@pytest.mark.parametrize(
    ("error", "reports"),
    [
        (errors.Refused("it is attached"), ["robot1: the live pose is not committed: it is attached"]),
        (errors.NoAnswer("the map is away"), []),
    ],
)
def test_a_rejected_pose_is_reported_and_tried_again_later(feed, error, reports):
    feed.receive(1.0)
    feed.tick()
    feed.receive(1.0)
    feed.tick(1.0)
    feed.futures[0].set_exception(error)
    assert feed.node.reports == reports
    feed.receive(1.0)
    feed.tick(4.9)
    assert len(feed.changes) == 1
    feed.tick(0.1)
    assert len(feed.changes) == 2


def test_a_held_or_replayed_entity_is_not_committed(monkeypatch, feed):
    replayed = Feed(monkeypatch, "replayed")
    feed.map.held["robot1"] = feed.entities["robot1"]
    for one in (replayed, feed):
        monkeypatch.setattr(module.time, "monotonic", lambda one=one: one.now_s)
        one.receive(1.0)
        one.tick()
        one.tick(1.5)
        assert one.changes == []


def test_a_moving_ball_is_committed_as_the_scene_if_that_is_asked_for(monkeypatch):
    feed = Feed(monkeypatch, live=LiveRules(journal_every_s=3.0))
    feed.scene.known, feed.scene.bodies = True, {"ball1": body("ball1", pose=at(3.0))}
    feed.live.on_scene()
    feed.tick()
    feed.now_s += 3.0
    feed.live.on_scene()
    feed.scene.stamp_ns = 2
    feed.tick()
    (change,) = feed.changes
    assert (change.source, change.reason) == ("scene", "ball1 is moving")


def test_before_the_map_has_arrived_nothing_is_done(feed):
    feed.map.seq = -1
    feed.receive(1.0)
    feed.tick()
    assert feed.published == []


def test_poses_are_published_when_they_change_and_once_a_second(feed):
    feed.tick()
    assert [set(one.entities) for one in feed.published] == [{"cup1"}]
    feed.receive(1.0)
    feed.tick(0.1)
    assert set(feed.published[-1].entities) == {"robot1", "cup1"}
    count = len(feed.published)
    feed.tick(0.5)
    assert len(feed.published) == count
    feed.tick(0.5)
    assert len(feed.published) == count + 1
    feed.tick(2.0)  # the robot's pose is stale
    assert set(feed.published[-1].entities) == set()


def test_the_end_of_all_live_poses_is_published_once(feed):
    feed.map.held.clear()
    feed.tick()
    feed.receive(1.0)
    feed.tick()
    feed.tick(3.0)
    count = len(feed.published)
    assert feed.published[-1].entities == {}
    feed.tick(3.0)
    assert len(feed.published) == count


def test_the_pose_at_the_end_of_tracking_is_committed_if_it_is_new(feed):
    assert feed.live.commit_pose("robot1") is None
    assert feed.live.commit_pose("box1") is None
    feed.receive(0.0)
    assert feed.live.commit_pose("robot1") is None
    feed.receive(1.0)
    assert feed.live.commit_pose("robot1") is feed.futures[0]
    assert feed.changes[0].reason == "robot1 is no longer tracked"
    feed.now_s += 9.0
    assert feed.live.commit_pose("robot1") is None


def test_invalid_poses_are_problems(feed):
    feed.stream.samples.append((keys.live_pose_key("robot1"), errors.BadRequest("malformed message")))
    feed.receive(1.0, "box1")
    feed.tick()
    problems = feed.live.problems()
    assert "semmap/live/robot1: ignored: malformed message" in problems
    assert any(problem.startswith("semmap/live/box1: ignored: box1 is not tracked") for problem in problems)
    assert any(problem.startswith("ball1: tracked, but") for problem in problems)
