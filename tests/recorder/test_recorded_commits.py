"""Commits read from a recording."""

import pytest

from semmap.nodes.recorder.recorded_commits import read_commits
from semmap.nodes.recorder.recording import open_recording
from semmap.schemas import errors
from semmap.schemas.commits import PlaceChanges
from tests.recorder.messages import START_NS, commit, relation


def test_what_was_computed_is_read_back_and_a_commit_recalled_later_counts_once(tmp_path):
    path = tmp_path / "a.rrd"
    came, went = relation("cup1", "isOn", "table1"), relation("cup1", "isLocatedIn", "hall1")
    heard = commit(2, places=PlaceChanges(came=(came,), went=(went,)))
    with open_recording(path, None) as recording:
        for one in (commit(2), heard, commit(2), commit(3)):
            recording.set_time(one.seq, START_NS, None)
            recording.commit(one)
    read = read_commits(path)
    assert [(c.seq, c.came, c.went) for c in read] == [(2, (came,), (went,)), (3, (), ())]


def test_what_is_whole_of_a_recording_that_is_cut_is_read(tmp_path, caplog):
    path, cut = tmp_path / "a.rrd", tmp_path / "cut.rrd"
    with open_recording(path, None) as recording:
        for seq in (1, 2, 3):
            recording.set_time(seq, START_NS, None)
            recording.commit(commit(seq))
            recording._stream.flush()  # each in a message of its own
    content = path.read_bytes()
    found = []
    for size in range(700, len(content), 397):
        cut.write_bytes(content[:size])
        found.append([c.seq for c in read_commits(cut)])
        assert cut.read_bytes() == content[:size]
    assert "cut.rrd ends in the middle of a message; its last " in caplog.text
    assert found == sorted(found)
    assert {tuple(seqs) for seqs in found} == {(), (1,), (1, 2), (1, 2, 3)}
    cut.write_bytes(content[:20])
    with pytest.raises(errors.BadFile, match=f"cannot read {cut}"):
        read_commits(cut)
