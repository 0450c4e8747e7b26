import os
import signal
import socket
import subprocess
import sys
from contextlib import contextmanager, suppress

import pytest
from msgspec import structs

from semmap.nodes import bus
from semmap.nodes.recorder import node as recorder_node
from semmap.nodes.recorder.node import Recorder
from semmap.nodes.recorder.recorded_commits import read_commits
from semmap.nodes.recorder.recording import open_recording
from semmap.nodes.runtime import heartbeat
from semmap.nodes.runtime.loop import Node
from semmap.schemas import codec, errors, keys
from semmap.schemas.bridge import Recall, SnapshotQuery, StarQuery
from semmap.schemas.commands import Classes
from semmap.schemas.commits import PlaceChanges, Snapshot
from semmap.schemas.health import Health
from semmap.schemas.scenes import SceneQuery, SurfaceQuery, Surfaces
from tests.conftest import PATIENCE_S, free_endpoint, handling, until
from tests.recorder.files import column, log, positions
from tests.recorder.messages import (
    START_NS,
    body,
    commit,
    entity,
    pose,
    poses,
    relation,
    scene,
    star,
    surface,
)


def wait_for(condition):
    def holds():
        with suppress(RuntimeError):  # the file ends in the middle of a message
            return condition()

    until(holds, "it is recorded")


@pytest.fixture(autouse=True)
def often(monkeypatch):
    """Shorten the interval of status messages."""
    monkeypatch.setattr(heartbeat, "_PERIOD_S", 0.05)


class World:
    """A knowledge base and a simulator that receive the status of the recorder."""

    def __init__(self, session, endpoint):
        self.endpoint = endpoint
        self.snapshot = Snapshot(seq=1, entities=(entity("chair1"), entity("cup1", "Cup")))
        self.past = {1: commit(1, *self.snapshot.entities)}
        self.scene = scene(body("chair1"))
        self.node = Node("played", session)  # its own heart would beat between the beats that are played
        self.commits = bus.publisher(session, keys.COMMIT)
        self._poses = bus.publisher(session, keys.POSES)
        self._health = bus.publisher(session, keys.HEALTH, keys.health_key("kb_node"))
        self._said = ""
        bus.follow(session, keys.HEALTH, self._hear)
        self.node.serve(
            keys.BRIDGE,
            {
                "snapshot": (SnapshotQuery, lambda _: self.snapshot),
                "recall": (Recall, lambda query: tuple(self.past[n] for n in query.seqs if n in self.past)),
                "star": (StarQuery, lambda query: tuple(map(star, query.names))),
                "classes": (Classes, lambda _: ()),
            },
        )
        self.asked = []
        self.refuses = False
        self.node.serve(
            keys.SIM, {"snapshot": (SceneQuery, self._scene), "surfaces": (SurfaceQuery, self._surfaces)}
        )

    def publish(self, *commits):
        for made in commits:
            self.commits.put(codec.encode(made))

    def simulate(self, at_by_name, **others):
        self._poses.put(codec.encode(poses(at_by_name, **others)))

    def begin_anew(self, snapshot):
        """Replace the process that has sent heartbeats."""
        self.snapshot = snapshot
        for started_ns in (1, 2):
            health = Health(node="kb_node", pid=1, started_ns=started_ns, stamp_ns=2, state="ready")
            self._health.put(codec.encode(health))

    def await_commit(self, seq):
        wait_for(lambda: self._said.startswith(f"commit {seq},"))

    def _hear(self, _, health):
        if health.node == "recorder":
            self._said = health.detail

    def _scene(self, _):
        if self.scene is None:
            raise errors.Refused("no simulator is running")
        return self.scene

    def _surfaces(self, query):
        self.asked.append(query.names)
        if self.refuses:
            self.refuses = False
            raise errors.Refused("the simulator is busy")
        modelled = {body.name for body in self.scene.bodies if body.model}
        return Surfaces(surfaces={name: surface() for name in query.names if name in modelled})


@pytest.fixture
def world():
    endpoint = free_endpoint()
    with bus.open_session(bus.Network(connect=(), listen=(endpoint,), mode="peer")) as session:
        world = World(session, endpoint)
        with handling(world.node):
            yield world


def seqs(path):
    """Return the commits recorded so far; none while the file ends within a message."""
    try:
        return [commit.seq for commit in read_commits(path)]
    except errors.BadFile:
        return []


def network(world):
    return bus.Network(connect=(world.endpoint,), listen=("tcp/127.0.0.1:0",), mode="peer")


@contextmanager
def recorder(world, path, begun_ns=0):
    """A recorder in this process, ready."""
    with bus.open_session(network(world)) as session, open_recording(path, None) as recording:
        node = Node("recorder", session)
        Recorder(node, recording, "no live view", begun_ns=begun_ns)
        with handling(node):
            world.await_commit(world.snapshot.seq)
            yield


def test_the_recording_holds_the_start_and_every_commit(world, tmp_path):
    path = tmp_path / "a.rrd"
    made = [
        commit(
            seq, entity(f"cup{seq}", "Cup", at=pose(seq)), inserted=(relation(f"cup{seq}", "isOn", "chair1"),)
        )
        for seq in range(2, 60)
    ]
    with recorder(world, path):
        world.publish(*made, commit(60, removed=("cup7",)))
        world.await_commit(60)
    read = read_commits(path)
    assert [c.seq for c in read] == list(range(1, 61))
    assert [c.inserted for c in read[1:-1]] == [c.inserted for c in made]
    assert log(path)[0] == "1  the recording continues from here with 2 entities"
    assert positions(path, "chair1") == [[0.0, 0.0, 0.0]]
    assert positions(path, "cup7") == [[7.0, 0.0, 0.0]]
    assert column(path, "/map/bodies/cup7", "Clear:is_recursive") == [True]


@pytest.mark.parametrize(("begun_seq", "first"), [(0, 1), (3, 3), (9, 5)])
def test_the_recording_begins_with_the_first_commit_of_the_system(world, tmp_path, begun_seq, first):
    path, past = tmp_path / "a.rrd", [commit(seq, entity("chair1")) for seq in range(1, 6)]
    world.past = {one.seq: one for one in past}
    world.snapshot = structs.replace(world.snapshot, seq=5)
    with recorder(world, path, begun_ns=commit(begun_seq).stamp_ns):
        until(lambda: seqs(path) == list(range(first, 6)), "the commits since the start are recorded")


def test_the_graph_has_what_is_computed_of_places(world, tmp_path):
    path = tmp_path / "a.rrd"
    on = relation("cup1", "isOn", "chair1")

    with recorder(world, path):
        world.publish(commit(2, places=PlaceChanges(came=(on,))))
        world.await_commit(2)
    every = column(path, "/graph", "GraphNodes:node_ids", whole=True)
    assert ["cup1 isOn chair1" in nodes for nodes in every] == [False, True]


def test_the_graph_shows_the_neighbourhood_of_what_a_commit_touched(world, tmp_path):
    path = tmp_path / "a.rrd"
    world.snapshot = Snapshot(
        seq=1,
        entities=(entity("room1", "Kitchen", place=True), *(entity(f"cup{i}", "Cup") for i in range(30))),
    )
    room = relation("cup7", "isLocatedIn", "room1")
    with recorder(world, path):
        world.publish(commit(2, entity("cup7", "Cup", at=pose(7.0)), places=PlaceChanges(came=(room,))))
        world.await_commit(2)
    every = column(path, "/graph", "GraphNodes:node_ids", whole=True)
    assert list(map(set, every)) == [
        {"room1", "more:elsewhere"},
        {"cup7", "class:Cup", "room1", "cup7 is a class:Cup", "cup7 isLocatedIn room1"},
    ]


def test_poses_are_recorded_when_they_change(world, tmp_path):
    path = tmp_path / "a.rrd"
    with recorder(world, path):
        world.simulate({"chair1": pose()})
        wait_for(lambda: column(path, "/map/bodies/chair1", "Boxes3D:half_sizes")[-1:] == [[0.25, 0.25, 0.5]])
        for x in (0.0, 0.5, 0.5, 1.0):
            world.simulate({"chair1": pose(x)}, sim_time_s=3.0 + x)
            wait_for(lambda x=x: positions(path, "chair1")[-1] == [x, 0.0, 0.0])
    assert [x for x, _, _ in positions(path, "chair1")] == [0.0, 0.0, 0.5, 1.0]


def test_bodies_are_drawn_as_they_look_each_kind_asked_for_once(world, tmp_path):
    path = tmp_path / "a.rrd"
    world.scene = scene(body("chair1", model="chair"), body("chair2", model="chair"))
    with recorder(world, path):
        world.simulate({"chair1": pose(), "chair2": pose()})
        wait_for(lambda: column(path, "/map/bodies/chair1", "Mesh3D:vertex_positions"))
        world.scene = scene(body("chair1", model="chair"), version=2)
        world.simulate({"chair1": pose()}, version=2)
        wait_for(lambda: column(path, "/map/bodies/chair2", "Clear:is_recursive"))
    assert world.asked == [("chair1",)]


def test_surfaces_that_did_not_arrive_are_requested_again(world, tmp_path, monkeypatch):
    monkeypatch.setattr(recorder_node, "_RETRY_S", 0.05)
    path = tmp_path / "a.rrd"
    world.scene, world.refuses = scene(body("chair1", model="chair")), True
    with recorder(world, path):
        world.simulate({"chair1": pose()})
        wait_for(lambda: column(path, "/map/bodies/chair1", "Mesh3D:vertex_positions"))
    assert world.asked == [("chair1",), ("chair1",)]


def test_new_bodies_are_drawn_and_gone_ones_erased(world, tmp_path):
    path = tmp_path / "a.rrd"
    with recorder(world, path):
        world.simulate({"chair1": pose()})
        wait_for(lambda: len(positions(path, "chair1")) == 2)
        world.scene = scene(body("ball1", at=pose(4.0)), version=2)
        world.simulate({"ball1": pose(4.0)}, version=2)
        wait_for(lambda: positions(path, "ball1") == [[4.0, 0.0, 0.0]])
        world.scene = scene(version=3)
        world.simulate({}, version=3)
        wait_for(lambda: column(path, "/map/bodies/ball1", "Clear:is_recursive"))


def test_commits_that_were_missed_are_recorded_too(world, tmp_path):
    path = tmp_path / "a.rrd"
    world.past |= {3: commit(3), 4: commit(4)}
    with recorder(world, path):
        world.snapshot = Snapshot(seq=5, entities=(entity("lamp1", "Lamp", at=pose(3.0)),))
        world.publish(commit(2), commit(5))
        world.await_commit(5)
        world.publish(commit(6))
        world.await_commit(6)
        wait_for(lambda: seqs(path) == [1, 2, 3, 4, 5, 6])
    assert positions(path, "lamp1") == [[3.0, 0.0, 0.0]]


def test_a_knowledge_base_that_begins_anew_is_followed(world, tmp_path):
    path = tmp_path / "a.rrd"
    with recorder(world, path):
        world.publish(commit(2), commit(3))
        world.await_commit(3)
        world.begin_anew(Snapshot(seq=1, entities=(entity("lamp1", "Lamp", at=pose(3.0)),)))
        world.await_commit(1)
        world.publish(commit(2, entity("lamp2", "Lamp", at=pose(4.0))))
        world.await_commit(2)
    assert [c.seq for c in read_commits(path)] == [1, 2, 2, 3]
    assert positions(path, "lamp2") == [[4.0, 0.0, 0.0]]


_RUN = """
import sys
from pathlib import Path
from semmap.nodes.bus import Network
from semmap.nodes.recorder.config import RecorderConfig
from semmap.nodes.recorder.node import run
path, endpoint, serve = sys.argv[1:]
network = Network(connect=(endpoint,), listen=("tcp/127.0.0.1:0",), mode="peer")
run(RecorderConfig(path=Path(path), network=network, serve=serve))
"""


def test_a_stopped_process_leaves_a_complete_file(world, tmp_path):
    path = tmp_path / "a.rrd"
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        serve = f"127.0.0.1:{taken.getsockname()[1]}"
        command = [sys.executable, "-c", _RUN, str(path), world.endpoint, serve]
        process = subprocess.Popen(command, env=os.environ)
        try:
            world.await_commit(1)
            wait_for(lambda: seqs(path) == [1])
            assert f"no live view: {serve} is in use" in world._said
            world.publish(commit(2))
            world.await_commit(2)
        finally:
            process.send_signal(signal.SIGTERM)
            status = process.wait(PATIENCE_S)
    assert status == 0
    assert [c.seq for c in read_commits(path)] == [1, 2]
    stamps_ns = [START_NS + n * 1_000_000_000 for n in (1, 2)]
    assert column(path, "/commits", "semmap.Commit:stamp_ns") == stamps_ns
