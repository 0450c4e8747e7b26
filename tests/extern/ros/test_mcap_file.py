import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory


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
    heard = {}
    with file.open("rb") as stream:
        for _, channel, _, message in make_reader(
            stream, decoder_factories=[DecoderFactory()]
        ).iter_decoded_messages():
            heard.setdefault(channel.topic, []).append(message)
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
