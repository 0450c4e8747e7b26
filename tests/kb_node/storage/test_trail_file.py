"""The file with the trail of live poses."""

from __future__ import annotations

import msgspec
import pytest

from semmap.nodes.kb_node.storage import trail_file
from semmap.nodes.kb_node.storage.trail_file import FILENAME, TrailFile, TrailLine, read_lines


def line(ns):
    return TrailLine(ns, "at", "r1", (1.0, 0.0, 0.0), ("kitchen1",))


@pytest.mark.parametrize(
    "damage", [b"\xff\xfe", b'[3,"at","\xff",[1,2,3],[]]', b"\x00" * 9, b'[3,"gone"]', b"[3,"]
)
def test_damaged_lines_are_left_out(tmp_path, damage):
    file = TrailFile(tmp_path)
    file.append([line(1)])
    with (tmp_path / FILENAME).open("ab") as opened:
        opened.write(damage + b"\n")
    file.append([line(2)])
    assert [read.ns for read in read_lines(tmp_path)] == [1, 2]


@pytest.mark.parametrize("before", [FILENAME, f"{FILENAME}.1"], ids=["first", "between"])
def test_a_segment_that_begins_during_reading_is_read_once(tmp_path, monkeypatch, before):
    file = TrailFile(tmp_path)
    for ns in (1, 2):
        file.append([line(ns)])
        if ns == 1:
            file.begin_segment()
    open_ = trail_file._open

    def begin_and_open(path, opened):
        if path.name == before:
            file.begin_segment()
            file.append([line(3)])
        return open_(path, opened)

    monkeypatch.setattr(trail_file, "_open", begin_and_open)
    found = [read.ns for read in read_lines(tmp_path)]
    assert found == ([2, 3] if before == FILENAME else [2])


def test_lines_are_read_as_they_were_written(tmp_path):
    file = TrailFile(tmp_path)
    assert list(read_lines(tmp_path)) == list(tmp_path.iterdir()) == []
    lines = [TrailLine(1, "start"), line(2), TrailLine(3, "on"), TrailLine(4, "end", "r1")]
    assert not file.append(lines[:3])
    assert not file.append(lines[3:])
    assert list(read_lines(tmp_path)) == lines
    assert (tmp_path / FILENAME).read_bytes().count(b"\n") == 4


def test_a_full_segment_replaces_the_older_one(tmp_path):
    file, full = TrailFile(tmp_path, segment_bytes=150), []
    size = len(msgspec.json.encode(line(1))) + 1
    for ns in range(1, 10):
        if file.append([line(ns)]):
            full.append(ns)
            file.begin_segment()
    most = -(-150 // size)
    assert full == list(range(most, 10, most))
    newest = [read.ns for read in read_lines(tmp_path)]
    assert newest == list(range(full[-2] + 1, 10))
    assert len(list(tmp_path.iterdir())) <= 2


def test_a_line_after_a_torn_one_is_complete(tmp_path):
    TrailFile(tmp_path).append([line(1), line(2)])
    file = tmp_path / FILENAME
    file.write_bytes(file.read_bytes()[:-5])
    again = TrailFile(tmp_path)
    again.append([line(3)])
    again.append([line(4)])
    assert [read.ns for read in read_lines(tmp_path)] == [1, 3, 4]
