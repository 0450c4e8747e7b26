import contextlib
import os
import socket
import subprocess
import sys
from dataclasses import replace

import pytest

from semmap.nodes.drawing.figures import Figure
from semmap.nodes.recorder.recorded_commits import read_commits
from semmap.nodes.recorder.recording import free_to_serve, open_recording
from semmap.nodes.recorder.replay import replay
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from tests.conftest import until
from tests.recorder.files import column, log, positions, timelines
from tests.recorder.messages import START_NS, commit, entity, pose, relation, surface

CHAIR = Figure("chair1", "Chair", (0.4, 0.6, 1.0), "solid")


def test_every_field_of_a_commit_comes_back(tmp_path):
    path = tmp_path / "new" / "a.rrd"
    made = commit(
        7,
        entity("cup1", "Cup"),
        removed=("beer1", "beer2"),
        agent="ann",
        reason="tidy up",
        inserted=(
            relation("cup1", "isOn", "table1"),
            (v.entity_iri("cup1"), v.LEXICAL_REFERENCE, '"a \\"cup\\" ."@en'),
        ),
        retracted=(relation("beer1", "isOn", "table1"),),
    )
    with open_recording(path, None) as recording:
        recording.set_time(7, made.stamp_ns, 1.5)
        recording.commit(made)
    (read,) = read_commits(path)
    assert (read.seq, read.stamp_ns, read.id, read.source) == (7, made.stamp_ns, "id-7", "operator")
    assert (read.agent, read.reason) == ("ann", "tidy up")
    assert (read.inserted, read.retracted) == (made.inserted, made.retracted)
    assert (read.changed, read.removed) == (("cup1",), ("beer1", "beer2"))
    assert timelines(path, "/commits") == {"commit", "time", "sim_time"}
    assert column(path, "/commits", "TextDocument:media_type") == ["text/markdown"]


def test_commits_come_back_in_order_whatever_they_hold(tmp_path):
    path = tmp_path / "a.rrd"
    full = (relation("a", "isOn", "b"),)
    with open_recording(path, None) as recording:
        for seq in (3, 1, 2):
            recording.set_time(seq, START_NS, None)
            recording.commit(commit(seq, inserted=full if seq == 2 else ()))
    assert [(c.seq, c.inserted) for c in read_commits(path)] == [(1, ()), (2, full), (3, ())]


def test_a_recording_without_commits_is_one(tmp_path):
    path = tmp_path / "a.rrd"
    with open_recording(path, None) as recording:
        recording.set_time(1, START_NS, None)
        recording.note("nothing")
    assert read_commits(path) == []
    assert log(path) == ["nothing"]


def test_a_figure_is_a_box_on_its_bottom_centre(tmp_path):
    path = tmp_path / "a.rrd"
    with open_recording(path, None) as recording:
        recording.set_time(1, START_NS, None)
        recording.draw("chair1", CHAIR, pose(1.0, 2.0, 0.5))
        recording.move("chair1", CHAIR, pose(1.5, 2.0, 0.5))
    assert positions(path, "chair1") == [[1.0, 2.0, 0.5], [1.5, 2.0, 0.5]]
    (half,) = column(path, "/map/bodies/chair1", "Boxes3D:half_sizes")
    (centre,) = column(path, "/map/bodies/chair1", "Boxes3D:centers")
    assert half == pytest.approx([0.2, 0.3, 0.5])
    assert centre == pytest.approx([0.0, 0.0, 0.5])


def test_a_figure_whose_surface_is_known_is_drawn_with_it(tmp_path):
    path = tmp_path / "a.rrd"
    with open_recording(path, None) as recording:
        recording.set_time(1, START_NS, None)
        recording.draw("chair1", replace(CHAIR, surface=surface()), pose())
        recording.draw("ghost1", replace(CHAIR, appearance="ghost", surface=surface()), pose())
    assert column(path, "/map/bodies/chair1", "Mesh3D:vertex_positions") == [[0.0, 0.0, 0.0]]  # the first
    assert len(column(path, "/map/bodies/chair1", "Boxes3D:half_sizes")) == 1
    assert column(path, "/map/bodies/ghost1", "Mesh3D:vertex_positions") == []


def test_a_file_is_never_written_over(tmp_path):
    path = tmp_path / "a.rrd"
    path.write_text("precious")
    names = []
    for _ in range(3):
        with open_recording(path, None) as recording:
            names.append(recording.path.name)
    assert names == ["a-2.rrd", "a-3.rrd", "a-4.rrd"]
    assert path.read_text() == "precious"


def test_a_folder_that_is_a_file_is_told(tmp_path):
    (tmp_path / "a").write_text("")
    with (
        pytest.raises(errors.BadFile, match="cannot write recording"),
        open_recording(tmp_path / "a" / "b.rrd", None),
    ):
        pass


@pytest.mark.parametrize("read", [read_commits, replay])
def test_what_is_no_recording_is_told(tmp_path, read):
    text = tmp_path / "a.txt"
    text.write_text("no recording")
    missing = tmp_path / "none.rrd"
    for path, why in ((missing, "no such file"), (tmp_path, "directory"), (text, "not a recording")):
        with pytest.raises(errors.BadFile, match=why):
            read(path)


def test_a_damaged_recording_is_told(tmp_path):
    path = tmp_path / "a.rrd"
    path.write_bytes(b"RRF2 and nothing that belongs here")
    with pytest.raises(errors.BadFile, match="cannot read"):
        read_commits(path)


_KILLED = """
import sys, time
from pathlib import Path
from semmap.nodes.recorder.recording import open_recording
from tests.recorder.messages import commit
with open_recording(Path(sys.argv[1]), None) as recording:
    for seq in range(50):
        recording.set_time(seq, 0, None)
        recording.commit(commit(seq))
    time.sleep(60)
"""


def test_what_is_recorded_is_soon_in_the_file_and_stays_there_when_the_recorder_is_killed(tmp_path):
    path = tmp_path / "a.rrd"

    def seqs():
        with contextlib.suppress(errors.BadFile):  # it ends in the middle of a message
            return [c.seq for c in read_commits(path)]

    with subprocess.Popen([sys.executable, "-c", _KILLED, str(path)], env=os.environ) as process:
        until(lambda: seqs() == list(range(50)), "all are in the file")
        process.kill()
    assert seqs() == list(range(50))


def test_a_port_that_is_taken_is_not_free():
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        address = f"127.0.0.1:{taken.getsockname()[1]}"
        assert not free_to_serve(address)
    assert free_to_serve(address)
