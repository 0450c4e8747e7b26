import itertools

import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.interfaces import QosDurability
from rosbags.rosbag2 import Reader

from semmap.nodes.extern.ros import mcap_file
from semmap.nodes.extern.ros.bridge import topics
from semmap.schemas import errors
from tests.extern.ros.planner import Planner


def read(file):
    """Return the messages by topic, as the public decoder reads them."""
    heard = {}
    with file.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for _, channel, _, message in reader.iter_decoded_messages():
            heard.setdefault(channel.topic, []).append(message)
    return heard


@pytest.fixture
def changed(flat):
    with flat.client() as client:
        first = client.status().commit
        client.add("Cup", "cup77", at=(2.0, 2.0, 0.0), size=(0.1, 0.1, 0.1))
        client.update("cup77", at=(2.5, 2.0, 0.0))
        client.remove("cup77")
    return flat, first


def test_another_party_reads_a_span_of_the_history(changed, tmp_path):
    system, first = changed
    file = tmp_path / "span.mcap"
    said = system.cli("mcap", file, "--since", first + 1)
    heard = read(file)
    assert f"{sum(map(len, heard.values()))} messages written" in said
    detected = [{d.id: d for d in m.detections} for m in heard["/semmap/detections"]]
    assert ["cup77" in each for each in detected][:4] == [False, True, True, False]
    assert detected[2]["cup77"].results[0].pose.pose.position.x == pytest.approx(2.5)
    of_cup = [
        o.operation for m in heard["/planning_scene"] for o in m.world.collision_objects if o.id == "cup77"
    ]
    assert of_cup == [0, 3, 1]
    assert "kitchen1" in {t.child_frame_id for t in heard["/tf"][0].transforms}


def test_a_file_is_not_written_over_and_a_span_must_have_commits(changed, tmp_path):
    system, first = changed
    (tmp_path / "there.mcap").write_text("mine")
    assert "already exists" in system.cli("mcap", tmp_path / "there.mcap", "--since", first, status=2)
    assert (tmp_path / "there.mcap").read_text() == "mine"
    assert "as in there.mcap" in system.cli("mcap", tmp_path / "there.bag", status=2)
    assert "no commit" in system.cli("mcap", tmp_path / "new.mcap", "--since", "2031-01-01", status=2)
    assert not (tmp_path / "new.mcap").exists()


@pytest.fixture
def grasped(flat):
    with flat.client() as client:
        first = client.status().commit
        client.add("Robot", "robot9", at=(2.0, 2.0, 0.0), size=(0.5, 0.5, 1.0))
        client.add("Device", "hand9", at=(2.5, 2.0, 0.8), size=(0.1, 0.1, 0.1))
        client.set("hand9", "isDirectPartOf", "robot9")
        client.add("Cup", "cup9", at=(2.6, 2.0, 0.8))
        client.attach("cup9", to="hand9")
        client.update("hand9", at=(2.5, 3.0, 0.8))
        client.detach("cup9")
    return flat, first


def test_the_planning_scene_follows_a_grasp(grasped, tmp_path):
    system, first = grasped
    file = tmp_path / "grasp.mcap"
    system.cli("mcap", file, "--since", first + 1)
    heard = read(file)
    planner = Planner()
    states = [(dict(planner.take(s).obstacles), dict(planner.attached)) for s in heard["/planning_scene"]]
    cup = [("cup9" in obstacles, attached.get("cup9")) for obstacles, attached in states]
    assert [of for of, _ in itertools.groupby(cup)] == [
        (False, None),
        (True, None),
        (False, "hand9"),
        (True, None),
    ]
    assert not {"robot9", "hand9"} & states[-1][0].keys()
    assert states[0][0]["table1"].primitives[0].dimensions[2] < 0.1  # the board, not the bounding box
    assert all(d.bbox.size.x > 0.0 for m in heard["/semmap/detections"] for d in m.detections)
    frames = [{t.child_frame_id: t.transform.translation for t in m.transforms} for m in heard["/tf"]]
    assert [frame["cup9"].y for frame in frames[-2:]] == pytest.approx([3.0, 3.0])  # with the hand


def test_players_publish_latched_topics_as_latched(changed, tmp_path):
    system, first = changed
    file = tmp_path / "span.mcap"
    system.cli("mcap", file, "--since", first + 1)
    with Reader(file) as reader:
        durability = {c.topic: {q.durability for q in c.ext.offered_qos_profiles} for c in reader.connections}
    assert durability == {
        "/semmap/detections": {QosDurability.TRANSIENT_LOCAL},
        "/semmap/markers": {QosDurability.TRANSIENT_LOCAL},
        "/tf": {QosDurability.VOLATILE},
        "/planning_scene": {QosDurability.VOLATILE},
    }


def test_an_interrupted_export_leaves_no_file(tmp_path):
    def interrupted():
        yield mcap_file.State(1, 1, {})
        assert not (tmp_path / "a.mcap").exists()
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        mcap_file.write(tmp_path / "a.mcap", interrupted(), topics())
    assert not list(tmp_path.iterdir())
    with pytest.raises(errors.BadFile, match="cannot be written"):
        mcap_file.write(tmp_path / "none" / "a.mcap", iter(()), topics())
