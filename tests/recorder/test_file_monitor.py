"""A recording that is no longer written is reported; one without new data is not."""

from __future__ import annotations

import subprocess
import sys
from collections import namedtuple

import pytest

from semmap.nodes.recorder import file_monitor
from semmap.nodes.recorder.file_monitor import FileMonitor
from semmap.nodes.recorder.recording import open_recording
from tests.conftest import PATIENCE_S


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "one.rrd"
    path.write_bytes(b"x")
    return path


def write(path):
    with path.open("ab") as file:
        file.write(b"x")


def test_a_file_that_grows_with_what_is_recorded_is_well(path):
    one = FileMonitor(path)
    for recorded in range(10):
        write(path)
        assert one.find_problem(recorded) == ""


def test_so_is_one_to_which_nothing_is_recorded(path):
    one = FileMonitor(path)
    assert [one.find_problem(5) for _ in range(10)] == [""] * 10


def test_what_was_recorded_just_now_has_time_to_be_written(path):
    one = FileMonitor(path)
    assert one.find_problem(1) == ""
    assert one.find_problem(2) == ""
    write(path)
    assert one.find_problem(2) == ""
    assert one.find_problem(2) == ""


def test_one_that_does_not_grow_any_more_is_told_until_it_grows(path, monkeypatch):
    one = FileMonitor(path)
    one.find_problem(1)
    one.find_problem(2)
    assert one.find_problem(3) == f"recording {path} is no longer written"
    usage = namedtuple("Usage", "free")
    monkeypatch.setattr(file_monitor.shutil, "disk_usage", lambda _: usage(0))
    assert one.find_problem(3).endswith("no longer written: the disk is full")
    write(path)
    assert one.find_problem(3) == ""


def test_one_that_is_gone_is_told(path):
    one = FileMonitor(path)
    path.unlink()
    assert one.find_problem(0) == f"cannot write recording {path}: No such file or directory"


def test_what_a_recording_notes_is_counted(tmp_path):
    with open_recording(tmp_path / "two.rrd", None) as recording:
        before = recording.logged
        recording.note("hello")
        assert recording.logged == before + 1


FULL = """
import os, resource, signal, sys, time
from pathlib import Path
from semmap.nodes.recorder.file_monitor import FileMonitor
from semmap.nodes.recorder.recording import open_recording

signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
with open_recording(Path(sys.argv[1]), None) as recording:
    monitor = FileMonitor(recording.path)
    resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, resource.RLIM_INFINITY))
    for _ in range(60):
        recording.note(os.urandom(100_000).hex())
        time.sleep(0.75)  # longer than what is recorded takes to reach a file
        if problem := monitor.find_problem(recording.logged):
            print(problem, flush=True)
            break
"""


def test_a_real_recording_that_finds_no_room_is_told(tmp_path):
    run = subprocess.run(
        [sys.executable, "-c", FULL, tmp_path / "full.rrd"],
        capture_output=True,
        text=True,
        timeout=2 * PATIENCE_S,
    )
    assert "is no longer written" in run.stdout, run.stderr
