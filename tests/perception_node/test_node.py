"""The perception node: camera frames in, valid and invalid, observations and commands out."""

from __future__ import annotations

import numpy as np
import pytest
import zenoh
from msgspec import structs

from semmap.nodes import bus
from semmap.nodes.perception_node.config import PerceptionConfig
from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.live_robot import LiveRobot
from semmap.nodes.perception_node.node import Perception, summary
from semmap.nodes.perception_node.pipeline import FrameResult
from semmap.nodes.runtime.loop import Node
from semmap.schemas import codec, errors, keys
from semmap.schemas.bridge import SnapshotQuery
from semmap.schemas.commands import Add, Classes, LastSeen
from semmap.schemas.commits import Commit, Snapshot
from semmap.schemas.entities import ClassInfo, Provenance
from semmap.schemas.live import RobotState
from semmap.schemas.perception import DetectedMasks, MaskRun, Observations
from semmap.schemas.replies import Changed, Sighting
from tests.conftest import PATIENCE_S, free_endpoint, handling, until
from tests.perception_node.input.test_frames import DEPTH
from tests.perception_node.things import at, entity, seen

SAID = Provenance(commit=1, stamp_ns=1, source="perception")
CUP = seen("Cup", at(3.0, 4.0, 5.9))
CLASSES = tuple(
    ClassInfo(
        name=name,
        iri=f"http://example.org/{name}",
        parents=above[:1],
        ancestors=above,
        labels={"en": name.lower()},
        spatial=True,
        place=False,
        fixed=False,
        model="",
    )
    for name, above in {"Cup": ("Tableware", "Object"), "Tableware": ("Object",), "Object": ()}.items()
)


def everything_is_a_cup(clouds, masks):
    """Report the same cup for any frame, and fail for near depth."""
    if (clouds[0].points_camera[..., 2] < 0.5).any():
        raise ZeroDivisionError("too near")
    shape = clouds[0].points_camera.shape[:2]
    observations = Observations(stamp_ns=clouds[0].stamp_ns, views=(), observations=(CUP,))
    said = {one.label for found in masks if found is not None for one in found.detector_labels if one}
    return FrameResult(observations, tuple(np.ones(shape, np.int32) for _ in clouds), tuple(sorted(said)))


class World:
    """A coordinator, a knowledge base and cameras that record the output of perception."""

    def __init__(self, session, other):
        self.session = session
        self.other = other
        """The session of perception."""
        self.node = Node("kb_node", session)
        self.told = []
        self.seen = []
        self.clouds = []
        self.health = None
        self.refusal = None
        self.names_of_old = set()
        self.snapshot = lambda: Snapshot(seq=1, entities=())
        self._seq = 1
        self._stamp_ns = 0
        self._commits = bus.publisher(session, keys.COMMIT)
        bus.follow(session, keys.OBSERVATIONS, lambda _, message: self.seen.append(message))
        bus.follow(session, keys.CLOUD, lambda _, message: self.clouds.append(message))
        bus.follow(session, keys.HEALTH, self._hear)
        self.node.serve(
            keys.BRIDGE,
            {
                "snapshot": (SnapshotQuery, lambda _: self.snapshot()),
                "classes": (Classes, lambda _: CLASSES),
                "last-seen": (LastSeen, self._last_seen),
            },
        )
        self.node.serve(keys.CMD, {"add": (Add, self._add)})

    def film(self, depth_m=2.0, *, rgb=None, pixels=None, **changes):
        """Publish one frame of a camera."""
        self._stamp_ns += 1_000_000
        depth = structs.replace(DEPTH, **{"stamp_ns": self._stamp_ns, **changes})
        colour = structs.replace(depth, encoding="rgb8", **(rgb or {}))
        shape = (depth.height, depth.width)
        planes = {
            "rgb": (colour, bytes(3 * colour.width * colour.height)),
            "depth": (depth, np.full(shape, depth_m, "<f4").tobytes() if pixels is None else pixels),
        }
        for plane, (frame, content) in planes.items():
            self.session.put(
                keys.camera_key(depth.camera, plane),
                content,
                attachment=codec.encode(frame),
                congestion_control=zenoh.CongestionControl.BLOCK,  # 5 MB would be dropped on a busy machine
            )

    def film_until(self, condition, what, **frame):
        def filmed():
            self.film(**frame)
            return condition()

        return until(filmed, what)

    def film_often(self):
        """Publish frames until ten more were processed."""
        before = len(self.seen)
        self.film_until(lambda: len(self.seen) >= before + 10, "ten more looks")

    def _add(self, command):
        self.told.append(command)
        if self.refusal is not None:
            raise self.refusal
        self._seq += 1
        made = entity(command.name, command.class_, at(*command.at), command.size, source="perception")
        self.announce(self._seq, made)
        return Changed(commit=self._seq, text="added", names=(command.name,))

    def announce(self, seq, *changed):
        """Publish a commit."""
        commit = Commit(seq=seq, stamp_ns=1, id=str(seq), source="perception", changed=changed)
        self._commits.put(codec.encode(commit))

    def _last_seen(self, query):
        if query.name not in self.names_of_old:
            raise errors.UnknownName(f"there is no '{query.name}'")
        return Sighting(name=query.name, pose=None, provenance=SAID, removed=SAID)

    def _hear(self, _, health):
        if health.node == "perception_node":
            self.health = health


@pytest.fixture(scope="module")
def endpoint():
    return free_endpoint()


@pytest.fixture
def robot(request, tmp_path):
    """Return a robot that fills the view of the cameras, for the tests that have one."""
    if not hasattr(request, "param"):
        return None
    model = tmp_path / "ball.xml"
    model.write_text('<mujoco><worldbody><geom size="0.5" pos="0 0 0.55"/></worldbody></mujoco>')
    return LiveRobot("robot1", model)


@pytest.fixture
def world(endpoint, monkeypatch, robot):
    monkeypatch.setattr(
        "semmap.nodes.perception_node.input.frame_worker._TAKE_S", 0.02
    )  # its end waits for that
    here = bus.Network(connect=(), listen=(endpoint,), mode="peer")
    there = bus.Network(connect=(endpoint,), listen=("tcp/127.0.0.1:0",), mode="peer")
    with bus.open_session(here) as session, bus.open_session(there) as other:
        world = World(session, other)
        node = Node("perception_node", other)
        perception = Perception(node, PerceptionConfig(), everything_is_a_cup, {}, robot=robot)
        with handling(world.node), handling(node):
            until(lambda: world.health is not None and world.health.state == "ready", "it is ready")
            try:
                yield world
            finally:
                perception.close()


def test_what_is_seen_becomes_an_entity_once_and_is_published_with_its_name(world):
    world.film_until(lambda: world.seen and world.seen[-1].observations[0].entity, "the map has it")
    world.film_often()
    (add,) = world.told
    assert (add.class_, add.name, add.source, add.agent) == ("Cup", "cup1", "perception", "perception_node")
    assert world.seen[-1].observations == (structs.replace(CUP, entity="cup1"),)
    assert world.seen[-1].stamp_ns > world.seen[0].stamp_ns
    world.film_until(lambda: world.clouds, "a cloud is published")
    assert set(np.frombuffer(world.clouds[0].labels, "<u2")) == {1}
    assert len(world.clouds[0].positions) == 12 * len(np.frombuffer(world.clouds[0].labels, "<u2"))
    until(lambda: world.health.detail.startswith("1 camera, 1 thing seen"), "it says what it sees")


def test_a_name_that_something_had_before_this_process_began_is_not_given_again(world):
    world.names_of_old = {"cup1", "cup2"}
    world.film_until(lambda: world.seen and world.seen[-1].observations[0].entity, "the map has it")
    (add,) = world.told
    assert (add.name, add.reason, world.seen[-1].observations[0].entity) == ("cup3", "cup3 was seen", "cup3")


def test_a_commit_that_comes_before_a_snapshot_without_it_is_not_lost(world):
    cup = entity("my_cup", "Cup", CUP.pose, CUP.size_m)
    snapshots = iter((Snapshot(seq=3, entities=()), Snapshot(seq=4, entities=(cup,))))
    come = []
    bus.follow(world.other, keys.EFFECTS, lambda _, commit: come.append(commit.seq))

    def snapshot():
        found = next(snapshots)
        if found.seq == 3:
            world.announce(4, cup)
            until(lambda: 4 in come, "the commit is there first")
        return found

    world.snapshot = snapshot
    world.announce(3)  # the second was missed
    world.film_until(lambda: world.seen and world.seen[-1].observations[0].entity == "my_cup", "it is found")


def test_what_the_map_refuses_is_told_and_not_said_again_at_once(world, monkeypatch):
    monkeypatch.setattr("semmap.nodes.perception_node.node._REFUSED_S", 10 * PATIENCE_S)
    world.refusal = errors.Inconsistent("a cup cannot be here")
    world.film_until(lambda: "a cup cannot be here" in world.health.last_error, "it says why")
    world.film_often()
    assert len(world.told) == 1


NAN = float("nan")
NOTHING = "camera left has no depth values from 0.01 to 100 m"
BAD = {
    "the past": ({"stamp_ns": -5_000_000_000}, "frame ignored: its stamp is not newer"),
    "sizes": ({"rgb": {"width": 32}}, "its colour image has 32 x 48 pixels, its depth 64 x 48"),
    "intrinsics": ({"intrinsics": (0.0,) * 9}, "the intrinsics fx 0 fy 0"),
    "pose": ({"map_from_camera": (2.0,) * 16}, "map_from_camera is not a 4 x 4 pose"),
    "bytes": ({"pixels": b"123"}, "3 bytes are not a depth32f image"),
    "a fault": ({"depth_m": 0.1}, "processing a frame failed: ZeroDivisionError: too near"),
    "nothing measured": ({"depth_m": NAN}, NOTHING),
    "millimetres": ({"depth_m": 1500.0}, NOTHING),
    "too large": (
        {"width": 1280, "height": 960, "intrinsics": (960.0, 0, 640.0, 0, 960.0, 480.0, 0, 0, 1)},
        "1280 x 960 pixels reduced by a factor of 2",
    ),
}


@pytest.mark.parametrize(("frame", "said"), BAD.values(), ids=BAD.keys())
def test_a_bad_frame_is_told_once_and_the_node_goes_on(world, caplog, frame, said):
    world.film_until(lambda: world.seen, "it sees")
    world.film_until(lambda: said in world.health.last_error, f"it says: {said}", **frame)
    assert sum(said in record.message for record in caplog.records if record.levelname == "ERROR") == 1
    looks = len(world.seen)
    world.film_until(lambda: len(world.seen) > looks, "it goes on")


def test_what_is_no_frame_is_told(world):
    world.session.put(keys.camera_key("left", "depth"), b"x", attachment=b"y")
    until(lambda: "semmap/sim/camera/left/depth: malformed" in world.health.last_error, "it says so")


@pytest.mark.parametrize(
    ("depth_m", "said"),
    [
        (1.5, "1 camera, 2 things seen, 80 ms per frame"),
        (8.0, "; the nearest surface is 8.0 m away, use at most 2 m"),
    ],
)
def test_cameras_that_are_far_from_everything_are_told(depth_m, said):
    points = np.full((4, 5, 3), depth_m, dtype=np.float32)
    points[0] = np.nan
    assert summary([Cloud(points)], 2, 0.08).endswith(said)


def detected(world, *observations):
    """Publish an observation of an external detector."""
    found = Observations(stamp_ns=1, views=(), observations=observations)
    world.session.put(keys.DETECTIONS.key, codec.encode(found))


def test_a_detector_of_ones_own_feeds_the_map(world):
    def said():
        detected(world, CUP)
        return world.seen and world.seen[-1].observations[0].entity

    until(said, "the map has it")
    (add,) = world.told
    assert (add.class_, add.name, add.source) == ("Cup", "cup1", "perception")


def test_a_class_that_the_map_does_not_have_is_told_and_the_others_count(world):
    strange = structs.replace(CUP, class_="Gizmo", candidates={"Gizmo": 1.0})

    def said():
        detected(world, strange, CUP)
        return world.seen and world.seen[-1].observations[0].entity

    until(said, "the map has the other")
    assert {add.class_ for add in world.told} == {"Cup"}
    until(lambda: "that the map does not have were ignored: Gizmo" in world.health.last_error, "it says so")


def test_a_frame_is_looked_at_with_the_masks_of_its_moment(world, monkeypatch, caplog):
    monkeypatch.setattr("semmap.nodes.perception_node.input.frames._SILENT_S", 10 * PATIENCE_S)
    run = MaskRun(size=(48, 64), counts=(0, 48 * 64), label="spork")

    def told():
        world.film()
        stamp_ns = world._stamp_ns
        masks = DetectedMasks(camera="left", stamp_ns=stamp_ns, width=64, height=48, masks=(run,))
        world.session.put(keys.MASKS.key, codec.encode(masks))
        return (
            "mask labels without a class: spork" in caplog.text
        )  # also for masks that arrive before their frame

    until(told, "the look had the masks")
    world.film()
    waiting_ns = world._stamp_ns
    others = []

    def another_camera_had_its_turn_twice():
        others.append(world._stamp_ns)
        return len({seen.stamp_ns for seen in world.seen} & set(others)) >= 2

    world.film_until(another_camera_had_its_turn_twice, "two looks at it", camera="right")
    assert waiting_ns not in {seen.stamp_ns for seen in world.seen}  # it waits for its masks


def test_masks_that_do_not_fit_are_told_and_the_frame_is_looked_at_all_the_same(world, caplog):
    def told():
        world.film()
        masks = DetectedMasks(camera="left", stamp_ns=world._stamp_ns, width=32, height=48)
        world.session.put(keys.MASKS.key, codec.encode(masks))
        return world.seen and "of 32 x 48 pixels, the image of 64 x 48" in caplog.text

    until(told, "it says so")


@pytest.mark.parametrize("robot", [True], indirect=True)
def test_a_robot_is_left_out_as_soon_as_its_state_is_there(world, robot, caplog):
    near = {"depth_m": 0.1}
    note = "robot1 is not left out of frames: nothing received on semmap/robot/robot1"
    world.film_until(
        lambda: "too near" in caplog.text and note in caplog.text,
        "the robot is looked at, with a note",
        **near,
    )
    assert caplog.text.count(note) == 1
    assert not world.seen

    def left_out():
        state = RobotState(at=(3.0, 4.0, 5.0), stamp_ns=world._stamp_ns + 1_000_000)
        world.session.put(robot.key, codec.encode(state))
        world.film(**near)
        return world.seen

    until(left_out, "it is left out")
