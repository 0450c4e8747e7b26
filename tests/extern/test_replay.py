"""Replays of a map while its own system runs, and checks of recordings."""

import shutil
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from semmap.nodes.extern.client import connect
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.nodes.recorder.recorded_commits import read_commits
from semmap.nodes.supervisor.ports import free_endpoint
from tests.conftest import _begun, until
from tests.kb_node.home import chair, transaction

_BIN = Path(sys.executable).parent


@pytest.fixture(scope="module")
def system(full_system):
    """A system with a little history: 5 commits or more."""
    with full_system.client() as client:
        client.add("Cup", "mug7", at=(8.0, 2.3, 0.77), wait=True, ref="mug")
        client.undo(client.remove("mug7").commit)
        client.update("mug7", at=(2.0, 2.0, 0.0))
        until(lambda: client.status().in_agreement, "map and scene agree")
        yield full_system
        client.remove("mug7")


def newest(recording):
    """Return the number of the newest commit in a recording, which may still be empty: then 0."""
    return max((commit.seq for commit in read_commits(recording)), default=0)


def test_map_and_scene_are_run_again_beside_the_running_system(system):
    with system.client() as client:
        last = client.status().commit
        then, now = client.list(as_of=2), client.list(as_of=last)
    endpoint = free_endpoint()
    options = ("--listen", endpoint, "--speed", "100", "--no-record")
    command = [_BIN / "semmap", "replay", str(system.data), *options]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    said: list[str] = []
    assert process.stdout is not None
    reader = threading.Thread(target=lambda: said.extend(process.stdout), daemon=True)
    reader.start()
    try:
        until(lambda: any(line.startswith("stop ") for line in said), "the replay is ready")
        with connect(endpoint) as client:
            until(lambda: client.status().commit == last, "all is replayed")
            assert [(e.name, e.pose, e.provenance) for e in client.list()] == [
                (e.name, e.pose, e.provenance) for e in now
            ]
            assert [(e.name, e.pose) for e in client.list(as_of=2)] == [(e.name, e.pose) for e in then]
            until(lambda: client.status().in_agreement, "the scene is as the map says")
            with pytest.raises(Exception, match="a replay and cannot be changed"):
                client.add("Cup")
            with pytest.raises(Exception, match="nothing in it can be moved"):
                client.move("chair1", at=(1.0, 1.0, 1.0))
            assert client.status().commit == last
    finally:
        process.send_signal(2)
        assert process.wait(30) == 0
        reader.join(30)
        process.stdout.close()
    folder = next(line.split()[1] for line in said if line.startswith("data "))
    assert not Path(folder).exists()
    with system.client() as client:
        assert client.status().commit == last


def test_a_recording_is_compared_with_the_map_that_it_is_of(system, tmp_path):
    with system.client() as client:
        last = client.status().commit
    (recording,) = (system.data / "recordings").glob("*.rrd")
    check = ("replay", recording, "--check")
    until(lambda: newest(recording) == last, "the recorder has written all")
    assert f"commits are as in the journal: 1 to {last}" in system.cli(*check)
    assert "commits are as in the journal" in system.cli(*check, "--data", system.data)
    other = shutil.copytree(_begun("flat"), tmp_path / "other")  # a map that began like this one
    said = system.cli(*check, "--data", other, status=1)
    assert f"{recording} is not a recording of this map: commit 2 is not in the journal" in said
    journal = Journal(other / FILENAME)
    SemanticMap(journal).commit(transaction(2, chair("chair8")))
    journal.close()
    said = system.cli(*check, "--data", other, status=1)
    assert f"{recording} is not a recording of this map: commit 2 differs: id is '" in said


def test_of_a_recording_that_is_cut_off_the_missing_commits_are_named(system, tmp_path):
    (recording,) = (system.data / "recordings").glob("*.rrd")

    with system.client() as client:
        until(lambda: newest(recording) == client.status().commit, "the recorder has written all so far")
        left, whole, cut = newest(recording), recording.read_bytes(), tmp_path / "cut.rrd"
        client.add("Room", "late_room", at=(20.0, 20.0, 0.0), size=(3.0, 3.0, 2.5))
        until(lambda: newest(recording) == client.status().commit > left, "and what came after it")
        last = newest(recording)
    cut.write_bytes(whole + recording.read_bytes()[len(whole) : len(whole) + 40])
    assert newest(cut) == left
    command = [_BIN / "semmap", "replay", cut, "--check", "--data", system.data]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    lacking = f"commit {last}" if left == last - 1 else f"commits {left + 1} to {last}"
    assert f"{cut} is not complete: " in done.stderr
    assert f"the recording lacks {lacking}" in done.stderr
    assert "are ignored" in done.stderr
    with system.client() as client:
        client.remove("late_room")
