"""What is recorded of live poses: the position at rest, the end, and lines in order."""

from __future__ import annotations

import re

import pytest

from semmap.nodes.kb_node.storage.trail_file import read_lines
from tests.kb_node.answers.past.recording import BEGIN, Recording, S


@pytest.fixture
def recording(tmp_path):
    return Recording(tmp_path)


def rest(recording, x, seconds):
    for _ in range(seconds):
        recording.now_ns += S
        recording.publish(r1=(x, 0.0, 0.0))
        recording.recorder.write()


def positions(recording):
    return [line.at[0] for line in read_lines(recording.folder) if line.at is not None]


@pytest.mark.parametrize("x", [1.95, 1.2, 1.04], ids=["within a second", "within a step", "at its places"])
def test_the_position_at_rest_is_recorded_once(recording, x):
    recording.publish(r1=(1.0, 0.0, 0.0))
    for i in range(1, 10):
        recording.now_ns += S // 10
        recording.publish(r1=(1.0 + (x - 1.0) * i / 9, 0.0, 0.0))
    rest(recording, x, 60)
    assert positions(recording) == [1.0, x]


def test_the_position_where_live_poses_end_is_recorded(recording):
    recording.publish(r1=(1.0, 0.0, 0.0))
    recording.recorder.write()
    recording.now_ns += S // 10
    recording.publish(r1=(1.2, 0.0, 0.0))
    recording.wait(4)
    assert positions(recording) == [1.0, 1.2]
    assert [line.kind for line in read_lines(recording.folder)][-2:] == ["at", "end"]


def test_noise_of_a_position_at_rest_costs_nothing(recording):
    for _ in range(100):
        rest(recording, 1.0, 1)
        rest(recording, 1.01, 1)
    assert positions(recording) == [1.0]


@pytest.mark.parametrize("is_closed", [True, False], ids=["closed", "killed"])
def test_a_visit_ends_when_the_knowledge_base_stops(recording, is_closed):
    recording.drive(3.0, 4.0, 12)
    if is_closed:
        recording.recorder.close()
        assert [line.kind for line in read_lines(recording.folder)][-1] == "end"
    recording.begin()  # the robot is off: nothing is recorded
    recording.now_ns += 50_400 * S
    (visit,) = recording.ask(in_="kitchen1").visits
    assert not visit.left
    assert BEGIN + 10 * S <= visit.until_ns <= BEGIN + 12 * S
    assert "r1 was in kitchen1 when its live poses ended 14.0 h ago, once" in recording.ask().text
    assert recording.ask(at=BEGIN // S + 50_000).track == ()


def test_a_clock_that_is_set_back_begins_a_new_period(recording):
    recording.drive(-1.0, 0.0, 4)
    recording.set_back_ns = 3600 * S
    recording.drive(0.0, 3.0, 6)
    rest(recording, 3.0, 20)
    lines = list(read_lines(recording.folder))
    (second,) = [i for i, line in enumerate(lines) if line.kind == "start"][1:]
    for period in (lines[:second], lines[second:]):
        assert [line.ns for line in period] == sorted(line.ns for line in period)
    assert lines[second - 1].kind == "end"
    assert lines[second].ns == pytest.approx(BEGIN + 4 * S - 3600 * S, abs=S)
    assert positions(recording)[-1] == 3.0
    assert re.match(r"r1 has been in kitchen1 for 2\d s, once", recording.ask(in_="kitchen1").text)
    recording.wait(4)
    assert [line.kind for line in read_lines(recording.folder)][-1] == "end"
