import time
from pathlib import Path

import numpy as np
import pytest

from semmap.nodes import bus
from semmap.nodes.runtime.loop import Node
from semmap.nodes.sim_node import node
from semmap.nodes.sim_node.config import CameraConfig, SimConfig
from semmap.nodes.sim_node.node import Simulator
from semmap.nodes.sim_node.world import World
from semmap.schemas import codec, errors, keys
from semmap.schemas.commands import Pause, Reset, StepOnce
from semmap.schemas.replies import Done
from semmap.schemas.scenes import (
    BodiesMoved,
    CameraFrame,
    Delete,
    Deleted,
    MoveBodies,
    Picture,
    PictureQuery,
    Scene,
    SceneQuery,
    Spawn,
    Spawned,
    Surface,
    SurfaceQuery,
    Surfaces,
    WorldQuery,
)
from tests.conftest import free_endpoint, handling, until
from tests.sim_node.orders import hand, order, pose


@pytest.fixture(scope="module")
def client():
    endpoint = free_endpoint()
    network = bus.Network(connect=(), listen=(endpoint,), mode="peer")
    with bus.open_session(network) as session:
        shell = Node("sim_node", session)
        cameras = CameraConfig(rate_hz=5.0, width=64, height=48, segments=True, graphics=False)
        simulator = Simulator(shell, SimConfig(network=network, cameras=cameras))
        try:
            with handling(shell), bus.open_session(bus.Network(connect=(endpoint,))) as mine:
                yield mine
        finally:
            simulator.close()


REPLIES = {
    "spawn": Spawned,
    "delete": Deleted,
    "move": BodiesMoved,
    "snapshot": Scene,
    "pause": Done,
    "step": Done,
    "reset": Done,
    "picture": Picture,
    "surfaces": Surfaces,
    "world": Surface,
}


def ask(client, verb, message):
    return bus.ask(client, keys.SIM, verb, message, REPLIES[verb])


@pytest.fixture
def poses(client):
    """Return the published poses."""
    seen = []
    subscriber = bus.follow(client, keys.POSES, lambda key, message: seen.append(message))
    yield seen
    subscriber.undeclare()


@pytest.fixture(autouse=True)
def tidy(client):
    yield
    ask(client, "delete", Delete(names=tuple(b.name for b in ask(client, "snapshot", SceneQuery()).bodies)))


def wait_for(condition):
    until(condition, "what the simulator was ordered to do is seen in its poses")


def test_spawn_is_seen_in_the_poses_and_gone_after_delete(client, poses):
    spawned = ask(client, "spawn", Spawn(bodies=(order("cup1", "cup", pose(1, 0), commit=4),)))
    assert [b.name for b in spawned.bodies] == ["cup1"]
    wait_for(lambda: poses and poses[-1].names == ("cup1",) and poses[-1].resting == (True,))
    assert poses[-1].commits == (4,)
    assert ask(client, "snapshot", SceneQuery()).bodies[0].name == "cup1"
    assert ask(client, "delete", Delete(names=("cup1", "cup9"))).names == ("cup1",)
    wait_for(lambda: poses[-1].names == ())


def test_a_hand_is_seen_to_move_before_it_rests(client, poses):
    ask(client, "spawn", Spawn(bodies=(order("cup1", "cup", pose(1, 0)),)))
    wait_for(lambda: poses and poses[-1].resting == (True,))
    moved = ask(client, "move", MoveBodies(placements=(hand("cup1", pose(2, 0)), hand("x", pose(0, 0)))))
    assert [body.name for body in moved.bodies] == ["cup1"]
    assert "x" in moved.failed
    wait_for(lambda: poses[-1].resting == (True,) and poses[-1].poses[0] > 1.9)
    there = [p.resting[0] for p in poses if p.names and p.poses[0] > 1.9]
    assert not there[0]


def test_poses_come_twenty_times_a_second(client, poses):
    wait_for(lambda: len(poses) >= 20)
    stamps = [p.stamp_ns for p in poses[:20]]
    assert stamps[-1] - stamps[0] > 0.7e9  # a busy machine may be late, never early


def test_paused_time_goes_on_step_by_step_only(client):
    assert ask(client, "pause", Pause()).text == "time is paused"
    assert ask(client, "pause", Pause()).text == "time is already paused"
    before = ask(client, "snapshot", SceneQuery()).sim_time_s
    time.sleep(0.1)
    assert ask(client, "step", StepOnce(seconds=0.5)).text.startswith("advanced by 0.5 s")
    assert ask(client, "snapshot", SceneQuery()).sim_time_s == pytest.approx(before + 0.5)
    assert ask(client, "step", StepOnce(seconds=1e-9)).text.startswith("advanced by 0.002 s")  # no less
    assert ask(client, "pause", Pause(off=True)).text == "time is running"
    assert ask(client, "pause", Pause(off=True)).text == "time is already running"
    wait_for(lambda: ask(client, "snapshot", SceneQuery()).sim_time_s > before + 0.55)


def test_a_step_is_refused_while_time_runs(client):
    before = ask(client, "snapshot", SceneQuery()).sim_time_s
    with pytest.raises(errors.Refused, match="pause it first with: semmap pause"):
        ask(client, "step", StepOnce(seconds=60.0))
    assert ask(client, "snapshot", SceneQuery()).sim_time_s < before + 50.0


def test_a_long_step_is_followed_while_it_lasts(client, poses):
    ask(client, "pause", Pause())
    grid = [(0.2 * (i % 5), 0.2 * (i // 5 % 5), 0.5 + 0.2 * (i // 25)) for i in range(75)]
    ask(client, "spawn", Spawn(bodies=tuple(order(f"o{i}", "apple", pose(*at)) for i, at in enumerate(grid))))
    before = ask(client, "snapshot", SceneQuery()).sim_time_s
    ask(client, "step", StepOnce(seconds=2.0))
    assert any(before < told.sim_time_s < before + 1.9 for told in poses)
    assert ask(client, "snapshot", SceneQuery()).sim_time_s == pytest.approx(before + 2.0)
    ask(client, "pause", Pause(off=True))


def test_the_more_bodies_move_the_shorter_are_the_turns(client, poses, monkeypatch):
    turns = []
    step = World.step

    def timed(world, duration_s):
        turns.append((world.awake, duration_s))
        step(world, duration_s)

    monkeypatch.setattr(node, "_BODY_STEPS", 20)
    monkeypatch.setattr(World, "step", timed)
    fall = [order(f"o{i}", "apple", pose(0.5 * i, 0, 0.3)) for i in range(10)]
    ask(client, "spawn", Spawn(bodies=tuple(fall)))
    wait_for(lambda: poses and poses[-1].resting and all(poses[-1].resting))
    busy = [duration_s for awake, duration_s in turns if awake >= 10]
    assert busy
    assert max(busy) < 0.0041  # two steps of 2 ms


def test_reset_says_how_many_went_back(client):
    ask(client, "spawn", Spawn(bodies=(order("cup1", "cup", pose(1, 0)),)))
    ask(client, "move", MoveBodies(placements=(hand("cup1", pose(2, 0)),)))
    assert ask(client, "reset", Reset()).text.endswith(": 1 body")
    assert ask(client, "snapshot", SceneQuery()).bodies[0].pose.position_m[0] == pytest.approx(1.0)


def test_a_picture_is_a_png(client):
    ask(client, "spawn", Spawn(bodies=(order("chair1", "chair", pose(1, 0)),)))
    picture = ask(client, "picture", PictureQuery(width=64, height=48))
    assert picture.png.startswith(b"\x89PNG")
    assert ask(client, "picture", PictureQuery(camera="overview", width=64, height=48)).png != picture.png
    with pytest.raises(errors.BadRequest, match="overview"):
        ask(client, "picture", PictureQuery(camera="nowhere"))


def test_cameras_publish_raw_planes_with_what_they_need_to_be_understood(client):
    ask(client, "spawn", Spawn(bodies=(order("chair1", "chair", pose(0, 0)),)))
    planes = {}

    def keep(sample):
        frame = codec.decode(sample.attachment.to_bytes(), CameraFrame)
        if "chair1" in frame.names or frame.encoding != "segments16":
            planes[str(sample.key_expr)] = frame, sample.payload.to_bytes()

    subscriber = client.declare_subscriber(keys.CAMERA.key, keep)
    wait_for(lambda: len(planes) == 3)
    subscriber.undeclare()
    assert set(planes) == {f"semmap/sim/camera/overview/{plane}" for plane in ("rgb", "depth", "segments")}
    frame, raw = planes["semmap/sim/camera/overview/depth"]
    depth = np.frombuffer(raw, np.float32).reshape(frame.height, frame.width)
    assert 3.0 < np.median(depth) < 15.0
    assert (frame.camera, frame.encoding) == ("overview", "depth32f")
    assert np.reshape(frame.intrinsics, (3, 3))[0, 2] == 32.0
    assert np.reshape(frame.map_from_camera, (4, 4))[:3, 3] == pytest.approx([5, -5, 5])
    frame, raw = planes["semmap/sim/camera/overview/segments"]
    assert frame.names == ("chair1",)
    assert set(np.frombuffer(raw, np.uint16)) == {0, 1}
    frame, raw = planes["semmap/sim/camera/overview/rgb"]
    assert len(raw) == 64 * 48 * 3


def test_who_draws_may_ask_what_bodies_look_like(client):
    ask(client, "spawn", Spawn(bodies=(order("cup1", "cup", pose(1, 0)),)))
    told = ask(client, "surfaces", SurfaceQuery(names=("cup1", "missing"))).surfaces
    assert set(told) == {"cup1"}
    points = np.frombuffer(told["cup1"].points, "<f4").reshape(-1, 3)
    assert np.ptp(points[:, 2]) == pytest.approx(0.1, abs=0.03)


def test_who_draws_may_ask_what_the_world_looks_like(client):
    ask(client, "spawn", Spawn(bodies=(order("cup1", "cup", pose(1, 0)),)))
    told = ask(client, "world", WorldQuery())
    assert told.points == b""  # a bare floor has no end, and the cup is a body


def test_nonsense_is_refused_and_the_node_lives_on(client):
    with pytest.raises(errors.BadRequest):
        bus.ask(client, keys.SIM, "spawn", {"bodies": [{"name": "no name", "class": "Cup"}]}, Spawned)
    with pytest.raises(errors.UnknownVerb):
        bus.ask(client, keys.SIM, "explode", {}, Done)
    assert ask(client, "snapshot", SceneQuery()).bodies == ()


def test_a_missing_world_stops_the_start(tmp_path: Path):
    with (
        bus.open_session(bus.Network(connect=(), listen=(free_endpoint(),), mode="peer")) as session,
        pytest.raises(errors.BadFile),
    ):
        Simulator(Node("sim_node", session), SimConfig(world=tmp_path / "none.xml"))
