"""The answers from the trail of live poses."""

from __future__ import annotations

import itertools

import pytest

from semmap.nodes.kb_node.answers.past import trails
from semmap.nodes.kb_node.answers.past.renames import Renames
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.storage.trail_file import FILENAME, TrailFile, TrailLine, read_lines
from semmap.schemas import errors
from semmap.schemas.map_history import Spells
from tests.kb_node.answers.past.recording import BEGIN, ROOMS, Recording, S
from tests.kb_node.relations.entities import thing


@pytest.fixture
def recording(tmp_path):
    return Recording(tmp_path)


def spans(found):
    return [
        (
            visit.place,
            (visit.since_ns - BEGIN) // S,
            None if visit.until_ns is None else (visit.until_ns - BEGIN) // S,
        )
        for visit in found.visits
    ]


def test_places_are_entered_and_left_without_a_stop(recording):
    recording.drive(-1.0, 5.0, 12)
    recording.drive(5.0, 1.0, 8)
    found = recording.ask()
    assert spans(found) == [("hall1", 0, 6), ("flat1", 0, None), ("kitchen1", 6, 18), ("hall1", 18, None)]
    assert found.text.startswith(
        "r1 has been in hall1 for 2 s, 2 times, 8 s in all; r1 has been in flat1 for 20 s"
    )
    assert spans(recording.ask(in_="kitchen1")) == [("kitchen1", 6, 18)]
    assert recording.ask(in_="kitchen1").text.startswith(
        "r1 was in kitchen1 until 2 s ago, once, 12 s in all ("
    )


def test_a_period_selects_visits_and_counts_its_part(recording):
    recording.drive(-1.0, 5.0, 12)
    recording.drive(5.0, 1.0, 8)
    seconds = BEGIN // S
    part = recording.ask(in_="kitchen1", since=seconds + 10, until=seconds + 13)
    assert "once, 4 s in all" in part.text
    assert recording.ask(in_="kitchen1", until=seconds + 3).visits == ()
    assert recording.ask(in_="kitchen1", since=seconds + 19).text.startswith("r1 was never in kitchen1 (")
    assert [v.place for v in recording.ask(limit=1).visits] == ["hall1"]
    assert recording.ask(limit=1).omitted_visits == 3


def test_the_position_at_a_time(recording):
    recording.drive(-1.0, 5.0, 12)
    recording.wait(2)
    recording.publish(r1=(5.0, 0.0, 0.0))
    at = recording.ask(at=BEGIN // S + 9)
    assert at.text == "r1 was at (3.60, 0.00, 0.00) m in kitchen1 and flat1"
    assert [p.places for p in at.track] == [("kitchen1", "flat1")]
    recording.wait(60)
    gone = recording.ask(at=BEGIN // S + 50)
    assert gone.text == "the position of r1 at that time is not stored"
    assert gone.track == ()


def test_rest_costs_little_and_is_known_until_the_poses_end(recording):
    for _ in range(600):
        recording.now_ns += S
        recording.publish(r1=(1.0, 0.0, 0.0), r2=(5.0, 0.0, 0.0))
        recording.recorder.write()
    lines = list(read_lines(recording.folder))
    assert len(lines) <= 3 + 600 // 5 + 1
    assert [v.until_ns for v in recording.ask(in_="hall1").visits] == [None]
    recording.wait(10)
    found = recording.ask(in_="hall1")
    assert spans(found) == [("hall1", 1, 600)]
    assert found.text.startswith("r1 was in hall1 when its live poses ended 10 s ago, once, 10 min in all")


def test_a_restart_continues_a_visit_and_a_long_gap_ends_it(recording):
    recording.drive(-1.0, 0.0, 2)
    recording.begin()  # without an end, as after kill -9
    recording.now_ns += 5 * S
    recording.drive(0.0, 0.5, 2)
    assert spans(recording.ask(in_="hall1")) == [("hall1", 0, None)]
    recording.begin()
    recording.now_ns += 600 * S
    recording.drive(0.5, 0.6, 1)
    assert spans(recording.ask(in_="hall1")) == [("hall1", 0, 9), ("hall1", 609, None)]


def test_torn_lines_are_left_out(recording):
    recording.drive(-1.0, 5.0, 12)
    file = recording.folder / FILENAME
    whole = len(list(read_lines(recording.folder)))
    file.write_bytes(file.read_bytes()[:-4])
    assert len(list(read_lines(recording.folder))) == whole - 1
    recording.begin()
    recording.drive(5.0, 4.9, 1)
    assert len(list(read_lines(recording.folder))) == whole + 3, "a start, two positions, and that it is on"


def test_the_file_is_bounded_and_begins_with_the_state(tmp_path):
    recording = Recording(tmp_path, segment_bytes=2000)
    recording.publish(r2=(5.0, 0.0, 0.0))
    for start, end in itertools.islice(itertools.cycle([(-1.0, 3.0), (3.0, -1.0)]), 40):
        recording.drive(start, end, 8)
        recording.publish(r1=(end, 0.0, 0.0), r2=(5.0, 0.0, 0.0))
    assert sum(file.stat().st_size for file in tmp_path.iterdir()) < 2 * 2400
    found = recording.ask("r2", in_="kitchen1")
    assert [visit.until_ns for visit in found.visits][-1:] == [None]
    assert recording.ask(in_="hall1").kept_since_ns > BEGIN


def test_a_full_disk_is_reported_once_a_minute_and_recording_continues(recording, monkeypatch):
    def fail(self, lines):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as m:
        m.setattr(TrailFile, "append", fail)
        recording.drive(-1.0, 5.0, 12)
    assert recording.problems == [
        "the trail of live poses cannot be written: No space left on device; free space"
    ]
    recording.now_ns += 60 * S
    recording.drive(5.0, 5.5, 2)
    assert spans(recording.ask(in_="kitchen1")) == [("kitchen1", 72, None)]


def test_a_new_room_is_entered_by_what_stands_there(recording):
    recording.publish(r1=(1.0, 0.0, 0.0))
    corner = thing("corner1", (1.0, 0.0, 0.0), size=(1.0, 1.0, 2.0), place=True)
    recording.space, recording.version = Space([*ROOMS, corner]), 2
    recording.now_ns += S
    recording.publish(r1=(1.0, 0.0, 0.0))
    assert spans(recording.ask())[-1] == ("corner1", 1, None)


def test_invalid_queries(recording):
    recording.drive(-1.0, 0.0, 1)
    for fields, text in (
        ({"name": "cup1"}, "no live poses of cup1 are stored; for committed changes: semmap history cup1"),
        ({"since": "2h", "at": "1h"}, "at .--at. excludes since and until"),
        ({"since": 1_700_000_100, "until": 1_700_000_000}, "the time is in the future"),
        ({"since": 1_600_000_100, "until": 1_600_000_000}, "since .--since. is later than until"),
        ({"name": "nothing1"}, "no entity has the name, label or class 'nothing1'"),
        (
            {"in_": "kitchen9"},
            "no entity has the name, label or class 'kitchen9'; did you mean Kitchen or kitchen1",
        ),
    ):
        with pytest.raises(errors.SemmapError, match=text):
            recording.ask(**fields)


def test_a_removed_entity_keeps_its_trail(recording):
    recording.drive(-1.0, 0.0, 1, name="r7")
    assert spans(recording.ask("r7", in_="hall1")) == [("hall1", 0, None)]


@pytest.mark.parametrize(
    ("place", "text"),
    [
        ("kitchen1", "r1 was in kitchen1 until 10 s ago, once, 4 s in all, by its live poses, stored for"
         " 20 s; no commit has a position of it there"),
        ("store1", "r1 was never in store1; its live poses, stored for 20 s, show no visit"),
    ],
)  # fmt: skip
def test_when_includes_visits_that_no_commit_has(place, text):
    lines = [
        TrailLine(BEGIN, "start"),
        TrailLine(BEGIN + 6 * S, "at", "r1", (3.0, 0.0, 0.0), ("kitchen1",)),
        TrailLine(BEGIN + 10 * S, "at", "r1", (0.0, 0.0, 0.0), ("hall1",)),
    ]
    never = Spells(
        subject="r1",
        relation="isLocatedIn",
        object=place,
        spells=(),
        total_s=0.0,
        text=f"r1 was never in {place}",
    )
    found = trails.add_visits(never, trails.Trails(lines, BEGIN + 20 * S), BEGIN + 20 * S)
    assert found.text == text
    assert len(found.visits) == (place == "kitchen1")


def test_a_trail_has_the_present_names_of_entities_and_places():
    lines = [
        TrailLine(BEGIN, "start"),
        TrailLine(BEGIN + 2 * S, "at", "r1", (3.0, 0.0, 0.0), ("kitchen1",)),
        TrailLine(BEGIN + 6 * S, "at", "r2", (3.0, 0.0, 0.0), ("kitchen1", "galley1")),
        TrailLine(BEGIN + 9 * S, "at", "r1", (3.0, 0.0, 0.0), ("galley1",)),
    ]
    renames = Renames(
        [[(BEGIN + 4 * S, "r2"), (0, "r1")], [(BEGIN + 7 * S, "galley1"), (0, "kitchen1")], [(0, "hall1")]]
    )
    assert [(line.name, line.places) for line in renames.in_trail(lines)] == [
        ("", ()),
        ("r2", ("galley1",)),
        ("r2", ("galley1", "galley1 (another entity)")),
        ("r1", ("galley1",)),
    ]
